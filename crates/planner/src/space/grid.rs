//! Grid of values around the cells of a structure.
use rustc_hash::FxHashMap;
use stochc_ir::{Cell, offsets_within};

/// Value for each cell in the bounding box of a structure, enlarged by a margin.
#[derive(Clone, Debug)]
pub struct Grid<T> {
    low: Cell,
    /// Number of cells along x, y and z.
    size: [i64; 3],
    values: Values<T>,
}

#[derive(Clone, Debug)]
enum Values<T> {
    /// All cells of the box around the structure, x first.
    Dense(Vec<T>),
    /// Cells near the structure, if the box is mostly empty.
    Sparse(FxHashMap<Cell, T>),
}

/// Limit on the size of a dense grid \[cells\]. The limit is the first number, plus the second
/// number for each cell of the structure.
const DENSE: (i128, i128) = (1 << 22, 32);

impl<T: Copy + Default> Grid<T> {
    /// Returns a grid with default values. Coordinates must be far from the ends of their range.
    pub fn around(cells: &[Cell], margin: i32) -> Grid<T> {
        let first = cells.first().copied().unwrap_or_default();
        let (mut low, mut high) = (first, first);
        for cell in cells {
            low = Cell::new(low.x.min(cell.x), low.y.min(cell.y), low.z.min(cell.z));
            high = Cell::new(high.x.max(cell.x), high.y.max(cell.y), high.z.max(cell.z));
        }
        let low = shifted(low, -margin, -margin, -margin);
        let high = shifted(high, margin, margin, margin);
        let along = |low: i32, high: i32| i64::from(high) - i64::from(low) + 1;
        let size = [
            along(low.x, high.x),
            along(low.y, high.y),
            along(low.z, high.z),
        ];
        let volume: i128 = size.iter().map(|&edge| i128::from(edge)).product();
        let is_dense = volume <= DENSE.0 + DENSE.1 * cells.len() as i128;
        let values = if is_dense {
            Values::Dense(vec![T::default(); volume as usize])
        } else {
            Values::Sparse(dilated(cells, margin))
        };
        Grid { low, size, values }
    }

    fn place(&self, cell: Cell) -> Option<usize> {
        let [width, depth, height] = self.size;
        let x = i64::from(cell.x) - i64::from(self.low.x);
        let y = i64::from(cell.y) - i64::from(self.low.y);
        let z = i64::from(cell.z) - i64::from(self.low.z);
        let inside = (0..width).contains(&x) && (0..depth).contains(&y) && (0..height).contains(&z);
        inside.then(|| ((z * depth + y) * width + x) as usize)
    }

    /// Returns the value of a cell, or `None` outside the grid.
    pub fn get(&self, cell: Cell) -> Option<T> {
        match &self.values {
            Values::Dense(values) => Some(values[self.place(cell)?]),
            Values::Sparse(values) => values.get(&cell).copied(),
        }
    }

    /// Returns the cells of a sparse grid. Returns no cells if the grid is dense.
    pub fn stored(&self) -> Vec<Cell> {
        match &self.values {
            Values::Dense(_) => Vec::new(),
            Values::Sparse(values) => values.keys().copied().collect(),
        }
    }

    pub fn set(&mut self, cell: Cell, value: T) {
        let place = self.place(cell);
        match &mut self.values {
            Values::Dense(values) => {
                if let Some(place) = place {
                    values[place] = value;
                }
            }
            Values::Sparse(values) => {
                if let Some(old) = values.get_mut(&cell) {
                    *old = value;
                }
            }
        }
    }
}

fn dilated<T: Default>(cells: &[Cell], margin: i32) -> FxHashMap<Cell, T> {
    let mut values = FxHashMap::default();
    for &cell in cells {
        for near in offsets_within(margin).filter_map(|offset| cell.offset(offset)) {
            values.entry(near).or_default();
        }
    }
    values
}

/// Returns the cell at an offset. Coordinates must be far from the ends of their range.
pub fn shifted(cell: Cell, dx: i32, dy: i32, dz: i32) -> Cell {
    Cell::new(cell.x + dx, cell.y + dy, cell.z + dz)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_stored_in_dense_and_sparse_boxes() {
        let near = [Cell::new(0, 0, 1), Cell::new(3, 1, 2)];
        let far = [Cell::new(0, 0, 1), Cell::new(900_000, 900_000, 900_000)];
        for cells in [near, far] {
            let mut grid = Grid::<u32>::around(&cells, 2);
            for (i, &cell) in cells.iter().enumerate() {
                grid.set(cell, i as u32 + 1);
            }
            assert_eq!(cells.map(|cell| grid.get(cell)), [Some(1), Some(2)]);
            assert_eq!(grid.get(Cell::new(-2, -2, -1)), Some(0));
            let outside = Cell::new(-3, 0, 1);
            grid.set(outside, 9);
            assert_eq!(grid.get(outside), None);
        }
    }
}
