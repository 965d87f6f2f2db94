//! Submission of the shards of an ensemble and of a merge job.
use std::collections::BTreeSet;
use std::time::Duration;

use stochc_files::shell::file as shell_file;
use stochc_results::now;
use stochc_results::shards::{ShardError, merge};
use stochc_results::slurm::{FoundShards, Opened, Queue, SlurmEnsemble, job_number, tasks};
use stochc_text::{visible, visible_lines, words};

use super::arguments::SubmitArguments;
use super::jobs::Jobs;
use super::slurm;
use super::slurm::SlurmError;
use crate::command::shard::merge::merged;
use crate::command::terminal::{is_quiet, print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::sweep::files_for_screens;

/// Submits the missing shards of an ensemble. If no job is needed, reports the reason.
pub fn run(options: &SubmitArguments) -> Result<Exit, Failure> {
    if std::env::var_os("SBATCH_CLUSTERS").is_some() {
        return Err(Failure::usage(
            "SBATCH_CLUSTERS sends jobs to a cluster that `squeue` does not list; set SLURM_CLUSTERS instead, which all commands of Slurm read",
        ));
    }
    let shown = options.folder.to_string_lossy();
    let path = options.folder.canonicalize();
    let path = path.map_err(|error| Failure::usage(format!("cannot use `{shown}`: {error}")))?;
    let ensemble = match SlurmEnsemble::open(&path).map_err(Failure::usage)? {
        Opened::Sharded(ensemble) => ensemble,
        Opened::Merged(runs) => return options.print(&merged(&options.folder, runs)),
    };
    let jobs = Jobs::new(options, &ensemble)?;
    if options.dry_run {
        if let FoundShards::AllBut(missing) = ensemble.find_shards().map_err(Failure::usage)? {
            print(&jobs.preview(&missing)?)?;
        }
        return Ok(Exit::Success);
    }
    let submission = Submission {
        options,
        ensemble: &ensemble,
        jobs,
        folder: shell_file(&visible(&shown)),
    };
    // Check that Slurm answers before writing files.
    submission.queue()?;
    let Some(_lock) = ensemble.lock().map_err(Failure::usage)? else {
        let folder = visible(&shown);
        return Err(Failure::usage(format!(
            "another `stochc shard submit` is working on `{folder}`; run it again later"
        )));
    };
    submission.run()
}

impl SubmitArguments {
    /// Prints a text. Prints nothing with `--quiet`.
    fn print(&self, text: &str) -> Result<Exit, Failure> {
        if !is_quiet() {
            print(text)?;
        }
        Ok(Exit::Success)
    }
}

/// Data of one call of `submit`. The call locks the folder while it submits jobs.
struct Submission<'a> {
    pub(super) options: &'a SubmitArguments,
    pub(super) ensemble: &'a SlurmEnsemble,
    pub(super) jobs: Jobs<'a>,
    /// Path of the results folder, quoted for a shell.
    pub(super) folder: String,
}

/// Jobs and shards of an ensemble at one moment.
struct State {
    pub(super) queue: Queue,
    /// Shards that exist in the folder. `None` if a job array is active: the folder is then not
    /// examined.
    found: Option<FoundShards>,
}

impl State {
    fn is_settled(&self) -> bool {
        !self.queue.active_merges().is_empty() || matches!(self.found, Some(FoundShards::Merged(_)))
    }
}

