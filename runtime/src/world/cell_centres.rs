//! Positions of lattice cells in space.
use nalgebra::Vector3;
use stochc_ir::Cell;
use stochc_ir::table::Plate;

use super::real::normal;

/// Cell positions of a structure. The origin is the centre of the plate's upper side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellCentres {
    /// Centre of cell (0, 0, 0).
    corner: Vector3<f64>,
}

impl CellCentres {
    pub fn new(plate: &Plate) -> CellCentres {
        let half = |blocks: u32| -(f64::from(blocks) - 1.0) / 2.0;
        CellCentres {
            corner: Vector3::new(half(plate.width), half(plate.depth), -0.5),
        }
    }

    /// Returns the centre of the block in a cell \[block lengths\].
    pub fn centre(&self, cell: Cell) -> Vector3<f64> {
        self.corner + normal::<f64>(cell.into())
    }
}
