//! How many jobs a site allows.

/// How many jobs a site allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlurmLimits {
    /// Tasks of a job array (`MaxArraySize`).
    pub array: u64,
    /// Jobs of all users at the same time (`MaxJobCount`).
    pub jobs: u64,
    /// Jobs of this user at the same time (`MaxSubmitJobs`), if there is a limit.
    pub submitted: Option<u64>,
}

impl Default for SlurmLimits {
    /// Those of Slurm where a site says nothing.
    fn default() -> SlurmLimits {
        SlurmLimits {
            array: 1001,
            jobs: 10_000,
            submitted: None,
        }
    }
}

impl SlurmLimits {
    /// Reads what `scontrol show config` has said.
    pub fn of_config(config: &str) -> SlurmLimits {
        let default = SlurmLimits::default();
        let number = |name: &str| {
            let mut lines = config.lines().filter_map(|line| line.split_once('='));
            let value = lines.find(|(it, _)| it.trim() == name)?.1;
            value.trim().parse().ok()
        };
        SlurmLimits {
            array: number("MaxArraySize").unwrap_or(default.array),
            jobs: number("MaxJobCount").unwrap_or(default.jobs),
            ..default
        }
    }

    /// Also heeds what `sacctmgr --noheader --parsable2 show associations format=MaxSubmitJobs` has said: a line for each
    /// account of the user, empty where there is no limit.
    pub fn and_associations(self, said: &str) -> SlurmLimits {
        // Which of them the jobs will belong to is not known.
        let least = said
            .lines()
            .filter_map(|line| line.trim().parse().ok())
            .min();
        let submitted = least.or(self.submitted);
        SlurmLimits { submitted, ..self }
    }

    /// Tasks that an array may have beside the job that waits for it; `None`: there are no arrays.
    fn tasks(&self) -> Option<u64> {
        let beside = |jobs: u64| jobs.saturating_sub(1).max(1);
        let submitted = self.submitted.map_or(u64::MAX, beside);
        let tasks = self.array.min(beside(self.jobs)).min(submitted);
        (tasks > 0).then_some(tasks)
    }

    /// How many of so many pieces a task has to make, and no fewer than are asked for; `None`: there are no arrays.
    pub fn per_task(&self, pieces: u64, asked: u64) -> Option<u64> {
        Some(pieces.div_ceil(self.tasks()?).max(asked))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIG: &str = "Configuration data as of 2026-11-23T00:03:32\n\
        MaxArraySize            = 501\nMaxDBDMsgs              = 0\nMaxJobCount             = 10000\n";

    #[test]
    fn more_pieces_than_tasks_go_several_to_a_task() {
        let limits = SlurmLimits::of_config(CONFIG);
        assert_eq!((limits.array, limits.jobs), (501, 10_000));
        assert_eq!(limits.per_task(501, 1), Some(1));
        assert_eq!(limits.per_task(502, 1), Some(2));
        assert_eq!(limits.per_task(502, 7), Some(7));
        assert_eq!(limits.per_task(100_000, 1), Some(200));
        let limited = limits.and_associations("\n100\n300\n");
        assert_eq!(limited.per_task(99, 1), Some(1));
        assert_eq!(limited.per_task(100, 1), Some(2));
        assert_eq!(limits.and_associations("\n").submitted, None);
    }

    #[test]
    fn a_site_may_have_no_arrays() {
        assert_eq!(
            SlurmLimits::of_config("MaxArraySize = 0\n").per_task(1, 1),
            None
        );
        assert_eq!(SlurmLimits::of_config("nothing"), SlurmLimits::default());
    }
}