impl Submission<'_> {
    pub(super) fn run(&self) -> Result<Exit, Failure> {
        let state = self.settle()?;
        if !state.queue.active_merges().is_empty() {
            let summary = state.queue.summary();
            let mut jobs = state.queue.active_arrays();
            jobs.extend(state.queue.active_merges());
            return self.report(&format!("{summary}; nothing was submitted"), &jobs);
        }
        match state.found {
            None => self.submit_merge(&state.queue, &state.queue.active_arrays()),
            Some(FoundShards::Merged(runs)) => {
                // Locking may have created the folder for Slurm.
                self.ensemble.clear().map_err(Failure::usage)?;
                self.options.print(&merged(&self.options.folder, runs))
            }
            Some(FoundShards::AllBut(missing)) if missing.is_empty() => self.merge(&state.queue),
            Some(FoundShards::AllBut(missing)) => self.submit_shards(&state.queue, &missing),
        }
    }

    /// Returns the current jobs and shards. After an earlier submission, waits for jobs and files
    /// that may not be visible yet.
    fn settle(&self) -> Result<State, Failure> {
        let state = self.state()?;
        if state.is_settled() || !self.ensemble.was_submitted() {
            return Ok(state);
        }
        if !is_quiet() {
            let grace = words(self.options.grace);
            warn(&format!(
                "waiting up to {grace} (`--grace`) for jobs and files that are not visible yet\n"
            ));
        }
        poll(self.options.grace, || self.state(), State::is_settled)
    }

    fn state(&self) -> Result<State, Failure> {
        let queue = self.queue()?;
        let found = if queue.active_arrays().is_empty() {
            Some(self.ensemble.find_shards().map_err(Failure::usage)?)
        } else {
            None
        };
        Ok(State { queue, found })
    }

    /// Merges the shards in this process. Resubmits corrupted shards.
    pub(super) fn merge(&self, queue: &Queue) -> Result<Exit, Failure> {
        match merge(&self.ensemble.path, files_for_screens) {
            Ok(runs) => self.options.print(&merged(&self.options.folder, runs)),
            Err(ShardError::Missing { shards, .. }) => self.submit_shards(queue, &shards),
            Err(error) => Err(Failure::usage(error)),
        }
    }

    /// Submits a job array that runs the missing shards, and a merge job.
    fn submit_shards(&self, queue: &Queue, missing: &[u64]) -> Result<Exit, Failure> {
        let per_task = self
            .jobs
            .per_task(slurm::limits().map_err(|it| self.unanswered(&it))?)?;
        let tasks = tasks(missing, per_task);
        let [shards, merge] = self.write_scripts(per_task)?;
        let listed = queue.numbers();
        let array = self.submit(&self.jobs.array(&tasks, &shards), &listed);
        let array = array.map_err(|refusal| {
            if !refusal.may_be_accepted {
                let _ = self.ensemble.remove_shards_script();
            }
            self.refused("the job array", &refusal)
        })?;
        let merge = self.jobs.merge(&[array.to_string()], &merge);
        let merge = self.submit(&merge, &(&listed | &BTreeSet::from([array])));
        let merge = merge.map_err(|refusal| {
            self.refused(&format!("the merge job after job array {array}"), &refusal)
        })?;
        let (shards, tasks) = (missing.len(), tasks.len());
        self.report(
            &format!("submitted job array {array} (shards: {shards}, tasks: {tasks}) and merge job {merge}"),
            &[array, merge],
        )
    }

    /// Submits a merge job that waits for these arrays.
    fn submit_merge(&self, queue: &Queue, arrays: &[u64]) -> Result<Exit, Failure> {
        let per_task = self.options.per_task;
        let [_, script] = self.write_scripts(per_task)?;
        let after: Vec<String> = arrays.iter().map(u64::to_string).collect();
        let merge = self.submit(&self.jobs.merge(&after, &script), &queue.numbers());
        let merge = merge.map_err(|refusal| self.refused("the merge job", &refusal))?;
        let what = format!("{}; submitted merge job {merge}", queue.summary());
        self.report(&what, &[arrays, &[merge]].concat())
    }

    fn write_scripts(&self, per_task: u64) -> Result<[String; 2], Failure> {
        let [shards, merge] = self.jobs.scripts(per_task);
        let scripts = self.ensemble.write_scripts(&shards, &merge);
        let scripts = scripts.map_err(Failure::usage)?;
        Ok(scripts.map(|path| path.to_string_lossy().into_owned()))
    }

    /// Runs `sbatch` and returns the number of the job. `listed` are the jobs that Slurm listed
    /// before.
    ///
    /// If the answer is lost or lacks the number, finds the new job by its name.
    pub(super) fn submit(
        &self,
        arguments: &[String],
        listed: &BTreeSet<u64>,
    ) -> Result<u64, Refusal> {
        let answer = slurm::run("sbatch", arguments);
        if let Some(number) = answer.as_deref().ok().and_then(job_number) {
            return Ok(number);
        }
        let may_be_accepted = answer.as_ref().err().is_none_or(SlurmError::is_lost_answer);
        let grace = if may_be_accepted {
            self.options.grace
        } else {
            Duration::ZERO
        };
        let find = || {
            let queue = slurm::queue(self.ensemble)?;
            Ok::<_, SlurmError>(queue.numbers().difference(listed).max().copied())
        };
        let found = poll(grace, find, Option::is_some);
        found.ok().flatten().ok_or(Refusal {
            may_be_accepted,
            error: answer.err(),
        })
    }

    pub(super) fn queue(&self) -> Result<Queue, Failure> {
        slurm::queue(self.ensemble).map_err(|error| self.unanswered(&error))
    }

    /// Reports the action, and the command that shows the jobs.
    fn report(&self, what: &str, jobs: &[u64]) -> Result<Exit, Failure> {
        let folder = &self.folder;
        let jobs: Vec<String> = jobs.iter().map(u64::to_string).collect();
        let mut text = format!(
            "{what}\n\
             To see the queue: squeue --jobs={}\n\
             To see the shards: stochc shard status {folder}\n\
             To cancel: scancel {}\n\
             After the jobs, to submit shards that are still missing: stochc shard submit {folder}\n",
            jobs.join(","),
            jobs.join(" "),
        );
        if self.ensemble.has_logs() {
            text += &format!("Logs of failed jobs: {folder}/slurm/\n");
        }
        self.options.print(&text)
    }

    /// Returns the failure for a Slurm command that gave no answer.
    fn unanswered(&self, error: &SlurmError) -> Failure {
        let folder = &self.folder;
        several_lines(&format!(
            "{error}\nRun `stochc shard submit {folder}` where Slurm's commands work; jobs that were submitted are not affected.\n\
             `stochc shard status {folder}` shows how to run the shards without Slurm."
        ))
    }

    /// Returns the failure for a job that was not submitted.
    fn refused(&self, what: &str, refusal: &Refusal) -> Failure {
        let folder = &self.folder;
        let answer = match &refusal.error {
            Some(error) => error.to_string(),
            None => "`sbatch` printed no job number".to_owned(),
        };
        if refusal.may_be_accepted {
            let grace = words(self.options.grace);
            return several_lines(&format!(
                "{answer}\nSlurm may have accepted {what}, but did not list it within {grace} (`--grace`).\n\
                 `stochc shard submit {folder}` looks for it again."
            ));
        }
        let is_limit = refusal.error.as_ref().is_some_and(SlurmError::is_limit);
        let help = if is_limit {
            "Submit fewer tasks with more shards each: `--per-task N`."
        } else {
            "Check `--partition`, `--time` and `--sbatch`; `--dry-run` prints the scripts and commands."
        };
        several_lines(&format!("Slurm refused {what}: {answer}\n{help}"))
    }
}

/// Refused submission: `sbatch` printed no job number.
struct Refusal {
    may_be_accepted: bool,
    /// Error of `sbatch`. `None` if `sbatch` succeeded.
    pub(super) error: Option<SlurmError>,
}

fn several_lines(message: &str) -> Failure {
    Failure {
        exit: Exit::Usage,
        message: format!("error: {}\n", visible_lines(message)),
    }
}

/// Calls `look` repeatedly until `is_final` accepts the result or `time` has passed. Returns the
/// last result.
fn poll<T, E>(
    time: Duration,
    look: impl Fn() -> Result<T, E>,
    is_final: impl Fn(&T) -> bool,
) -> Result<T, E> {
    const SHORTEST_PAUSE: Duration = Duration::from_secs(1);
    let start = now();
    loop {
        let looked = now();
        let value = look()?;
        let left = time.saturating_sub(start.elapsed());
        if is_final(&value) || left.is_zero() {
            return Ok(value);
        }
        // Pause so that calls of `look` take at most a tenth of the time.
        let pause = SHORTEST_PAUSE.max(9 * looked.elapsed());
        std::thread::sleep(pause.min(left));
    }
}
