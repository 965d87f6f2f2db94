//! Tests `submit` without Slurm, or with simulated Slurm programs. The tests in tests/cluster use a
//! real Slurm.
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use tempfile::TempDir;

use crate::stochc::{Outcome, command, path, run_command, shard_new, stochc_with};

const TOWER: &str = "simulate --model shuffle tests/fixtures/tower.sa --runs 10 --seed 3 --quiet";

/// Runs `submit` without Slurm's commands.
fn submit(arguments: &[&str]) -> Outcome {
    let arguments = ["shard", "submit"]
        .into_iter()
        .chain(arguments.iter().copied());
    run_command(command(arguments).env("PATH", ""))
}

/// Simulated Slurm programs, with an ensemble of four shards.
struct FakeSlurm {
    folder: TempDir,
    out: String,
}

/// Script of `sbatch` that accepts a job and prints its number, as Slurm does.
const ACCEPTS: &str = "echo $number";
/// Script of `sbatch` that rejects a job, as Slurm does, and removes it.
const REFUSES: &str =
    "sed -i '$d' jobs; echo 'sbatch: error: Invalid partition specified' >&2; exit 1";
/// Script of `squeue` that lists all jobs as running.
const LISTS: &str = "while read n s name; do echo \"$n|0|$name|RUNNING|None\"; done <jobs";
/// Script of `squeue` that lists no job.
const LISTS_NOTHING: &str = ":";

impl FakeSlurm {
    /// Creates the simulated programs. `sbatch` adds a line `NUMBER SECONDS NAME` to `jobs`, and
    /// then runs its script.
    fn new(sbatch: &str, squeue: &str) -> FakeSlurm {
        let folder = tempfile::tempdir().unwrap();
        let out = path(folder.path(), "out");
        stochc_with(&shard_new(TOWER), &["--shards", "4", "--out", &out]);
        let fake = FakeSlurm { folder, out };
        fs::create_dir(fake.folder.path().join("bin")).unwrap();
        fs::write(fake.folder.path().join("jobs"), "").unwrap();
        fake.program("scontrol", "echo 'MaxArraySize = 1001'");
        fake.program("sacctmgr", "exit 1");
        fake.program("squeue", squeue);
        fake.sbatch(sbatch);
        fake
    }

    fn sbatch(&self, script: &str) {
        let add = "for a; do case $a in --job-name=*) name=${a#*=};; esac; done
number=$((101 + $(wc -l <jobs)))
echo $number $(date +%s) $name >>jobs
echo \"$* ${SBATCH_ARRAY_INX-}\" >>calls";
        self.program("sbatch", &format!("{add}\n{script}"));
    }

    fn program(&self, name: &str, script: &str) {
        let file = self.folder.path().join("bin").join(name);
        let folder = self.folder.path().display();
        fs::write(&file, format!("#!/bin/sh\ncd {folder}\n{script}\n")).unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).unwrap();
    }

    fn command(&self, options: &str) -> std::process::Command {
        let mut command = command(["shard", "submit", &self.out]);
        command.args(options.split_whitespace());
        let bin = self.folder.path().join("bin");
        command.env("PATH", format!("{}:/usr/bin:/bin", bin.display()));
        command
    }

    fn submit(&self, options: &str) -> Outcome {
        run_command(&mut self.command(options))
    }

    /// Runs all shards on this machine.
    fn run_shards(&self) {
        for shard in ["0", "1", "2", "3"] {
            stochc_with("shard run --quiet", &[&self.out, shard]);
        }
    }

    /// Checks that exactly one job array and one merge job were submitted.
    #[track_caller]
    fn has_submitted_once(&self) {
        let jobs = fs::read_to_string(self.folder.path().join("jobs")).unwrap();
        let merges: Vec<bool> = jobs.lines().map(|job| job.ends_with("-merge")).collect();
        assert_eq!(merges, [false, true], "{jobs}");
    }

    fn calls(&self) -> String {
        fs::read_to_string(self.folder.path().join("calls")).unwrap_or_default()
    }
}

