//! What Slurm says of the jobs of an ensemble.
use std::collections::BTreeSet;

/// What `squeue` is to print of a job, for [`Queue::read`]: job, tasks, name, state, reason.
pub const FORMAT: &str = "%F|%K|%j|%T|%r";

/// The jobs of an ensemble that Slurm knows of, those that have ended a while ago not among them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Queue {
    /// Tasks that make pieces.
    pub pieces: Vec<SlurmJob>,
    /// Jobs that put them together.
    pub merges: Vec<SlurmJob>,
}

/// A job, or tasks of a job array that are in the same state.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SlurmJob {
    /// Its number; of a task, that of its array.
    pub number: u64,
    /// Of an array, the tasks, as `3` or `5-9,12`.
    pub tasks: String,
    /// In Slurm's word, such as `RUNNING`.
    pub state: String,
    /// Why it waits, or has ended, in Slurm's word.
    pub reason: String,
}

impl Queue {
    /// Reads what `squeue --noheader --format=`[`FORMAT`] has printed of jobs named `name`, and those that put together.
    pub fn read(printed: &str, name: &str) -> Queue {
        let mut queue = Queue::default();
        for line in printed.lines() {
            let mut fields = line.trim().splitn(5, '|');
            let mut next = || fields.next().unwrap_or_default();
            let [number, tasks, of, state, reason] = [next(), next(), next(), next(), next()];
            let Ok(number) = number.parse() else { continue };
            let job = SlurmJob {
                number,
                // A site may say how many of them run at the same time.
                tasks: tasks.split('%').next().unwrap_or_default().to_owned(),
                state: state.to_owned(),
                reason: reason.to_owned(),
            };
            match of.strip_prefix(name) {
                Some("") => queue.pieces.push(job),
                Some(MERGE) => queue.merges.push(job),
                _ => {}
            }
        }
        queue
    }

    /// The numbers of jobs that have not ended.
    pub fn active(&self) -> Vec<u64> {
        active(self.jobs())
    }

    /// All jobs.
    pub fn jobs(&self) -> impl Iterator<Item = &SlurmJob> {
        self.pieces.iter().chain(&self.merges)
    }

    /// How many tasks run and how many wait, and what becomes of the pieces after them, in a few words.
    pub fn summary(&self) -> String {
        let active = self.pieces.iter().filter(|job| job.is_active());
        let (wait, run): (Vec<&SlurmJob>, Vec<&SlurmJob>) =
            active.partition(|job| job.is_pending());
        let count = |jobs: &[&SlurmJob]| jobs.iter().map(|job| job.count()).sum::<u64>();
        let mut told = Vec::new();
        match count(&run) {
            0 => {}
            1 => told.push("1 task runs".to_owned()),
            run => told.push(format!("{run} tasks run")),
        }
        if let Some(first) = wait.first() {
            told.push(format!("{} wait ({})", count(&wait), first.reason));
        }
        if let (true, Some(merge)) = (
            told.is_empty(),
            self.merges.iter().find(|job| job.is_active()),
        ) {
            told.push(match merge.is_pending() {
                true => format!("the merge waits ({})", merge.reason),
                false => "they are put together".to_owned(),
            });
        }
        told.join(", ")
    }
}

/// The numbers of those jobs that have not ended, each once.
pub(super) fn active<'a>(jobs: impl IntoIterator<Item = &'a SlurmJob>) -> Vec<u64> {
    let active = jobs.into_iter().filter(|job| job.is_active());
    let numbers: BTreeSet<u64> = active.map(|job| job.number).collect();
    numbers.into_iter().collect()
}

/// How the name of a job that puts pieces together ends.
pub(super) const MERGE: &str = "-merge";

impl SlurmJob {
    /// Whether it has not ended.
    pub fn is_active(&self) -> bool {
        /// States in which nothing more comes of a job.
        const ENDED: [&str; 10] = [
            "BOOT_FAIL",
            "CANCELLED",
            "COMPLETED",
            "DEADLINE",
            "FAILED",
            "NODE_FAIL",
            "OUT_OF_MEMORY",
            "PREEMPTED",
            "REVOKED",
            "TIMEOUT",
        ];
        !ENDED.contains(&&*self.state)
    }

    /// Whether it has not begun.
    pub(crate) fn is_pending(&self) -> bool {
        self.state == "PENDING"
    }

    /// Whether somebody has ended it.
    pub fn is_cancelled(&self) -> bool {
        self.state == "CANCELLED"
    }

    /// Whether it is, or holds, a task.
    pub fn has_task(&self, task: u64) -> bool {
        self.stretches()
            .any(|(first, last)| (first..=last).contains(&task))
    }

    /// How many tasks it is.
    fn count(&self) -> u64 {
        let tasks = self
            .stretches()
            .map(|(first, last)| last.saturating_sub(first) + 1);
        tasks.sum::<u64>().max(1)
    }

    fn stretches(&self) -> impl Iterator<Item = (u64, u64)> {
        self.tasks.split(',').filter_map(|part| {
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            Some((first.parse().ok()?, last.parse().ok()?))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As Slurm 22.05 prints it.
    const PRINTED: &str = "\
12|2-4,7%2|stochc-a|PENDING|Resources
12|1|stochc-a|RUNNING|None
12|0|stochc-a|COMPLETED|None
13|N/A|stochc-a-merge|PENDING|Dependency
14|N/A|stochc-ab|RUNNING|None
slurm_load_jobs error: Invalid job id specified
";

    #[test]
    fn only_jobs_of_the_folder_count() {
        let queue = Queue::read(PRINTED, "stochc-a");
        assert_eq!((queue.pieces.len(), queue.merges.len()), (3, 1));
        assert_eq!(queue.summary(), "1 task runs, 4 wait (Resources)");
        let [waiting, running, ended] = &queue.pieces[..] else {
            panic!()
        };
        assert!(waiting.is_pending() && waiting.is_active());
        assert!(waiting.has_task(7) && waiting.has_task(3) && !waiting.has_task(5));
        assert!(running.is_active() && !ended.is_active());
        let last = "13|N/A|stochc-a-merge|RUNNING|None";
        assert_eq!(
            Queue::read(last, "stochc-a").summary(),
            "they are put together"
        );
        assert_eq!(Queue::read("", "stochc-a"), Queue::default());
    }
}
