//! Declaration of a target as a shape.
use std::fmt::Write as _;

use stochc_ir::Cell;

/// Largest number of cells in a shape's layers, including empty ones.
const MAX: u64 = 40_000_000;

/// Returns the declaration of a shape with these sorted cells, or `None` if it is too large.
pub fn declaration(name: &str, cells: &[Cell]) -> Option<String> {
    let west = cells.iter().map(|cell| cell.x).min()?;
    let south = cells.iter().map(|cell| cell.y).min()?;
    let mut sorted: Vec<Cell> = cells.to_vec();
    // By layer, then by row from the south, then from the west.
    sorted.sort_unstable_by_key(|cell| (cell.z, cell.y, cell.x));
    let mut area = 0u64;
    let mut layers: Vec<(i32, i32, Vec<String>)> = Vec::new();
    for layer in sorted.chunk_by(|a, b| a.z == b.z) {
        let mut rows: Vec<String> = Vec::new();
        for row in layer.chunk_by(|a, b| a.y == b.y) {
            let north = (row[0].y - south) as usize;
            let length = u64::from(row[row.len() - 1].x.abs_diff(west)) + 1;
            area = area
                .saturating_add(length)
                .saturating_add((north + 1 - rows.len()) as u64);
            if area > MAX {
                return None;
            }
            rows.resize(north, ".".to_owned());
            let mut text = vec!["."; length as usize];
            for cell in row {
                text[cell.x.abs_diff(west) as usize] = "#";
            }
            rows.push(text.join(" "));
        }
        rows.reverse();
        let z = layer[0].z;
        match layers.last_mut() {
            Some((_, high, same)) if *high + 1 == z && *same == rows => *high = z,
            _ => layers.push((z, z, rows)),
        }
    }
    // Counts every layer, including equal ones.
    let levels = |low: i32, high: i32| u64::from(high.abs_diff(low)) + 1;
    let in_all = layers.iter().map(|(low, high, rows)| {
        let signs: usize = rows.iter().map(|row| row.len().div_ceil(2)).sum();
        levels(*low, *high) * signs as u64
    });
    if in_all.sum::<u64>() > MAX {
        return None;
    }
    let at = match (west, south) {
        (0, 0) => String::new(),
        (west, south) => format!(" at ({west}, {south})"),
    };
    let mut out = format!("shape {name}{at} {{\n");
    // Writing to a string cannot fail.
    for (low, high, rows) in layers {
        let _ = if low == high {
            writeln!(out, "layer {low} {{")
        } else {
            writeln!(out, "layer {low}..{high} {{")
        };
        for row in rows {
            let _ = writeln!(out, "{row}");
        }
        out.push_str("}\n");
    }
    out.push_str("}\n");
    Some(out)
}
