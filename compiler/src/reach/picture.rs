//! Draws one layer of the structure as text.
use crate::diagnostic::layer_picture::layer_picture;
use stochc_ir::Cell;

/// Number of cells in the picture on each side of the centre.
const REACH: i32 = 4;

/// Returns the layer around a cell, north at the top: `@` the cell, `#` full, `.` empty. With
/// `has_walls`, walls also fill cells.
pub fn layer(cell: Cell, has_walls: bool, is_full: impl Fn(Cell) -> bool) -> String {
    let is_full = |dx, dy| cell.offset([dx, dy, 0]).is_none_or(&is_full);
    let range = || -REACH..=REACH;
    // Range with occupied cells.
    let full: Vec<(i32, i32)> = range()
        .flat_map(|dy| range().map(move |dx| (dx, dy)))
        .filter(|&(dx, dy)| is_full(dx, dy))
        .collect();
    let bound = |axis: fn(&(i32, i32)) -> i32| {
        let values = || full.iter().map(axis);
        let low = values().min().unwrap_or(0).min(0);
        (low, values().max().unwrap_or(0).max(0))
    };
    let ((west, east), (south, north)) = (bound(|at| at.0), bound(|at| at.1));
    let sign = |x: i32, y: i32| match (x - cell.x, y - cell.y) {
        (0, 0) => '@',
        (dx, dy) if is_full(dx, dy) => '#',
        _ => '.',
    };
    let (x, y) = (
        cell.x.saturating_add(west)..=cell.x.saturating_add(east),
        cell.y.saturating_add(south)..=cell.y.saturating_add(north),
    );
    let walls = if has_walls { ", or the wall" } else { "" };
    format!(
        "layer {}, north at the top: `@` the cell, `#` a block that can be there by then{walls}\n{}",
        cell.z,
        layer_picture(x, y, sign)
    )
}
