//! Cells and faces of the lattice.
pub(crate) mod cell;
pub(crate) mod cell_bounds;
pub(crate) mod face;
