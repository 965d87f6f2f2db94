//! Shapes, and the cells of blocks.
pub(crate) mod declared_shapes;
pub mod layout;
pub mod placed_blocks;
pub(crate) mod shape;
