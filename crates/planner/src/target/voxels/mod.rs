//! Voxel targets: MagicaVoxel scenes, or layers of plain text.
mod error;
mod layers;
mod magica_voxel;

pub use error::UnreadableVoxels;
pub use layers::layers;
pub use magica_voxel::{VoxelScene, magica_voxel};

use stochc_ir::Cell;

/// Moves the cells so that the least x and y are 0, and the least z is 1.
fn at_the_plate(mut cells: Vec<Cell>) -> Vec<Cell> {
    let least = |axis: fn(&Cell) -> i32| cells.iter().map(axis).min().unwrap_or(0);
    let (x, y, z) = (
        least(|cell| cell.x),
        least(|cell| cell.y),
        least(|cell| cell.z),
    );
    for cell in &mut cells {
        *cell = Cell::new(cell.x - x, cell.y - y, cell.z - z + 1);
    }
    cells
}
