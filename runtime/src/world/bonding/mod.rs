//! Magnetized faces: the same in every world of rigid blocks.
mod faces;
mod hydraulics;
pub(crate) mod pairs;
mod placed;
mod target;

pub(crate) use faces::{Faces, Held, Release};
pub(crate) use target::INVERSE_INERTIA;
