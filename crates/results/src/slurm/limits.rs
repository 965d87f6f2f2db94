//! Limits of a cluster on the number of jobs.

/// Limits of a cluster on the number of jobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlurmLimits {
    /// Upper limit on task numbers of a job array, exclusive (`MaxArraySize`).
    pub array_size: u64,
    /// Largest number of tasks of a job array (`max_array_tasks` in `SchedulerParameters`). `None`
    /// if only `array_size` limits them.
    pub array_tasks: Option<u64>,
    /// Largest number of jobs of all users at the same time (`MaxJobCount`).
    pub jobs: u64,
    /// Largest number of jobs of this user at the same time (`MaxSubmitJobs`). `None` if there is
    /// no limit.
    pub submitted: Option<u64>,
}

impl Default for SlurmLimits {
    /// Returns Slurm's default limits.
    fn default() -> SlurmLimits {
        SlurmLimits {
            array_size: 1001,
            array_tasks: None,
            jobs: 10_000,
            submitted: None,
        }
    }
}

impl SlurmLimits {
    /// Reads the limits from the output of `scontrol show config`.
    pub fn from_config(config: &str) -> SlurmLimits {
        let default = SlurmLimits::default();
        let number = |name: &str| value(config.lines(), name)?.parse().ok();
        let scheduler = value(config.lines(), "SchedulerParameters").unwrap_or_default();
        let array_tasks = value(scheduler.split(','), "max_array_tasks");
        SlurmLimits {
            array_size: number("MaxArraySize").unwrap_or(default.array_size),
            array_tasks: array_tasks.and_then(|tasks| tasks.parse().ok()),
            jobs: number("MaxJobCount").unwrap_or(default.jobs),
            submitted: None,
        }
    }

    /// Adds the limit on the user's jobs. `output` is the output of `sacctmgr --noheader
    /// --parsable2 show associations format=MaxSubmitJobs`. The output has a line for each account
    /// of the user. A line is empty if the account has no limit.
    pub fn with_associations(self, output: &str) -> SlurmLimits {
        // The account of the jobs is unknown, so take the smallest limit.
        let limits = output.lines().filter_map(|line| line.trim().parse().ok());
        let submitted = limits.min().or(self.submitted);
        SlurmLimits { submitted, ..self }
    }

    /// Returns the largest number of tasks of a job array. One job is reserved for merging. Returns
    /// `None` if the cluster has no job arrays.
    fn tasks(&self) -> Option<u64> {
        let without_merge = |jobs: u64| jobs.saturating_sub(1).max(1);
        let limits = [
            Some(self.array_size),
            self.array_tasks,
            Some(without_merge(self.jobs)),
            self.submitted.map(without_merge),
        ];
        limits
            .into_iter()
            .flatten()
            .min()
            .filter(|tasks| *tasks > 0)
    }

    /// Returns the number of shards per task: `requested`, or more if the cluster allows fewer tasks.
    /// Returns `None` if the cluster has no job arrays.
    pub fn per_task(&self, shards: u64, requested: u64) -> Option<u64> {
        Some(shards.div_ceil(self.tasks()?).max(requested))
    }
}

/// Returns the value of the first part that has the form `name = value`.
fn value<'a>(parts: impl IntoIterator<Item = &'a str>, name: &str) -> Option<&'a str> {
    let mut pairs = parts.into_iter().filter_map(|part| part.split_once('='));
    let (_, value) = pairs.find(|(it, _)| it.trim() == name)?;
    Some(value.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIG: &str = "Configuration data as of 2026-11-23T00:03:32\n\
        MaxArraySize            = 501\nMaxDBDMsgs              = 0\nMaxJobCount             = 10000\n";

    #[test]
    fn more_shards_than_tasks_share_tasks() {
        let limits = SlurmLimits::from_config(CONFIG);
        assert_eq!((limits.array_size, limits.jobs), (501, 10_000));
        assert_eq!(limits.per_task(501, 1), Some(1));
        assert_eq!(limits.per_task(502, 1), Some(2));
        assert_eq!(limits.per_task(502, 7), Some(7));
        assert_eq!(limits.per_task(100_000, 1), Some(200));
        let limited = limits.with_associations("\n100\n300\n");
        assert_eq!(limited.per_task(99, 1), Some(1));
        assert_eq!(limited.per_task(100, 1), Some(2));
        assert_eq!(limits.with_associations("\n").submitted, None);
    }

    #[test]
    fn the_scheduler_may_allow_fewer_tasks() {
        let parameters =
            "SchedulerParameters     = sched_interval=1,max_array_tasks=40,bf_window=1\n";
        let limits = SlurmLimits::from_config(&format!("{CONFIG}{parameters}"));
        assert_eq!(limits.per_task(40, 1), Some(1));
        assert_eq!(limits.per_task(41, 1), Some(2));
        let limits = SlurmLimits::from_config("SchedulerParameters     = (null)\n");
        assert_eq!(limits, SlurmLimits::default());
    }

    #[test]
    fn a_site_may_have_no_arrays() {
        let limits = SlurmLimits::from_config("MaxArraySize = 0\n");
        assert_eq!(limits.per_task(1, 1), None);
        assert_eq!(SlurmLimits::from_config("nothing"), SlurmLimits::default());
    }
}
