//! How large a target may be.

/// Cells of a target, at most: as many as a program may capture.
pub const MAX_CELLS: usize = 5_000_000;

/// Coordinates are no further from 0 than this.
pub const FARTHEST: i32 = 1_000_000_000;

/// Maximum number of models, nodes and layers of a `.vox` file.
pub const MAX_VOXEL_PARTS: usize = 500_000;