#[test]
fn without_slurm_the_shell_loop_is_proposed() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    stochc_with(&shard_new(TOWER), &["--shards", "4", "--out", &out]);
    let outcome = submit(&[&out]);
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    for what in ["`squeue` is not installed", "stochc shard status"] {
        assert!(outcome.err.contains(what), "{what}: {}", outcome.err);
    }
    assert!(!Path::new(&out).join("slurm").exists());
}

#[test]
fn without_a_configuration_the_shell_loop_is_proposed() {
    let fatal = "echo 'squeue: fatal: Could not establish a configuration source' >&2; exit 1";
    let slurm = FakeSlurm::new(ACCEPTS, fatal);
    let outcome = slurm.submit("");
    assert_eq!(
        (outcome.status, outcome.out.as_str()),
        (2, ""),
        "{}",
        outcome.err
    );
    for what in ["establish a configuration", "stochc shard status"] {
        assert!(outcome.err.contains(what), "{what}: {}", outcome.err);
    }
    assert!(!outcome.err.contains("--partition"), "{}", outcome.err);
    assert_eq!(slurm.calls(), "");
}

#[test]
fn lines_may_come_before_the_job_number() {
    let banner = "echo '--> checking the allocation ... OK'; echo $number";
    let slurm = FakeSlurm::new(banner, LISTS_NOTHING);
    let outcome = slurm.submit("");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let submitted = "submitted job array 101 (shards: 4, tasks: 4) and merge job 102\n";
    assert!(outcome.out.starts_with(submitted), "{}", outcome.out);
    assert!(
        outcome.out.contains("squeue --jobs=101,102\n"),
        "{}",
        outcome.out
    );
    slurm.has_submitted_once();
    assert!(slurm.calls().contains("--dependency=afterany:101"));
}

#[test]
fn an_accepted_job_without_a_number_is_found_by_its_name() {
    let lost = "echo 'sbatch: error: Batch job submission failed: Socket timed out' >&2; exit 1";
    for sbatch in ["echo Thank you.", lost] {
        let slurm = FakeSlurm::new(sbatch, LISTS);
        let outcome = slurm.submit("");
        assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
        assert!(outcome.out.contains("merge job 102\n"), "{}", outcome.out);
        slurm.has_submitted_once();
        // If the job is not found, it is not reported as rejected.
        let slurm = FakeSlurm::new(sbatch, LISTS_NOTHING);
        let outcome = slurm.submit("--grace 1s");
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
        assert!(
            outcome.err.contains("may have accepted the job array"),
            "{}",
            outcome.err
        );
        let again = slurm.submit("--grace 1s");
        assert!(again.err.starts_with("waiting up to "), "{}", again.err);
    }
}

#[test]
fn a_refusal_is_reported_and_can_be_repaired() {
    let slurm = FakeSlurm::new(REFUSES, LISTS_NOTHING);
    let outcome = slurm.submit("");
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    for what in ["refused the job array", "Invalid partition", "--partition"] {
        assert!(outcome.err.contains(what), "{what}: {}", outcome.err);
    }
    let limit = "sed -i '$d' jobs; echo 'sbatch: error: QOSMaxSubmitJobPerUserLimit
sbatch: error: Batch job submission failed: Job violates accounting/QOS policy' >&2; exit 1";
    slurm.sbatch(limit);
    let outcome = slurm.submit("");
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("`--per-task N`"), "{}", outcome.err);
    slurm.sbatch(ACCEPTS);
    let outcome = slurm.submit("");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    slurm.has_submitted_once();
}

#[test]
fn a_merge_job_that_was_refused_is_submitted_later() {
    let refuses_merge = format!("case $name in *-merge) {REFUSES};; esac\n{ACCEPTS}");
    let slurm = FakeSlurm::new(&refuses_merge, LISTS);
    let outcome = slurm.submit("");
    assert_eq!(outcome.status, 2);
    let refused = "refused the merge job after job array 101";
    assert!(outcome.err.contains(refused), "{}", outcome.err);
    slurm.sbatch(ACCEPTS);
    let outcome = slurm.submit("--grace 1s");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let submitted = "running tasks: 1; submitted merge job 102\n";
    assert!(outcome.out.starts_with(submitted), "{}", outcome.out);
    slurm.has_submitted_once();
}

