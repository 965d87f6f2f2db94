//! The scene, the clock and Rapier's driver, shared by the programs that `run.py` runs.
pub mod drive;
pub mod rapier;
pub mod scene;
