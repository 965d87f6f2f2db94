//! Following the jobs of an ensemble until its pieces are put together.
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use stochc_ensemble::clock::now;
use stochc_ensemble::shards::count_pieces;
use stochc_ensemble::slurm::{
    JobArray, Queue, SlurmJob, Stop, Submission, Workflow, WorkflowStep, last_lines,
};
use stochc_ensemble::text::{ranges, visible, words};
use stochc_files::shell::file as shell_file;
use stochc_ir::visible_lines;

use super::SubmittedJobs;
use super::slurm::{self, Unanswered};
use crate::command::host::Terminal;
use crate::command::merge::is_whole;
use crate::command::terminal::{print, warn};
use crate::exit::{Exit, Failure};
use crate::host::during;
use crate::progress::WorkProgress;

/// Who follows.
struct Follower<'a> {
    jobs: &'a SubmittedJobs<'a>,
    stop: &'static AtomicBool,
    workflow: Workflow,
    /// What Slurm said last.
    queue: Queue,
    /// Whether Slurm has answered, and there is a folder for what is submitted.
    is_prepared: bool,
    /// Tasks that have ended; Slurm forgets them after a while.
    ended: BTreeSet<SlurmJob>,
    /// What is shown.
    state: &'a Mutex<WorkProgress>,
}

/// How it goes on.
enum Next {
    Wait,
    Done,
    Stop(Stop),
}

/// Why it does not.
enum Trouble {
    /// In Slurm's words; it may go on in a while.
    Silent(String),
    Failure(Failure),
}

impl From<Failure> for Trouble {
    fn from(failure: Failure) -> Trouble {
        Trouble::Failure(failure)
    }
}

/// Submits what is missing, and follows it; what there is to say at the end is said.
pub fn follow(jobs: &SubmittedJobs, stop: &'static AtomicBool) -> Result<Exit, Failure> {
    // Before anything is submitted that could not be kept there.
    jobs.ensemble.submissions().map_err(Failure::usage)?;
    let state = Mutex::new(WorkProgress::default());
    let mut follower = Follower {
        jobs,
        stop,
        workflow: Workflow::new(jobs.options.attempts),
        queue: Queue::default(),
        is_prepared: false,
        ended: BTreeSet::new(),
        state: &state,
    };
    follower.show("");
    let terminal = Terminal::new(jobs.options.quiet);
    let shown = |_| {
        state
            .lock()
            .expect("nobody panics while it is held")
            .clone()
    };
    let end = during(&terminal, shown, || follower.until_the_end())?;
    match end {
        None => follower.interrupted(),
        Some(Next::Stop(reason)) => Err(follower.failed(&reason)),
        Some(_) => {
            // Whoever has looked at it meanwhile may have left a lock.
            jobs.ensemble.clear().map_err(Failure::usage)?;
            if !jobs.options.quiet {
                print(&is_whole(&jobs.options.folder, jobs.ensemble.runs))?;
            }
            Ok(Exit::Success)
        }
    }
}