#[test]
fn jobs_that_are_not_listed_yet_are_not_submitted_again() {
    let late = "now=$(date +%s); while read n s name; do
[ $((now - s)) -lt 4 ] || echo \"$n|0-3|$name|RUNNING|None\"; done <jobs";
    let slurm = FakeSlurm::new(ACCEPTS, late);
    assert_eq!(slurm.submit("").status, 0);
    let outcome = slurm.submit("");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let running = "running tasks: 4; nothing was submitted\n";
    assert!(outcome.out.starts_with(running), "{}", outcome.out);
    slurm.has_submitted_once();
}

#[test]
fn shards_whose_files_arrive_late_are_not_submitted_again() {
    let ended = "while read n s name; do echo \"$n|0-3|$name|COMPLETED|None\"; done <jobs";
    let slurm = FakeSlurm::new(ACCEPTS, ended);
    let (stochc, out) = (env!("CARGO_BIN_EXE_stochc"), &slurm.out);
    let late = format!(
        "echo $number
case $name in *-merge) exit;; esac
(exec >/dev/null 2>&1; sleep 3; for i in 0 1 2 3; do {stochc} shard run {out} $i; done; {stochc} shard merge {out}) &"
    );
    slurm.sbatch(&late);
    assert_eq!(slurm.submit("").status, 0);
    let outcome = slurm.submit("");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome.out.contains("is complete: 10 runs"),
        "{}",
        outcome.out
    );
    assert!(!Path::new(out).join("slurm").exists());
    slurm.has_submitted_once();
}

#[test]
fn missing_shards_are_submitted_again() {
    let slurm = FakeSlurm::new(ACCEPTS, LISTS_NOTHING);
    assert_eq!(slurm.submit("").status, 0);
    slurm.run_shards();
    fs::remove_file(Path::new(&slurm.out).join("shards/2.jsonl")).unwrap();
    fs::write(Path::new(&slurm.out).join("slurm/101_2.log"), "killed\n").unwrap();
    let outcome = slurm.submit("--grace 1s");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let submitted = "submitted job array 103 (shards: 1, tasks: 1) and merge job 104\n";
    assert!(outcome.out.starts_with(submitted), "{}", outcome.out);
    assert!(outcome.out.contains("out/slurm/\n"), "{}", outcome.out);
    assert!(slurm.calls().contains("--array=2 "), "{}", slurm.calls());
}

#[test]
fn shards_are_merged_if_none_is_missing() {
    let slurm = FakeSlurm::new(ACCEPTS, LISTS_NOTHING);
    slurm.run_shards();
    // Only a complete check of the shard detects this corruption.
    let shard = Path::new(&slurm.out).join("shards/1.jsonl");
    let text = fs::read_to_string(&shard).unwrap();
    let last = text.trim_end().rfind('\n').unwrap();
    fs::write(&shard, format!("{}{{}}\n", &text[..=last])).unwrap();
    let outcome = slurm.submit("");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(slurm.calls().contains("--array=1 "), "{}", slurm.calls());
    fs::write(&shard, text).unwrap();
    let outcome = slurm.submit("--grace 1s");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome.out.contains("is complete: 10 runs"),
        "{}",
        outcome.out
    );
    slurm.has_submitted_once();
}

#[test]
fn the_environment_does_not_change_submissions() {
    let slurm = FakeSlurm::new(ACCEPTS, LISTS);
    let outcome_with = |name: &str, value: &str| run_command(slurm.command("").env(name, value));
    let refused = outcome_with("SBATCH_CLUSTERS", "east");
    assert_eq!((refused.status, refused.out.as_str()), (2, ""));
    assert!(refused.err.contains("SLURM_CLUSTERS"), "{}", refused.err);
    assert_eq!(slurm.calls(), "");
    assert_eq!(outcome_with("SBATCH_ARRAY_INX", "7-9").status, 0);
    assert!(!slurm.calls().contains("7-9"), "{}", slurm.calls());
    slurm.has_submitted_once();
}

