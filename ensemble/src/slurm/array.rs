//! Which pieces a task of a job array makes.
use std::ops::Range;

use crate::text::ranges;

/// A job array: task i makes the pieces from i times `per_task`, as many as there are.
///
/// So a task is the same in every array of an ensemble, whatever is missing; pieces that are there cost it a look.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobArray {
    /// Pieces of a task.
    pub per_task: u64,
    /// The numbers of its tasks, in their order.
    pub tasks: Vec<u64>,
}

impl JobArray {
    /// The tasks that make pieces which are missing, given in their order.
    pub fn of(missing: &[u64], per_task: u64) -> JobArray {
        let mut tasks: Vec<u64> = missing.iter().map(|piece| piece / per_task).collect();
        tasks.dedup();
        JobArray { per_task, tasks }
    }

    /// The pieces of a task, of so many in all.
    pub fn pieces(task: u64, per_task: u64, all: u64) -> Range<u64> {
        let begin = |task: u64| task.saturating_mul(per_task).min(all);
        begin(task)..begin(task.saturating_add(1))
    }

    /// The numbers as `sbatch --array` takes them.
    pub fn indices(&self) -> String {
        /// Bytes of an argument that every system takes.
        const MOST: usize = 100_000;
        let indices = ranges(&self.tasks, ",");
        match (&self.tasks[..], indices.len() > MOST) {
            // Tasks in between have nothing to do.
            ([first, .., last], true) => format!("{first}-{last}"),
            _ => indices,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn every_missing_piece_has_one_task(
            missing in proptest::collection::btree_set(0u64..60, 0..40),
            per_task in 1u64..9,
        ) {
            let missing: Vec<u64> = missing.into_iter().collect();
            let array = JobArray::of(&missing, per_task);
            for piece in &missing {
                let makes = |task: &&u64| JobArray::pieces(**task, per_task, 60).contains(piece);
                prop_assert_eq!(array.tasks.iter().filter(makes).count(), 1);
            }
            for &task in &array.tasks {
                let pieces = JobArray::pieces(task, per_task, 60);
                prop_assert!(missing.iter().any(|piece| pieces.contains(piece)));
            }
        }
    }

    #[test]
    fn indices_are_an_argument_of_any_system() {
        let array = |missing: &[u64], per_task| JobArray::of(missing, per_task).indices();
        assert_eq!(array(&[0, 1, 2, 5], 1), "0-2,5");
        assert_eq!(array(&[0, 1, 2, 5], 2), "0-2");
        let scattered: Vec<u64> = (0..100_000).step_by(2).collect();
        assert_eq!(array(&scattered, 1), "0-99998");
    }
}
