//! `submit` where there is no Slurm; with it: tests/cluster.
use std::fs;
use std::path::Path;

use crate::stochc::{Said, command, path, said, stochc_with};

const TOWER: &str = "simulate --model shuffle tests/fixtures/tower.sa --runs 10 --seed 3 --quiet";

/// Does `submit` where no command of Slurm is installed.
fn submit(arguments: &[&str]) -> Said {
    let arguments = std::iter::once("submit").chain(arguments.iter().copied());
    said(command(arguments).env("PATH", ""))
}

#[test]
fn without_slurm_there_is_a_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    stochc_with(TOWER, &["--shards", "4", "--out", &out]);
    let said = submit(&[&out]);
    assert_eq!((said.status, said.out.as_str()), (2, ""));
    assert!(
        said.err.contains("`squeue` is not installed"),
        "{}",
        said.err
    );
    assert!(said.err.contains("stochc status"), "{}", said.err);
    assert!(!Path::new(&out).join("slurm").exists());
}

/// The commands are there, and nobody has told them of a cluster.
#[cfg(unix)]
#[test]
fn without_a_configuration_there_is_a_way_out() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    stochc_with(TOWER, &["--shards", "4", "--out", &out]);
    let squeue = folder.path().join("squeue");
    let script =
        "#!/bin/sh\necho 'squeue: fatal: Could not establish a configuration source' >&2\nexit 1\n";
    fs::write(&squeue, script).unwrap();
    fs::set_permissions(&squeue, fs::Permissions::from_mode(0o755)).unwrap();
    let said = said(command(["submit", &out]).env("PATH", folder.path()));
    assert_eq!((said.status, said.out.as_str()), (2, ""), "{}", said.err);
    for what in [
        "establish a configuration",
        "do not work here",
        "stochc status",
    ] {
        assert!(said.err.contains(what), "{what}: {}", said.err);
    }
    assert!(!said.err.contains("--partition"), "{}", said.err);
}

#[test]
fn a_dry_run_shows_scripts_and_commands() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "it's out");
    stochc_with(TOWER, &["--shards", "4", "--out", &out]);
    stochc_with("shard --quiet", &[&out, "2"]);
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
    // It holds the place of the folder.
    let name = shown.split("--job-name=").nth(1).unwrap();
    let name = name.split_whitespace().next().unwrap();
    assert!(name.starts_with("stochc-"), "{name}");
    insta::assert_snapshot!(shown.replace(name, "NAME"));
    assert!(!Path::new(&out).join("slurm").exists());
    // More pieces than Slurm takes tasks, where a site says nothing.
    let many = path(folder.path(), "many");
    let line = "simulate --model shuffle tests/fixtures/tower.sa --runs 4000 --shards 4000 --quiet";
    stochc_with(line, &["--out", &many]);
    let shown = submit(&[&many, "--dry-run"]).out;
    assert!(shown.contains("per_task=4\n"), "{shown}");
    assert!(shown.contains("--array=0-999 "), "{shown}");
}

