//! Where cells are in space.
use nalgebra::Vector3;
use stochc_ir::Cell;
use stochc_ir::table::Plate;

use super::real::normal;

/// The cells of a structure, in a world whose origin is the centre of the plate's upper side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seats {
    /// The centre of cell (0, 0, 0).
    corner: Vector3<f64>,
}

impl Seats {
    pub fn new(plate: &Plate) -> Seats {
        let half = |blocks: u32| -(f64::from(blocks) - 1.0) / 2.0;
        Seats {
            corner: Vector3::new(half(plate.width), half(plate.depth), -0.5),
        }
    }

    /// The centre of the block that sits in a cell \[side\].
    pub fn centre(&self, cell: Cell) -> Vector3<f64> {
        self.corner + normal::<f64>(cell.into())
    }
}