#[test]
fn tasks_are_limited_as_asked_and_by_the_site() {
    let slurm = FakeSlurm::new(ACCEPTS, LISTS);
    let limit = "echo 'SchedulerParameters = sched_interval=1,max_array_tasks=2'";
    slurm.program("scontrol", limit);
    let outcome = slurm.submit("--at-most 1");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome.out.contains("(shards: 4, tasks: 2)"),
        "{}",
        outcome.out
    );
    assert!(
        slurm.calls().contains("--array=0-1%1 "),
        "{}",
        slurm.calls()
    );
}

#[test]
fn a_dry_run_shows_scripts_and_commands() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "it's out");
    stochc_with(&shard_new(TOWER), &["--shards", "4", "--out", &out]);
    stochc_with("shard run --quiet", &[&out, "2"]);
    let more = [
        "--partition",
        "long",
        "--time",
        "1-0",
        "--sbatch",
        "--mem=2G",
    ];
    let shown = submit(&[&[out.as_str(), "--dry-run"], &more[..]].concat());
    assert_eq!((shown.status, shown.err.as_str()), (0, ""));
    let real = folder.path().canonicalize().unwrap();
    let root = real.to_str().unwrap();
    let binary = Path::new(env!("CARGO_BIN_EXE_stochc")).canonicalize();
    let shown =
        (shown.out.replace(root, "FOLDER")).replace(binary.unwrap().to_str().unwrap(), "STOCHC");
    // The job name contains the path of the folder.
    let name = shown.split("--job-name=").nth(1).unwrap();
    let name = name.split_whitespace().next().unwrap();
    assert!(name.starts_with("stochc-"), "{name}");
    insta::assert_snapshot!(shown.replace(name, "NAME"));
    assert!(!Path::new(&out).join("slurm").exists());
    // The ensemble has more shards than an array may have tasks by default.
    let many = path(folder.path(), "many");
    let line =
        "shard new --model shuffle tests/fixtures/tower.sa --runs 4000 --shards 4000 --quiet";
    stochc_with(line, &["--out", &many]);
    let shown = submit(&[&many, "--dry-run"]).out;
    assert!(shown.contains("per_task=4\n"), "{shown}");
    assert!(shown.contains("--array=0-999 "), "{shown}");
}

/// Checks that a shell without Slurm can run the scripts.
#[test]
fn the_scripts_are_plain_shell() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, out] = ["plain", "$(out) it's"].map(|name| path(folder.path(), name));
    stochc_with(TOWER, &["--threads", "1", "--out", &plain]);
    stochc_with(&shard_new(TOWER), &["--shards", "5", "--out", &out]);
    let shown = submit(&[&out, "--dry-run", "--per-task", "2"]).out;
    let mut scripts = shown.split("#!/bin/sh\n").skip(1);
    let [shards, merge] = [scripts.next().unwrap(), scripts.next().unwrap()].map(|script| {
        let end = script.find("\n# ").unwrap();
        &script[..end]
    });
    fs::create_dir(Path::new(&out).join("slurm")).unwrap();
    let run = |script: &str, task: &str| {
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", script]);
        shell
            .env("SLURM_ARRAY_JOB_ID", "12")
            .env("SLURM_ARRAY_TASK_ID", task);
        run_command(shell.env("SLURM_JOB_ID", "13"))
    };
    let log = |name: &str| fs::read_to_string(Path::new(&out).join("slurm").join(name));
    assert_eq!(run(merge, "").status, 3);
    assert!(
        log("merge_13.log")
            .unwrap()
            .contains("5 of 5 shards are missing")
    );
    for task in ["2", "0"] {
        let outcome = run(shards, task);
        assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    }
    // One shard of the task has the file of another shard. The task still runs its other shard.
    let files = Path::new(&out).join("shards");
    fs::copy(files.join("0.jsonl"), files.join("3.jsonl")).unwrap();
    assert_eq!(run(shards, "1").status, 2);
    let message = log("12_1.log").unwrap();
    assert!(message.contains("is in fact shard 0 of 5"), "{message}");
    assert!(
        message.ends_with("shard 3 ended with status 2\n"),
        "{message}"
    );
    assert!(files.join("2.jsonl").exists());
    let refused = submit(&[&out, "--dry-run"]);
    assert_eq!(refused.status, 2);
    assert!(
        refused.err.contains("shard 3 is in fact shard 0"),
        "{}",
        refused.err
    );
    fs::remove_file(files.join("3.jsonl")).unwrap();
    assert_eq!(run(shards, "1").status, 0);
    assert!(log("12_1.log").is_err());
    assert_eq!(run(merge, "").status, 0);
    assert_eq!(
        stochc_with("fsck", &[&out]).out,
        stochc_with("fsck", &[&plain]).out
    );
    assert!(!Path::new(&out).join("slurm").exists());
    let again = submit(&[&out]);
    assert_eq!(again.status, 0, "{}", again.err);
    assert!(again.out.contains("is complete: 10 runs"), "{}", again.out);
}

