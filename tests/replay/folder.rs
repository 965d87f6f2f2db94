//! Results folders for tests of replays.
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use stochc::ir::table::Tables;
use stochc::results::recording::{Recording, path};

/// Program whose structure grows and is then released.
pub const PROGRAM: &str = "examples/five_tower_reconfigured.sa";

/// Program with pre-attached blocks. The name of one of them is later given to another block.
pub const PASSED_ON: &str = "tests/fixtures/passed_on.sa";

/// Aggregate: free blocks that bond to each other.
pub const SWARM: &str = "tests/fixtures/swarm.sa";

/// Temporary results folder.
pub struct Results {
    folder: tempfile::TempDir,
    program: String,
}

/// Result of a command: its status and output.
pub struct Outcome {
    pub status: i32,
    pub out: String,
    pub err: String,
}

/// Runs `stochc` with the words of `line` as arguments, followed by `more`.
pub fn stochc(line: &str, more: &[&Path]) -> Outcome {
    let output = Command::new(env!("CARGO_BIN_EXE_stochc"))
        .args(line.split_whitespace())
        .args(more)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    Outcome {
        status: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

impl Results {
    /// Makes two runs of a program with the fast model, with additional options.
    pub fn from_records(program: &str, options: &str) -> Results {
        let folder = tempfile::tempdir().unwrap();
        let line = format!("simulate --substeps 1 --runs 2 --quiet {options} {program} --out");
        let outcome = stochc(&line, &[&folder.path().join("results")]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        let program = program.to_owned();
        Results { folder, program }
    }

    pub fn path(&self) -> PathBuf {
        self.folder.path().join("results")
    }

    /// Returns the path of the recording of a run, which may be missing.
    pub fn recording_path(&self, run: u64) -> PathBuf {
        path(&self.path(), 0, run)
    }

    pub fn tables(&self) -> Tables {
        let mut checked = stochc::check(&self.program);
        checked.programs.remove(0).tables.unwrap()
    }

    pub fn recording(&self, run: u64) -> Recording {
        let bytes = std::fs::read(self.recording_path(run)).unwrap();
        Recording::read(&bytes[..], &self.tables()).unwrap()
    }

    /// Writes the replay page of a run. Returns its path.
    pub fn page(&self, run: u64) -> PathBuf {
        let page = self.folder.path().join(format!("page {run}.html"));
        let outcome = stochc(&format!("replay --run {run} --out"), &[&page, &self.path()]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        page
    }
}
