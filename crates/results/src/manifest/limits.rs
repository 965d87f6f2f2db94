//! Format and limits of manifests.

/// Version of the layout of a results folder. Other versions are rejected.
pub const FORMAT: u32 = 1;

/// Largest number of runs of each program.
pub const MAX_RUNS: u64 = 10_000_000;

/// Largest number of programs that are compared in pairs.
pub const MAX_PROGRAMS: usize = 1_000;
