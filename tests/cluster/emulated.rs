//! Emulated Slurm cluster, and operations on it.
use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, OnceLock};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::skipped::skipped;

/// Time limit that exceeds every wait on a busy machine.
const PATIENCE: Duration = Duration::from_secs(180);

/// Command line with physics. Its runs are slow enough to stop the process during a run.
pub const SLOW: &str = "simulate examples/line.sa --max-ticks 2500 --seed 3 --runs 8";
/// Command line without physics. It takes almost no time.
pub const FAST: &str = "simulate tests/fixtures/tower.sa --model shuffle --seed 3 --runs 12";

/// Emulated Slurm cluster of two nodes, `n1` and `n2`. Each has one processor, and arrays have at
/// most five tasks.
pub struct Cluster {
    configuration: PathBuf,
    /// Process of the cluster. It ends when its input pipe is closed.
    _run: Child,
}

/// Returns the cluster, which tests use one after the other. Returns `None` if Slurm is not
/// installed.
pub fn cluster() -> Option<MutexGuard<'static, Cluster>> {
    static CLUSTER: OnceLock<Option<Mutex<Cluster>>> = OnceLock::new();
    let cluster = CLUSTER
        .get_or_init(|| Cluster::start().map(Mutex::new))
        .as_ref();
    let Some(cluster) = cluster else {
        skipped("slurm-wlm", "slurmctld");
        return None;
    };
    let cluster = cluster.lock().unwrap_or_else(|failed| failed.into_inner());
    until("two idle nodes", || {
        cluster.ask("sinfo --noheader --Node --format=%t") == "idle\nidle\n"
    });
    Some(cluster)
}

