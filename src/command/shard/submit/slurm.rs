//! Calls of Slurm commands.
use std::ffi::OsStr;
use std::io::ErrorKind;
use std::process::{Command, Stdio};

use stochc_files::shell::visible;
use stochc_results::slurm::{FORMAT, Queue, SlurmEnsemble, SlurmLimits};

/// Error of a Slurm command that failed or is not installed. Contains its message.
#[derive(Debug)]
pub struct SlurmError(String);

impl std::fmt::Display for SlurmError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl SlurmError {
    /// Returns whether Slurm may have accepted the job although the answer was lost.
    pub fn is_lost_answer(&self) -> bool {
        const LOST: [&str; 5] = [
            "timed out",
            "Zero Bytes were transmitted",
            "Transport endpoint is not connected",
            "Communication connection failure",
            "receive failure",
        ];
        LOST.iter().any(|part| self.0.contains(part))
    }

    /// Returns whether Slurm refused the job because of a limit on jobs or tasks.
    pub fn is_limit(&self) -> bool {
        const LIMITS: [&str; 4] = ["QOS", "Assoc", "submit limit", "job array"];
        LIMITS.iter().any(|part| self.0.contains(part))
    }
}

pub fn queue(ensemble: &SlurmEnsemble) -> Result<Queue, SlurmError> {
    let names = format!("--name={},{}", ensemble.name, ensemble.merge_name());
    let format = format!("--format={FORMAT}");
    let output = run("squeue", ["--noheader", "--states=all", &names, &format])?;
    Ok(ensemble.queue(&output))
}

pub fn limits() -> Result<SlurmLimits, SlurmError> {
    let limits = SlurmLimits::from_config(&run("scontrol", ["show", "config"])?);
    let user = format!("user={}", std::env::var("USER").unwrap_or_default());
    let associations = [
        "--noheader",
        "--parsable2",
        "show",
        "associations",
        &user,
        "format=MaxSubmitJobs",
    ];
    // Many clusters have no accounting.
    Ok(match run("sacctmgr", associations) {
        Ok(output) => limits.with_associations(&output),
        Err(_) => limits,
    })
}

/// Returns a command line with its arguments quoted for a shell.
pub fn line(program: &str, arguments: &[String]) -> String {
    let words = std::iter::once(program).chain(arguments.iter().map(String::as_str));
    words.map(visible).collect::<Vec<_>>().join(" ")
}

/// Runs a command of Slurm and returns its output.
pub fn run(
    program: &'static str,
    arguments: impl IntoIterator<Item = impl AsRef<OsStr>>,
) -> Result<String, SlurmError> {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null());
    for (name, _) in std::env::vars_os() {
        if is_unset(&name) {
            command.env_remove(name);
        }
    }
    // Without this variable, squeue shortens long lists of tasks.
    command.env("SLURM_BITSTR_LEN", "0");
    let failed = |message: String| SlurmError(format!("`{program}` failed: {message}"));
    let output = command.output().map_err(|error| match error.kind() {
        ErrorKind::NotFound => SlurmError(format!("`{program}` is not installed")),
        _ => failed(error.to_string()),
    })?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    Err(failed(if message.is_empty() {
        output.status.to_string()
    } else {
        message
    }))
}

/// Returns whether an environment variable must be removed because it would change jobs or output.
fn is_unset(name: &OsStr) -> bool {
    let name = name.to_string_lossy();
    name.starts_with("SQUEUE_") || name == "SBATCH_WAIT" || name == "SBATCH_ARRAY_INX"
}
