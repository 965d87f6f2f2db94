//! Arguments of `stochc shard submit`.
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use crate::operations::time;

/// Arguments of `submit`.
#[derive(Debug, Args)]
pub struct SubmitArguments {
    /// Folder of `stochc shard new`. It needs the same path on all nodes
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Partition of the jobs [default: the default partition of the site]
    #[arg(long, short, value_name = "NAME")]
    pub partition: Option<String>,
    /// Time limit of each task, in the format of Slurm: 30 (minutes), 2:00:00 (hours) or 1-0 (days-hours)
    #[arg(long, short, value_name = "TIME")]
    pub time: Option<String>,
    /// Smallest number of shards per task. It is larger if the site limits the number of tasks
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    pub per_task: u64,
    /// Largest number of tasks that run at the same time
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub at_most: Option<u64>,
    /// Another option of `sbatch` for all jobs, such as --sbatch=--mem=2G. Can be repeated
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true, value_parser = sbatch_option)]
    pub sbatch: Vec<String>,
    /// Waiting time before resubmission, because new jobs and files may not be visible at once
    #[arg(long, value_name = "TIME", default_value = "90s", value_parser = time)]
    pub grace: Duration,
    /// Print the scripts and the `sbatch` commands without submitting them
    #[arg(long)]
    pub dry_run: bool,
}

/// Checks an option for `sbatch`. Rejects options that `submit` sets itself, or that prevent it
/// from finding the job.
fn sbatch_option(option: &str) -> Result<String, String> {
    const RESERVED: [(&str, &str); 12] = [
        ("--array", "-a"),
        ("--job-name", "-J"),
        ("--output", "-o"),
        ("--chdir", "-D"),
        ("--parsable", ""),
        ("--wait", "-W"),
        ("--clusters", "-M"),
        ("--wrap", ""),
        ("--test-only", ""),
        ("--help", "-h"),
        ("--usage", ""),
        ("--version", "-V"),
    ];
    if !option.starts_with('-') {
        let hint = "expected an option with its value in one word, such as --sbatch=--mem=2G";
        return Err(hint.to_owned());
    }
    let name = option.split('=').next().unwrap_or_default();
    // Slurm also accepts abbreviations of long options.
    let is_long = |long: &str| name.len() > 2 && long.starts_with(name);
    let is_short = |short: &str| !short.is_empty() && name.starts_with(short);
    match RESERVED
        .iter()
        .find(|(long, short)| is_long(long) || is_short(short))
    {
        Some(("--array", _)) => {
            Err("`submit` sets the array; use --per-task and --at-most".to_owned())
        }
        Some((long, _)) => Err(format!(
            "`submit` cannot be combined with {long} of `sbatch`"
        )),
        None => Ok(option.to_owned()),
    }
}
