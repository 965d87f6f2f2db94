//! Magnetized faces, shared by all worlds of rigid blocks.
mod docking;
mod face_attraction;
mod hydraulic_network;
mod open_faces;
pub(crate) mod pair_attraction;
mod swept_docking;

pub(crate) use docking::{Anchored, Faces, ReleasedBlock};
pub(crate) use face_attraction::AttractingFace;
