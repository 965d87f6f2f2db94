//! Jobs of an ensemble in the list that Slurm prints.
use std::collections::BTreeSet;

/// Output format of `squeue` that [`Queue::read`] expects: job, tasks, name, state, reason.
pub const FORMAT: &str = "%F|%K|%j|%T|%r";

/// Jobs of an ensemble that Slurm lists. Jobs that ended recently are included.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Queue {
    /// Tasks that run shards.
    pub shards: Vec<SlurmJob>,
    /// Merge jobs.
    pub merges: Vec<SlurmJob>,
}

/// Job, or tasks of a job array that are in the same state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SlurmJob {
    /// Job number. For tasks, the number of their job array.
    pub number: u64,
    /// Task numbers, such as `3` or `5-9,12`.
    tasks: String,
    /// State as Slurm prints it, such as `RUNNING`.
    state: String,
    /// Reason why the job waits, as Slurm prints it.
    reason: String,
}

impl Queue {
    /// Reads the output of `squeue --noheader --format=`[`FORMAT`]. `name` is the name of the
    /// ensemble's job arrays.
    pub fn read(output: &str, name: &str) -> Queue {
        let mut queue = Queue::default();
        for line in output.lines() {
            let mut fields = line.trim().splitn(5, '|');
            let mut next = || fields.next().unwrap_or_default();
            let [number, tasks, job_name, state, reason] = [next(), next(), next(), next(), next()];
            let Ok(number) = number.parse() else { continue };
            let job = SlurmJob {
                number,
                // The part after `%` is the largest number of tasks at the same time.
                tasks: tasks.split('%').next().unwrap_or_default().to_owned(),
                state: state.to_owned(),
                reason: reason.to_owned(),
            };
            match job_name.strip_prefix(name) {
                Some("") => queue.shards.push(job),
                Some(MERGE) => queue.merges.push(job),
                _ => {}
            }
        }
        queue
    }

    /// Returns the numbers of active job arrays.
    pub fn active_arrays(&self) -> Vec<u64> {
        active(&self.shards)
    }

    /// Returns the numbers of active merge jobs.
    pub fn active_merges(&self) -> Vec<u64> {
        active(&self.merges)
    }

    /// Returns the numbers of all listed jobs, including ended ones.
    pub fn numbers(&self) -> BTreeSet<u64> {
        let jobs = self.shards.iter().chain(&self.merges);
        jobs.map(|job| job.number).collect()
    }

    /// Returns a description of the running and waiting tasks. If there are none, describes the
    /// merge job.
    pub fn summary(&self) -> String {
        let active = self.shards.iter().filter(|job| job.is_active());
        let (waiting, running): (Vec<&SlurmJob>, Vec<&SlurmJob>) =
            active.partition(|job| job.is_pending());
        let mut parts = Vec::new();
        if !running.is_empty() {
            parts.push(format!("running tasks: {}", count(&running)));
        }
        if let Some(first) = waiting.first() {
            let (count, reason) = (count(&waiting), &first.reason);
            parts.push(format!("waiting tasks: {count} ({reason})"));
        }
        let merge = self.merges.iter().find(|job| job.is_active());
        if let (true, Some(merge)) = (parts.is_empty(), merge) {
            parts.push(if merge.is_pending() {
                format!("the merge job waits ({})", merge.reason)
            } else {
                "the merge job runs".to_owned()
            });
        }
        parts.join(", ")
    }
}

/// Returns the job numbers of the jobs that have not ended, ascending and unique.
fn active(jobs: &[SlurmJob]) -> Vec<u64> {
    let active = jobs.iter().filter(|job| job.is_active());
    let numbers: BTreeSet<u64> = active.map(|job| job.number).collect();
    numbers.into_iter().collect()
}

fn count(jobs: &[&SlurmJob]) -> u64 {
    jobs.iter().map(|job| job.count()).sum()
}

/// Suffix of the names of merge jobs.
pub(super) const MERGE: &str = "-merge";

impl SlurmJob {
    fn is_active(&self) -> bool {
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

    /// Returns whether the job has not started.
    fn is_pending(&self) -> bool {
        self.state == "PENDING"
    }

    /// Returns the number of tasks of the job.
    fn count(&self) -> u64 {
        let tasks = self.tasks.split(',').filter_map(|part| {
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            let (first, last): (u64, u64) = (first.parse().ok()?, last.parse().ok()?);
            Some(last.saturating_sub(first) + 1)
        });
        tasks.sum::<u64>().max(1)
    }
}

/// Returns the job number in the output of `sbatch --parsable`: the last line that is a number. A
/// cluster may print other lines before it. The cluster's name may follow the number.
pub fn job_number(output: &str) -> Option<u64> {
    let number = |line: &str| line.trim().split(';').next()?.parse().ok();
    output.lines().rev().find_map(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Output of `squeue` as printed by Slurm 22.05.
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
        assert_eq!((queue.shards.len(), queue.merges.len()), (3, 1));
        assert_eq!(
            queue.summary(),
            "running tasks: 1, waiting tasks: 4 (Resources)"
        );
        assert_eq!(
            (queue.active_arrays(), queue.active_merges()),
            (vec![12], vec![13])
        );
        let last = "12|0|stochc-a|FAILED|NonZeroExitCode\n13|N/A|stochc-a-merge|RUNNING|None";
        let last = Queue::read(last, "stochc-a");
        assert_eq!(last.summary(), "the merge job runs");
        assert!(last.active_arrays().is_empty());
        assert_eq!(last.numbers(), BTreeSet::from([12, 13]));
        assert_eq!(Queue::read("", "stochc-a"), Queue::default());
    }

    #[test]
    fn the_job_number_may_follow_other_lines() {
        assert_eq!(job_number("4711\n"), Some(4711));
        assert_eq!(
            job_number("--> checking 3 quotas ... OK\n12\n4711;east\n"),
            Some(4711)
        );
        assert_eq!(job_number("4711\nThank you.\n"), Some(4711));
        assert_eq!(job_number("Submitted.\n"), None);
    }
}
