//! Scene, clock and Rapier driver that the programs of `run.py` share.
pub mod drive;
pub mod rapier;
pub mod scene;
