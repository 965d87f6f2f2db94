//! Tasks of a job array. Task i runs `per_task` shards, starting at shard i × `per_task`.
use stochc_text::ranges;

/// Returns the numbers of the tasks that run the `missing` shards. `missing` must be ascending. The
/// result is ascending, too.
pub fn tasks(missing: &[u64], per_task: u64) -> Vec<u64> {
    let mut tasks: Vec<u64> = missing.iter().map(|shard| shard / per_task).collect();
    tasks.dedup();
    tasks
}

/// Returns the value of the option `--array` of `sbatch`, with at most `at_most` tasks at the same
/// time.
pub fn indices(tasks: &[u64], at_most: Option<u64>) -> String {
    /// Largest length of a command line argument that every system accepts \[bytes\].
    const MAX_LENGTH: usize = 100_000;
    let mut indices = ranges(tasks, ",");
    if let ([first, .., last], true) = (tasks, indices.len() > MAX_LENGTH) {
        // A range also includes tasks whose shards are finished. They take little time.
        indices = format!("{first}-{last}");
    }
    if let Some(at_most) = at_most {
        indices += &format!("%{at_most}");
    }
    indices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_missing_shard_has_one_task() {
        assert_eq!(tasks(&[0, 1, 2, 5], 1), [0, 1, 2, 5]);
        assert_eq!(tasks(&[0, 1, 2, 5], 2), [0, 1, 2]);
        assert_eq!(tasks(&[3, 4, 5, 59], 3), [1, 19]);
    }

    #[test]
    fn long_index_lists_fit_an_argument() {
        assert_eq!(indices(&[0, 1, 2, 5], None), "0-2,5");
        assert_eq!(indices(&[0, 1, 5], Some(2)), "0-1,5%2");
        let scattered: Vec<u64> = (0..100_000).step_by(2).collect();
        assert_eq!(indices(&scattered, Some(7)), "0-99998%7");
    }
}
