//! Reads arbitrary bytes as a voxel file. The cells of a valid file must rest on the plate.
use stochc_planner::{layers, magica_voxel};

/// Reads an input as a voxel file. Panics if its cells do not rest on the plate.
pub fn read(bytes: &[u8]) {
    let scenes = [None, Some(0), Some(1)].map(|model| magica_voxel(bytes, model));
    let scenes = scenes.into_iter().flatten().map(|scene| scene.cells);
    let drawn = layers(&String::from_utf8_lossy(bytes));
    for cells in scenes.chain(drawn) {
        let lowest = cells.iter().map(|cell| cell.z).min();
        assert!(lowest.is_none_or(|lowest| lowest == 1), "{lowest:?}");
    }
}
