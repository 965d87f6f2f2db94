//! Magnetized faces: the same in every world of rigid blocks.
mod faces;
mod target;

pub(crate) use faces::{Cloud, Faces, Held};
pub(crate) use target::INVERSE_INERTIA;
