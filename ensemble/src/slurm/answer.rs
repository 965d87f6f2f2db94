//! What it means that a command of Slurm fails.

/// Whether Slurm says that its controller cannot be asked now, so that the same may succeed in a while.
pub fn is_passing(said: &str) -> bool {
    /// What is said while a controller is being started, or has too much to do.
    const PASSING: [&str; 9] = [
        "Unable to contact slurm controller",
        "Socket timed out",
        "Zero Bytes were transmitted",
        "Connection refused",
        "Connection timed out",
        "in standby mode",
        "Transport endpoint is not connected",
        "Communication connection failure",
        "Resource temporarily unavailable",
    ];
    PASSING.iter().any(|part| said.contains(part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_restart_passes_and_a_refusal_does_not() {
        assert!(is_passing(
            "slurm_load_jobs error: Unable to contact slurm controller (connect failure)"
        ));
        assert!(!is_passing(
            "sbatch: error: Batch job submission failed: Invalid partition name specified"
        ));
    }
}
