//! `stochc submit`.
mod follow;
mod slurm;

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use stochc_ensemble::slurm::{
    FoundPieces, JobArray, Opened, SlurmEnsemble, SlurmLimits, merge_script, pieces_script,
};

use super::interrupt::stop_on_interrupt;
use super::merge::is_whole;
use super::terminal::print;
use crate::exit::{Exit, Failure};
use crate::operations::time;
use follow::follow;

/// What `submit` is given.
#[derive(Debug, Args)]
pub struct SubmitArguments {
    /// Folder of `simulate --shards`, which all nodes see under the same name
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Partition of the jobs [default: that of the site]
    #[arg(long, short, value_name = "NAME")]
    partition: Option<String>,
    /// Time limit of a task, in Slurm's form, such as 30 (minutes), 2:00:00 or 1-0
    #[arg(long, short, value_name = "TIME")]
    time: Option<String>,
    /// Pieces of a task; more, where the site allows fewer tasks
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    per_task: u64,
    /// A further option of `sbatch`, for all jobs, such as --sbatch=--mem=2G; can be given several times
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true, value_parser = sbatch_option)]
    sbatch: Vec<String>,
    /// How often pieces that are missing are submitted
    #[arg(long, value_name = "K", default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..))]
    attempts: u64,
    /// How long to wait for a controller that does not answer
    #[arg(long, value_name = "TIME", default_value = "10m", value_parser = time)]
    controller_timeout: Duration,
    /// Cancel the jobs at Ctrl-C, or when the terminal closes, instead of leaving them to the cluster
    #[arg(long)]
    cancel_on_interrupt: bool,
    /// Print the scripts and the commands that would submit them, and do nothing
    #[arg(long)]
    dry_run: bool,
    /// Do not show progress, nor that it is done
    #[arg(long, short)]
    quiet: bool,
}

/// Refuses an option that decides what has to be decided here.
fn sbatch_option(option: &str) -> Result<String, String> {
    /// What would keep the jobs from being followed.
    const OURS: [(&str, &str); 4] = [
        ("--wait", "-W"),
        ("--clusters", "-M"),
        ("--wrap", "--wrap"),
        ("--test-only", "--test-only"),
    ];
    let name = option.split('=').next().unwrap_or_default();
    let is_ours = |(long, short): &(&str, &str)| name == *long || name.starts_with(short);
    match OURS.iter().any(is_ours) {
        true => Err("jobs that are submitted so cannot be followed".to_owned()),
        false => Ok(option.to_owned()),
    }
}

/// What is submitted: commands and scripts.
struct SubmittedJobs<'a> {
    options: &'a SubmitArguments,
    ensemble: &'a SlurmEnsemble,
    stochc: String,
    folder: String,
}

/// Has a cluster make an ensemble.
pub fn run(options: &SubmitArguments) -> Result<Exit, Failure> {
    let stop = stop_on_interrupt()?;
    let shown = options.folder.to_string_lossy();
    let path = options.folder.canonicalize();
    let path = path.map_err(|error| Failure::usage(format!("cannot use `{shown}`: {error}")))?;
    let ensemble = match SlurmEnsemble::open(&path).map_err(Failure::usage)? {
        Opened::Cut(ensemble) => ensemble,
        Opened::Merged(runs) => {
            if !options.quiet {
                print(&is_whole(&options.folder, runs))?;
            }
            return Ok(Exit::Success);
        }
    };
    let jobs = SubmittedJobs::new(options, &ensemble)?;
    if options.dry_run {
        return jobs.show();
    }
    follow(&jobs, stop)
}

impl SubmittedJobs<'_> {
    fn new<'a>(
        options: &'a SubmitArguments,
        ensemble: &'a SlurmEnsemble,
    ) -> Result<SubmittedJobs<'a>, Failure> {
        let text = |path: PathBuf| match path.into_os_string().into_string() {
            Ok(text) => Ok(text),
            Err(path) => Err(Failure::usage(format!(
                "`{}` is no UTF-8, and cannot be said in a script; give it another name",
                path.to_string_lossy()
            ))),
        };
        let stochc = std::env::current_exe();
        let stochc = stochc.map_err(|error| {
            Failure::usage(format!("cannot tell where this command is: {error}"))
        })?;
        Ok(SubmittedJobs {
            options,
            ensemble,
            stochc: text(stochc)?,
            folder: text(ensemble.path.clone())?,
        })
    }

    /// How many pieces a task makes.
    fn per_task(&self, limits: SlurmLimits) -> Result<u64, Failure> {
        let per_task = limits.per_task(self.ensemble.pieces, self.options.per_task);
        per_task.ok_or_else(|| {
            Failure::usage(
                "this site allows no job arrays (MaxArraySize is 0); submit `stochc shard` by yourself, piece by piece",
            )
        })
    }

    fn scripts(&self, per_task: u64) -> [String; 2] {
        let pieces = self.ensemble.pieces;
        [
            pieces_script(&self.stochc, &self.folder, pieces, per_task),
            merge_script(&self.stochc, &self.folder),
        ]
    }

    /// What `sbatch` is given for an array of these tasks.
    fn array(&self, tasks: &JobArray, script: &str) -> Vec<String> {
        let indices = format!("--array={}", tasks.indices());
        self.arguments(&self.ensemble.name, Some(indices), script)
    }

    /// What `sbatch` is given to put the pieces together, when these arrays have ended.
    fn merge(&self, after: &[String], script: &str) -> Vec<String> {
        let after: String = after.iter().map(|array| format!(":{array}")).collect();
        let after = (!after.is_empty()).then(|| format!("--dependency=afterany{after}"));
        self.arguments(&self.ensemble.merge_name(), after, script)
    }

    /// Of options that are given twice, the last holds.
    fn arguments(&self, name: &str, own: Option<String>, script: &str) -> Vec<String> {
        let given = [
            ("partition", &self.options.partition),
            ("time", &self.options.time),
        ];
        let given = given.into_iter().filter_map(|(option, value)| {
            value.as_ref().map(|value| format!("--{option}={value}"))
        });
        let mut arguments: Vec<String> = given.chain(self.options.sbatch.iter().cloned()).collect();
        arguments.extend([
            "--parsable".to_owned(),
            format!("--job-name={name}"),
            "--chdir=/".to_owned(),
            "--output=/dev/null".to_owned(),
        ]);
        arguments.extend(own);
        arguments.push(script.to_owned());
        arguments
    }

    /// Prints what would be submitted if nothing were queued.
    fn show(&self) -> Result<Exit, Failure> {
        let FoundPieces::AllBut(missing) = self.ensemble.look(false).map_err(Failure::usage)?
        else {
            return Ok(Exit::Success);
        };
        // Without Slurm there is something to see as well.
        let per_task = self.per_task(slurm::limits().unwrap_or_default())?;
        let [pieces, merge] = self.scripts(per_task);
        let script = |name: &str| format!("{}/slurm/{name}.sh", self.folder);
        let array = JobArray::of(&missing, per_task);
        let mut text = String::new();
        let mut after = Vec::new();
        if !missing.is_empty() {
            let command = slurm::line("sbatch", &self.array(&array, &script("pieces")));
            text += &format!(
                "# slurm/pieces.sh\n{pieces}\n# to make {} pieces\n{command}\n\n",
                missing.len()
            );
            after.push("JOB".to_owned());
        }
        let command = slurm::line("sbatch", &self.merge(&after, &script("merge")));
        text += &format!("# slurm/merge.sh\n{merge}\n# to put them together\n{command}\n");
        print(&text)?;
        Ok(Exit::Success)
    }
}