#[test]
fn folders_that_cannot_be_submitted_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let refused = |arguments: &[&str], reason: &str| {
        let outcome = submit(arguments);
        assert_eq!(
            (outcome.status, outcome.out.as_str()),
            (2, ""),
            "{}",
            outcome.err
        );
        assert!(
            outcome.err.contains(reason),
            "{arguments:?}: {}",
            outcome.err
        );
    };
    refused(&[&out], "cannot use");
    refused(&[folder.path().to_str().unwrap()], "contains no results");
    stochc_with(&shard_new(TOWER), &["--shards", "4", "--out", &out]);
    for option in [
        "--wait",
        "-W",
        "--clusters=a",
        "--clu=a",
        "-Ma",
        "--wrap=x",
        "--test-only",
        "--output=x",
        "--job-name=x",
        "--version",
    ] {
        refused(&[&out, "--sbatch", option], "cannot be combined with --");
    }
    for option in ["--array=0-9", "--arr=0-9", "-a0-9"] {
        refused(&[&out, "--sbatch", option], "--at-most");
    }
    refused(&[&out, "--sbatch", "account=me"], "--sbatch=--mem=2G");
    refused(&[&out, "--at-most", "0"], "--at-most");
    refused(&[&out, "--per-task", "0"], "--per-task");
    refused(&[&out, "--grace", "1"], "number and its unit");
    // The manifest names another build.
    let manifest = Path::new(&out).join("manifest.json");
    let text = fs::read_to_string(&manifest).unwrap();
    let build = stochc::results::this_build();
    fs::write(&manifest, text.replace(&build, "0123456789abcdef")).unwrap();
    fs::remove_file(Path::new(&out).join("checksums.json")).unwrap();
    refused(&[&out], "0123456789abcdef");
    // Another process has begun to write runs without shards into the folder.
    let begun = path(folder.path(), "begun");
    stochc_with(TOWER, &["--out", &begun]);
    let journal = Path::new(&begun).join("journal.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    let part: Vec<&str> = text.split_inclusive('\n').take(3).collect();
    fs::write(&journal, part.concat()).unwrap();
    refused(&[&begun], "has no shards: it holds 2 of 10 runs");
}

#[test]
#[cfg(target_os = "linux")]
fn a_name_that_is_not_text_is_rejected() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().unwrap();
    let [out, odd] =
        [&b"out"[..], b"\xff"].map(|it| folder.path().join(std::ffi::OsStr::from_bytes(it)));
    stochc_with(
        &shard_new(TOWER),
        &["--shards", "2", "--out", out.to_str().unwrap()],
    );
    fs::rename(&out, &odd).unwrap();
    let outcome = run_command(command(["shard", "submit", "--dry-run"]).arg(&odd));
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("is not UTF-8"), "{}", outcome.err);
}
