//! Asking Slurm.
use std::ffi::OsString;
use std::io::ErrorKind;
use std::process::{Command, Stdio};

use stochc_ensemble::slurm::{FORMAT, Queue, SlurmEnsemble, SlurmLimits, is_passing};
use stochc_files::shell::visible;

/// Why there is no answer.
#[derive(Debug)]
pub enum Unanswered {
    /// There is no Slurm here.
    NotInstalled(&'static str),
    /// It has refused, in its own words.
    Refused(String),
    /// Nobody was there, in its own words; it may be otherwise in a while.
    Silent(String),
}

/// What Slurm knows of the jobs of an ensemble.
pub fn queue(ensemble: &SlurmEnsemble) -> Result<Queue, Unanswered> {
    let names = format!("--name={},{}", ensemble.name, ensemble.merge_name());
    let format = format!("--format={FORMAT}");
    let printed = ask("squeue", &["--noheader", "--states=all", &names, &format]);
    match printed {
        Ok(printed) => Ok(ensemble.queue(&printed)),
        // Nothing is wrong with the question; the configuration may be.
        Err(Unanswered::Refused(said)) if !is_set_up_wrong(&said) => Err(Unanswered::Silent(said)),
        Err(other) => Err(other),
    }
}

/// Whether a command has found no Slurm that it belongs to, whatever it is asked.
pub fn is_set_up_wrong(said: &str) -> bool {
    said.contains("fatal:")
}

/// How many jobs the site allows.
pub fn limits() -> Result<SlurmLimits, Unanswered> {
    let limits = SlurmLimits::of_config(&ask("scontrol", &["show", "config"])?);
    let user = format!("user={}", std::env::var("USER").unwrap_or_default());
    let associations = [
        "--noheader",
        "--parsable2",
        "show",
        "associations",
        &user,
        "format=MaxSubmitJobs",
    ];
    // Many sites keep no accounts.
    Ok(match ask("sacctmgr", &associations) {
        Ok(said) => limits.and_associations(&said),
        Err(_) => limits,
    })
}

/// Submits a job with a script, and gives its number.
pub fn submit(arguments: &[String]) -> Result<u64, Unanswered> {
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let said = ask("sbatch", &arguments)?;
    let number = said.trim().split(';').next().unwrap_or_default().parse();
    number.map_err(|_| Unanswered::Refused(format!("sbatch: gave no number of a job: {said}")))
}

/// Cancels jobs, as far as they have not ended.
pub fn cancel(jobs: &[u64]) -> Result<(), Unanswered> {
    if jobs.is_empty() {
        return Ok(());
    }
    let jobs: Vec<String> = jobs.iter().map(u64::to_string).collect();
    let jobs: Vec<&str> = jobs.iter().map(String::as_str).collect();
    ask("scancel", &jobs).map(|_| ())
}

/// A command as a person copies it into a shell.
pub fn line(program: &str, arguments: &[String]) -> String {
    let words = std::iter::once(program).chain(arguments.iter().map(String::as_str));
    words.map(visible).collect::<Vec<_>>().join(" ")
}

/// Runs one of Slurm's commands, and gives what it prints.
fn ask(program: &'static str, arguments: &[&str]) -> Result<String, Unanswered> {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null());
    for (name, _) in std::env::vars_os() {
        if decides_for_us(&name) {
            command.env_remove(name);
        }
    }
    // Else lists of tasks end with dots.
    command.env("SLURM_BITSTR_LEN", "0");
    #[cfg(unix)]
    {
        // Ctrl-C is for us alone: a job may be submitted already when its number is not yet told.
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
    }
    let output = match command.output() {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(Unanswered::NotInstalled(program));
        }
        Err(error) => return Err(Unanswered::Refused(format!("{program}: {error}"))),
        Ok(output) => output,
    };
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    let said = match said.is_empty() {
        true => format!("{program}: {}", output.status),
        false => said,
    };
    Err(match is_passing(&said) {
        true => Unanswered::Silent(said),
        false => Unanswered::Refused(said),
    })
}

/// Whether a variable would change what a command prints, or what it waits for.
fn decides_for_us(name: &OsString) -> bool {
    let name = name.to_string_lossy();
    name.starts_with("SQUEUE_") || name.starts_with("SCANCEL_") || name == "SBATCH_WAIT"
}