/// Waits until a condition holds.
pub fn until(what: &str, so: impl Fn() -> bool) {
    let start = Instant::now();
    while !so() {
        assert!(start.elapsed() < PATIENCE, "no {what}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

impl Cluster {
    /// Starts a cluster. Returns `None` if Slurm is not installed.
    pub fn start() -> Option<Cluster> {
        let mut run = Command::new("tests/cluster/run");
        run.args(["sh", "-c", "echo \"$SLURM_CONF\"; exec cat"]);
        run.env("STOCHC_SLURM_CONF", "MaxArraySize=5");
        run.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut run = run.spawn().unwrap();
        let mut line = String::new();
        let out = run.stdout.as_mut().unwrap();
        BufReader::new(out).read_line(&mut line).unwrap();
        if line.is_empty() {
            assert_eq!(
                run.wait().unwrap().code(),
                Some(2),
                "the cluster does not start"
            );
            return None;
        }
        let configuration = PathBuf::from(line.trim());
        let _run = run;
        Some(Cluster {
            configuration,
            _run,
        })
    }

    /// Returns the script that runs the cluster.
    pub fn script(&mut self) -> &mut Child {
        &mut self._run
    }

    /// Returns the folder of the cluster.
    pub fn folder(&self) -> &Path {
        self.configuration.parent().unwrap()
    }

    /// Returns a command with the words of a line, for use in the cluster.
    pub fn command(&self, line: &str) -> Command {
        let mut words = line.split_whitespace();
        let mut command = Command::new("env");
        // The process that runs the tests may ignore some signals.
        command.arg("--default-signal=INT,TERM,HUP");
        command.args(words.next().map(|program| match program {
            "stochc" => env!("CARGO_BIN_EXE_stochc"),
            program => program,
        }));
        command.args(words).env("SLURM_CONF", &self.configuration);
        // Jobs inherit the environment of the submitting process.
        command.env_remove("RUST_BACKTRACE");
        command.stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs a command with the words of a line. Returns its output.
    pub fn ask(&self, line: &str) -> String {
        String::from_utf8(self.command(line).output().unwrap().stdout).unwrap()
    }

    /// Starts `stochc shard submit` on a folder.
    pub fn start_submit(&self, folder: &Path, options: &str) -> Child {
        let mut command = self.command(&format!("stochc shard submit --grace 2s {options}"));
        command.arg(folder).spawn().unwrap()
    }

    /// Runs `stochc shard submit` on a folder. Returns its status and output.
    pub fn submit(&self, folder: &Path, options: &str) -> (i32, String) {
        end(self.start_submit(folder, options))
    }

    /// Runs `stochc shard submit` on a folder. Checks that it submits this number of shards.
    #[track_caller]
    pub fn submits(&self, folder: &Path, shards: u64) {
        let (status, printed) = self.submit(folder, "");
        assert_eq!(status, 0, "{printed}");
        assert!(
            printed.contains(&format!("(shards: {shards}, ")),
            "{printed}"
        );
    }

    /// Waits until no job with this name is active.
    pub fn until_ended(&self, name: &str) {
        let line = format!("squeue --noheader --name={name},{name}-merge");
        until("end of all jobs", || self.ask(&line).is_empty());
    }

    /// Returns the number of job arrays with this name that Slurm still lists.
    pub fn arrays(&self, name: &str) -> usize {
        let jobs = self.ask("squeue --noheader --states=all --format=%F|%j");
        let arrays = jobs.lines().filter_map(|line| line.split_once('|'));
        let arrays = arrays.filter(|(_, of)| *of == name).map(|(job, _)| job);
        arrays.collect::<std::collections::BTreeSet<_>>().len()
    }

    /// Returns the name of the job arrays for a folder. The folder must not be merged yet.
    pub fn name(&self, folder: &Path) -> String {
        let shown = self
            .command("stochc shard submit --dry-run")
            .arg(folder)
            .output()
            .unwrap();
        let shown = String::from_utf8(shown.stdout).unwrap();
        let name = shown.split("--job-name=").nth(1);
        let name = name.and_then(|it| it.split_whitespace().next());
        name.unwrap_or_else(|| panic!("{shown}")).to_owned()
    }
}

/// Ensemble that is split into shards, in a temporary folder.
pub struct Ensemble {
    /// Path of the results folder.
    pub path: PathBuf,
    /// Files of the same ensemble when it is made on one machine.
    expected: BTreeMap<PathBuf, Vec<u8>>,
    _folder: TempDir,
}

impl Ensemble {
    /// Splits the ensemble of a command line into shards.
    pub fn cut(line: &str, shards: u64) -> Ensemble {
        static MADE: Mutex<BTreeMap<String, BTreeMap<PathBuf, Vec<u8>>>> =
            Mutex::new(BTreeMap::new());
        let folder = tempfile::tempdir().unwrap();
        let split = format!("{line} --shards {shards}").replacen("simulate", "shard new", 1);
        let make = |name: &str, line: &str| {
            let path = folder.path().join(name);
            let mut command = Command::new(env!("CARGO_BIN_EXE_stochc"));
            command.args(line.split_whitespace()).arg("--quiet");
            let printed = command.arg("--out").arg(&path).output().unwrap();
            assert_ne!(printed.status.code(), Some(2), "{printed:?}");
            path
        };
        let mut made = MADE.lock().unwrap();
        let expected = made.entry(line.to_owned());
        let expected =
            expected.or_insert_with(|| files(&make("plain", &format!("{line} --threads 1"))));
        Ensemble {
            // The name contains special characters of the shell and of Slurm.
            path: make("it's 100 %A \\ \"of\"\n$HOME", &split),
            expected: expected.clone(),
            _folder: folder,
        }
    }

    /// Waits until the ensemble is merged. Then checks that its folder equals the folder made on
    /// one machine.
    #[track_caller]
    pub fn is_made(&self) {
        until("merged ensemble", || {
            !self.path.join("shards.json").exists()
        });
        assert!(files(&self.path) == self.expected);
    }
}

/// Returns the content of every file below a folder, except the lock.
pub fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = PathBuf::from(path.file_name().unwrap());
        if path.is_dir() {
            found.insert(name.clone(), Vec::new());
            found.extend(
                files(&path)
                    .into_iter()
                    .map(|(file, content)| (name.join(file), content)),
            );
        } else if name != Path::new(".lock") {
            found.insert(name, fs::read(path).unwrap());
        }
    }
    found
}

/// Waits until a process ends. Returns its status and output.
pub fn end(child: Child) -> (i32, String) {
    let Output {
        status,
        stdout,
        stderr,
    } = child.wait_with_output().unwrap();
    let text = String::from_utf8([stdout, stderr].concat()).unwrap();
    (status.code().unwrap(), text)
}

/// Returns the ids of processes whose arguments and environment match.
fn processes(matches: impl Fn(&[&[u8]], &[&[u8]]) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir("/proc").unwrap().flatten() {
        let read = |name: &str| fs::read(entry.path().join(name)).unwrap_or_default();
        let (arguments, environment) = (read("cmdline"), read("environ"));
        let [arguments, environment]: [Vec<&[u8]>; 2] =
            [&arguments, &environment].map(|text| text.split(|byte| *byte == 0).collect());
        let id = entry.file_name().into_string().unwrap();
        if id.bytes().all(|byte| byte.is_ascii_digit()) && matches(&arguments, &environment) {
            found.push(id);
        }
    }
    found
}

/// Id of a stopped process. It runs a shard and has finished some of its runs.
pub struct Held(pub String);

impl Held {
    /// Waits until a process runs the shard, and stops it.
    pub fn making(folder: &Path, piece: &str) -> Held {
        let path = folder.as_os_str().as_encoded_bytes();
        let find = || {
            processes(
                |arguments, _| matches!(arguments, [_, b"shard", b"run", of, number, ..] if *of == path && *number == piece.as_bytes()),
            )
        };
        let lines = |path| {
            fs::read_to_string(path)
                .unwrap_or_default()
                .matches('\n')
                .count()
        };
        let has_run = || {
            let entries = fs::read_dir(folder.join("shards")).unwrap().flatten();
            let part = format!("{piece}.part-");
            let is_part = |path: &PathBuf| {
                path.file_name()
                    .unwrap()
                    .to_str()
                    .unwrap()
                    .starts_with(&part)
            };
            entries
                .map(|entry| entry.path())
                .filter(is_part)
                .map(lines)
                .any(|lines| lines > 1)
        };
        until("process that makes a shard", || {
            !find().is_empty() && has_run()
        });
        let id = find().pop().expect("the shard has several runs");
        signal("-STOP", std::slice::from_ref(&id));
        let whole = folder.join("shards").join(format!("{piece}.jsonl"));
        assert!(
            !whole.exists(),
            "a shard was finished before its process was stopped"
        );
        Held(id)
    }

    /// Lets the process continue.
    pub fn resume(self) {
        signal("-CONT", &[self.0]);
    }
}

/// Sends a signal to processes. Ignores processes that have ended.
pub fn signal(signal: &str, ids: &[String]) {
    let _ = Command::new("kill")
        .arg(signal)
        .args(ids)
        .stderr(Stdio::null())
        .status();
}

/// Returns the ids of the cluster's processes, only those on `node` if it is given.
pub fn members(cluster: &Cluster, node: Option<&str>) -> Vec<String> {
    let configuration = format!("SLURM_CONF={}", cluster.configuration.display());
    let node = node.map(|node| format!("SLURMD_NODENAME={node}"));
    processes(|arguments, environment| {
        let of_node = node.as_ref().is_none_or(|node| {
            let name = &node.as_bytes()[node.len() - 2..];
            environment.contains(&node.as_bytes())
                || arguments.starts_with(&[b"slurmd", b"-N", name])
        });
        environment.contains(&configuration.as_bytes()) && of_node
    })
}

/// Returns the process id of a daemon of the cluster.
pub fn daemon(cluster: &Cluster, name: &str) -> String {
    let id = fs::read_to_string(cluster.folder().join(format!("{name}.pid")));
    id.unwrap().trim().to_owned()
}
