//! Bounding box of cells.
use crate::Cell;

/// Smallest and largest coordinates of some cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellBounds {
    /// Smallest coordinates.
    pub low: Cell,
    /// Largest coordinates.
    pub high: Cell,
}

impl CellBounds {
    /// Returns the bounds of some cells, or `None` if there are none.
    pub fn enclosing(cells: impl IntoIterator<Item = Cell>) -> Option<CellBounds> {
        let mut cells = cells.into_iter();
        let first = cells.next()?;
        let bounds = CellBounds {
            low: first,
            high: first,
        };
        Some(
            cells.fold(bounds, |CellBounds { low, high }, cell| CellBounds {
                low: Cell::new(low.x.min(cell.x), low.y.min(cell.y), low.z.min(cell.z)),
                high: Cell::new(high.x.max(cell.x), high.y.max(cell.y), high.z.max(cell.z)),
            }),
        )
    }
}
