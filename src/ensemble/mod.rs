//! An ensemble of runs.
