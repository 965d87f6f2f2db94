//! The box that cells are in.
use crate::Cell;

/// The least and the greatest coordinates of some cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellBounds {
    /// The least of each axis.
    pub low: Cell,
    /// The greatest of each axis.
    pub high: Cell,
}

impl CellBounds {
    /// Those of some cells; `None` if there are none.
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