/// The scripts do what they say: with a shell in the place of Slurm.
#[test]
#[cfg(unix)]
fn the_scripts_are_plain_shell() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, out] = ["plain", "$(out) it's"].map(|name| path(folder.path(), name));
    stochc_with(TOWER, &["--threads", "1", "--out", &plain]);
    stochc_with(TOWER, &["--shards", "5", "--out", &out]);
    let shown = submit(&[&out, "--dry-run", "--per-task", "2"]).out;
    let mut scripts = shown.split("#!/bin/sh\n").skip(1);
    let [pieces, merge] = [scripts.next().unwrap(), scripts.next().unwrap()].map(|script| {
        let end = script.find("\n# to ").unwrap();
        &script[..end]
    });
    fs::create_dir(Path::new(&out).join("slurm")).unwrap();
    let run = |script: &str, task: &str| {
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", script]);
        shell
            .env("SLURM_ARRAY_JOB_ID", "12")
            .env("SLURM_ARRAY_TASK_ID", task);
        said(shell.env("SLURM_JOB_ID", "13"))
    };
    let log = |name: &str| fs::read_to_string(Path::new(&out).join("slurm").join(name));
    assert_eq!(run(merge, "").status, 3);
    assert!(
        log("merge_13.log")
            .unwrap()
            .contains("5 of 5 pieces are missing")
    );
    for task in ["2", "0"] {
        let said = run(pieces, task);
        assert_eq!((said.status, said.err.as_str()), (0, ""));
    }
    // In the place of a piece there is something else: the other piece of the task is made.
    let shards = Path::new(&out).join("shards");
    fs::copy(shards.join("0.jsonl"), shards.join("3.jsonl")).unwrap();
    assert_eq!(run(pieces, "1").status, 2);
    let told = log("12_1.log").unwrap();
    assert!(told.contains("is in fact piece 0 of 5"), "{told}");
    assert!(
        told.ends_with("piece 3 has ended with status 2\n"),
        "{told}"
    );
    assert!(shards.join("2.jsonl").exists());
    let refused = submit(&[&out, "--dry-run"]);
    assert_eq!(refused.status, 2);
    assert!(
        refused.err.contains("piece 3 is in fact piece 0"),
        "{}",
        refused.err
    );
    fs::remove_file(shards.join("3.jsonl")).unwrap();
    assert_eq!(run(pieces, "1").status, 0);
    assert!(log("12_1.log").is_err());
    assert_eq!(run(merge, "").status, 0);
    assert_eq!(
        stochc_with("verify", &[&out]).out,
        stochc_with("verify", &[&plain]).out
    );
    assert!(!Path::new(&out).join("slurm").exists());
    let again = submit(&[&out]);
    assert_eq!(again.status, 0, "{}", again.err);
    assert!(again.out.contains("is whole: 10 runs"), "{}", again.out);
}

#[test]
fn what_cannot_be_submitted_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let refused = |arguments: &[&str], reason: &str| {
        let said = submit(arguments);
        assert_eq!((said.status, said.out.as_str()), (2, ""), "{}", said.err);
        assert!(said.err.contains(reason), "{arguments:?}: {}", said.err);
    };
    refused(&[&out], "cannot use");
    refused(&[folder.path().to_str().unwrap()], "holds no results");
    stochc_with(TOWER, &["--shards", "4", "--out", &out]);
    for option in [
        "--wait",
        "-W",
        "--clusters=a",
        "-Ma",
        "--wrap=x",
        "--test-only",
    ] {
        refused(&[&out, "--sbatch", option], "cannot be followed");
    }
    refused(&[&out, "--attempts", "0"], "--attempts");
    refused(&[&out, "--per-task", "0"], "--per-task");
    refused(&[&out, "--controller-timeout", "1"], "number and its unit");
    // What was submitted cannot be read.
    let slurm = Path::new(&out).join("slurm");
    fs::create_dir(&slurm).unwrap();
    fs::write(slurm.join("jobs.json"), "{\"submissions\":[").unwrap();
    refused(&[&out], "it is damaged; remove it");
    // Another build.
    let manifest = Path::new(&out).join("manifest.json");
    let text = fs::read_to_string(&manifest).unwrap();
    let build = stochc::ensemble::this_build();
    fs::write(&manifest, text.replace(&build, "0123456789abcdef")).unwrap();
    fs::remove_file(Path::new(&out).join("checksums.json")).unwrap();
    refused(&[&out], "0123456789abcdef");
    // And a folder that one process has begun to fill without pieces.
    let begun = path(folder.path(), "begun");
    stochc_with(TOWER, &["--out", &begun]);
    let journal = Path::new(&begun).join("journal.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    let part: Vec<&str> = text.split_inclusive('\n').take(3).collect();
    fs::write(&journal, part.concat()).unwrap();
    refused(&[&begun], "is not cut into pieces: 2 of 10 runs");
}

#[test]
#[cfg(target_os = "linux")]
fn a_name_that_is_no_text_is_refused() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().unwrap();
    let [out, odd] =
        [&b"out"[..], b"\xff"].map(|it| folder.path().join(std::ffi::OsStr::from_bytes(it)));
    stochc_with(TOWER, &["--shards", "2", "--out", out.to_str().unwrap()]);
    fs::rename(&out, &odd).unwrap();
    let said = said(command(["submit", "--dry-run"]).arg(&odd));
    assert_eq!(said.status, 2);
    assert!(said.err.contains("is no UTF-8"), "{}", said.err);
}
