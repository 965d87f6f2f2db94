//! Limits of target sizes.

/// Largest number of cells of a target: as many as a program may capture.
pub const MAX_CELLS: usize = 5_000_000;

/// Largest absolute value of a coordinate.
pub const FARTHEST: i32 = 1_000_000_000;

/// Largest number of models, nodes and layers of a `.vox` file.
pub const MAX_VOXEL_PARTS: usize = 500_000;

/// Largest number of sites of a small target.
pub const SMALL: usize = 12;