impl Follower<'_> {
    /// Goes step by step; `None`: interrupted.
    fn until_the_end(&mut self) -> Result<Option<Next>, Failure> {
        let start = now();
        let mut answered = start;
        loop {
            if self.stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            match self.step() {
                Ok(Next::Wait) => {
                    answered = now();
                    self.show("");
                }
                Ok(next) => {
                    if let Next::Done = next {
                        self.shown(self.jobs.ensemble.pieces, "");
                    }
                    return Ok(Some(next));
                }
                Err(Trouble::Failure(failure)) => return Err(failure),
                Err(Trouble::Silent(said)) => {
                    let silent = answered.elapsed();
                    if silent >= self.jobs.options.controller_timeout {
                        return Err(self.refused(&format!(
                            "Slurm has not answered for {}: {said}",
                            words(silent)
                        )));
                    }
                    self.show(&format!(
                        "no answer from Slurm for {}: {said}",
                        words(silent)
                    ));
                }
            }
            self.pause(start.elapsed());
        }
    }

    /// Looks, and submits what there is to submit.
    fn step(&mut self) -> Result<Next, Trouble> {
        let ensemble = self.jobs.ensemble;
        if !self.is_prepared {
            slurm::queue(ensemble).map_err(|it| self.unanswered(it))?;
            ensemble.prepare().map_err(Failure::usage)?;
            self.is_prepared = true;
        }
        let Some(_submitting) = ensemble.submitting().map_err(Failure::usage)? else {
            return Ok(Next::Wait);
        };
        self.queue = slurm::queue(ensemble).map_err(|it| self.unanswered(it))?;
        for job in self.queue.pieces.iter().filter(|job| !job.is_active()) {
            self.ended.insert(job.clone());
        }
        let step = self
            .workflow
            .next(&self.queue, |is_thorough| ensemble.look(is_thorough));
        let step = step.map_err(Failure::usage)?;
        // Whoever has asked to stop meanwhile wants nothing more submitted.
        if self.stop.load(Ordering::Relaxed) {
            return Ok(Next::Wait);
        }
        match step {
            WorkflowStep::Wait => {}
            WorkflowStep::Done => return Ok(Next::Done),
            WorkflowStep::Stop(reason) => return Ok(Next::Stop(reason)),
            WorkflowStep::Pieces { missing, cancel } => {
                slurm::cancel(&cancel).map_err(|it| self.unanswered(it))?;
                self.submit(Some(&missing), &[])?;
            }
            WorkflowStep::Merge { after } => self.submit(None, &after)?,
        }
        Ok(Next::Wait)
    }

    /// Submits an array of pieces, if any are missing, and the job that puts all of them together.
    fn submit(&mut self, missing: Option<&[u64]>, after: &[u64]) -> Result<(), Trouble> {
        let (jobs, ensemble) = (self.jobs, self.jobs.ensemble);
        let limits = slurm::limits().map_err(|it| self.unanswered(it))?;
        let per_task = jobs.per_task(limits)?;
        ensemble.prepare().map_err(Failure::usage)?;
        let [pieces, merge] = jobs.scripts(per_task);
        let scripts = ensemble
            .write_scripts(&pieces, &merge)
            .map_err(Failure::usage)?;
        let [pieces, merge] = scripts.map(|it| it.to_string_lossy().into_owned());
        let mut submission = Submission {
            array: after.last().copied(),
            per_task,
            merge: None,
        };
        let mut after = after.to_vec();
        if let Some(missing) = missing {
            let arguments = jobs.array(&JobArray::of(missing, per_task), &pieces);
            let array = slurm::submit(&arguments).map_err(|it| self.unanswered(it))?;
            self.workflow.submitted(Some(array), None);
            submission.array = Some(array);
            self.keep(submission)?;
            after = vec![array];
        }
        let after: Vec<String> = after.iter().map(u64::to_string).collect();
        let arguments = jobs.merge(&after, &merge);
        let merge = slurm::submit(&arguments).map_err(|it| self.unanswered(it))?;
        self.workflow.submitted(None, Some(merge));
        submission.merge = Some(merge);
        Ok(self.keep(submission)?)
    }

    /// Keeps what was submitted.
    fn keep(&self, submission: Submission) -> Result<(), Failure> {
        let kept = self.jobs.ensemble.submitted(submission);
        kept.map_err(|error| self.refused(&error.to_string()))
    }

    /// Shows how far it is, and what else there is to say.
    fn show(&self, more: &str) {
        let there = count_pieces(&self.jobs.ensemble.path).unwrap_or_default();
        self.shown(there.min(self.jobs.ensemble.pieces), more);
    }

    fn shown(&self, there: u64, more: &str) {
        let all = self.jobs.ensemble.pieces;
        let mut told = vec![self.queue.summary(), more.to_owned()];
        if self.workflow.attempts() > 1 {
            let (attempt, of) = (self.workflow.attempts(), self.jobs.options.attempts);
            told.insert(0, format!("attempt {attempt} of {of}"));
        }
        let told = told.iter().filter(|it| !it.is_empty());
        let mut state = self.state.lock().expect("nobody panics while it is held");
        *state = WorkProgress {
            share: there as f64 / all as f64,
            done: format!("{there} of {all} pieces"),
            more: told.map(|it| format!("; {it}")).collect(),
        };
    }

    /// Waits a tenth of the time that has passed, so that the controller is asked rarely; an interrupt ends it.
    fn pause(&self, elapsed: Duration) {
        const SHORTEST: Duration = Duration::from_secs(1);
        const LONGEST: Duration = Duration::from_secs(30);
        const LOOK: Duration = Duration::from_millis(100);
        let end = now() + (elapsed / 10).clamp(SHORTEST, LONGEST);
        while now() < end && !self.stop.load(Ordering::Relaxed) {
            std::thread::sleep(LOOK);
        }
    }

    /// What is done at an interrupt.
    fn interrupted(&self) -> Result<Exit, Failure> {
        let known = self.workflow.jobs();
        let queue = slurm::queue(self.jobs.ensemble);
        let jobs = match &queue {
            Ok(queue) => queue.active(),
            Err(_) => known,
        };
        let folder = self.folder();
        if jobs.is_empty() {
            warn("stopped; no job is queued\n");
            return Ok(Exit::Interrupted);
        }
        let list: Vec<String> = jobs.iter().map(u64::to_string).collect();
        let list = list.join(" ");
        let cancelled = self
            .jobs
            .options
            .cancel_on_interrupt
            .then(|| slurm::cancel(&jobs));
        warn(&match cancelled {
            None => format!(
                "the cluster goes on; `stochc submit {folder}` follows it again, and `scancel {list}` cancels it\n"
            ),
            Some(Ok(())) => format!(
                "jobs {list} are cancelled; what is finished is kept, and `stochc submit {folder}` goes on\n"
            ),
            Some(Err(trouble)) => format!(
                "{}; cancel them by yourself: scancel {list}\n",
                match trouble {
                    Unanswered::NotInstalled(program) => format!("`{program}` is not installed"),
                    Unanswered::Refused(said) | Unanswered::Silent(said) => said,
                }
            ),
        });
        Ok(Exit::Interrupted)
    }

    /// What it means that Slurm has not answered as it should.
    fn unanswered(&self, unanswered: Unanswered) -> Trouble {
        let folder = self.folder();
        Trouble::Failure(match unanswered {
            Unanswered::Silent(said) => return Trouble::Silent(said),
            Unanswered::Refused(said) if slurm::is_set_up_wrong(&said) => self.refused(&format!(
                "Slurm's commands do not work here: {said}\nsubmit where they do; here, `stochc status {folder}` says how to make the pieces without them"
            )),
            Unanswered::Refused(said) => self.refused(&format!(
                "Slurm refuses: {said}\nlook at `--partition`, `--time` and `--sbatch`; `stochc submit {folder} --dry-run` shows what is submitted"
            )),
            Unanswered::NotInstalled(program) => Failure::usage(format!(
                "`{program}` is not installed: jobs are submitted where Slurm's commands are; here, `stochc status {folder}` says how to make the pieces without it"
            )),
        })
    }

    /// An end before the jobs' own, in several lines.
    fn refused(&self, reason: &str) -> Failure {
        let mut message = format!("error: {}\n", visible_lines(reason));
        if !self.workflow.jobs().is_empty() {
            message += &format!(
                "jobs that are queued go on; `stochc submit {}` follows them again\n",
                self.folder()
            );
        }
        Failure {
            exit: Exit::Usage,
            message,
        }
    }

    /// Why pieces are missing, or are not put together, after all attempts.
    fn failed(&self, reason: &Stop) -> Failure {
        let (all, folder) = (self.jobs.ensemble.pieces, self.folder());
        let shown = visible(&self.jobs.options.folder.to_string_lossy());
        let attempts = match self.workflow.attempts() {
            1 => "1 attempt".to_owned(),
            attempts => format!("{attempts} attempts"),
        };
        let missing = |pieces: &[u64]| {
            format!(
                "{} of {all} pieces are missing ({})",
                pieces.len(),
                ranges(pieces, ", ")
            )
        };
        let (what, way_out) = match reason {
            Stop::Missing(pieces) => (
                format!(
                    "{} after {attempts}\n{}",
                    missing(pieces),
                    self.said(pieces)
                ),
                format!(
                    "`stochc shard {folder} {}` makes one here, and `stochc submit {folder}` tries again",
                    pieces[0]
                ),
            ),
            Stop::Cancelled(pieces) => {
                let what = match pieces.is_empty() {
                    true => "they are not put together".to_owned(),
                    false => missing(pieces),
                };
                (
                    format!("somebody has cancelled jobs: {what}\n"),
                    format!("`stochc submit {folder}` goes on"),
                )
            }
            Stop::Unmerged => (
                format!(
                    "all pieces are there, but not put together\n{}",
                    self.said_of_merge()
                ),
                format!("`stochc merge {folder}` does it here"),
            ),
        };
        Failure {
            exit: Exit::UnsuccessfulRun,
            message: visible_lines(&format!("error: `{shown}`: {what}{way_out}\n")),
        }
    }

    /// How tasks of the last array have ended that should have made pieces, and their last lines.
    fn said(&self, pieces: &[u64]) -> String {
        /// Tasks whose end is shown.
        const SHOWN: usize = 3;
        let ensemble = self.jobs.ensemble;
        let submissions = ensemble.submissions().unwrap_or_default();
        let last = submissions
            .iter()
            .rev()
            .find_map(|it| Some((it.array?, it.per_task)));
        let Some((array, per_task)) = last else {
            return String::new();
        };
        let tasks = JobArray::of(pieces, per_task).tasks;
        let mut text = String::new();
        for &task in tasks.iter().take(SHOWN) {
            let made = JobArray::pieces(task, per_task, ensemble.pieces);
            let made: Vec<u64> = pieces
                .iter()
                .copied()
                .filter(|it| made.contains(it))
                .collect();
            let ended = self
                .ended
                .iter()
                .find(|job| job.number == array && job.has_task(task));
            let state = ended.map_or("ended a while ago", |job| &job.state);
            let made = ranges(&made, ", ");
            let log = lines(&ensemble.task_log(array, task));
            let _ = writeln!(text, "job {array}_{task} (piece {made}; {state}){log}");
        }
        text
    }

    /// What the last job that was to put the pieces together has said.
    fn said_of_merge(&self) -> String {
        let ensemble = self.jobs.ensemble;
        let submissions = ensemble.submissions().unwrap_or_default();
        let Some(merge) = submissions.iter().rev().find_map(|it| it.merge) else {
            return String::new();
        };
        format!("job {merge}{}\n", lines(&ensemble.merge_log(merge)))
    }

    /// The folder, as an argument.
    fn folder(&self) -> String {
        shell_file(&visible(&self.jobs.options.folder.to_string_lossy()))
    }
}

/// The last lines of a log, after whose it is.
fn lines(log: &Path) -> String {
    let lines = last_lines(log);
    match lines.is_empty() {
        true => " has left no word; does its node see the folder under this name?".to_owned(),
        false => lines
            .iter()
            .fold(" said:".to_owned(), |text, line| text + "\n    " + line),
    }
}
