//! Prints the built structure as STL, for CAD programs and 3D printers.
use std::fmt::{self, Display, Formatter};

use stochc_ir::emit::Text;
use stochc_ir::{Cell, Face};

use super::structure::find;
use crate::expanded::ExpandedProgram;
use crate::shapes::layout::Layout;
use crate::shapes::placed_blocks::placed_blocks;

/// Returns the surface of the structure at the end of the program as STL text. `side` is the length
/// of a block \[mm\]. Faces between two blocks are left out.
pub fn structure_stl(plan: &ExpandedProgram, layout: &Layout, side: f64) -> impl Display {
    Text(move |out: &mut Formatter<'_>| write_surface(out, plan, layout, side))
}

fn write_surface(
    out: &mut Formatter<'_>,
    plan: &ExpandedProgram,
    layout: &Layout,
    side: f64,
) -> fmt::Result {
    let blocks = placed_blocks(plan, layout).last().unwrap_or_default();
    writeln!(out, "solid {}", plan.name)?;
    for block in &blocks {
        for face in Face::ALL {
            let next = block.cell.across(face);
            if next.is_none_or(|next| find(&blocks, next).is_none()) {
                write_face(out, block.cell, face, side)?;
            }
        }
    }
    writeln!(out, "endsolid {}", plan.name)
}

/// Writes a face as two triangles. Seen from outside, their corners are anticlockwise.
fn write_face(out: &mut Formatter<'_>, cell: Cell, face: Face, side: f64) -> fmt::Result {
    let normal = face.normal();
    let axis = normal.iter().position(|part| *part != 0).unwrap_or(0);
    let is_positive = normal[axis] > 0;
    let corner = |across: u8, along: u8| {
        let mut corner = [cell.x, cell.y, cell.z - 1].map(f64::from);
        corner[axis] += f64::from(u8::from(is_positive));
        corner[(axis + 1) % 3] += f64::from(across);
        corner[(axis + 2) % 3] += f64::from(along);
        corner.map(|length| length * side)
    };
    let mut square = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
    if !is_positive {
        square.reverse();
    }
    let [x, y, z] = normal;
    for triangle in [[0, 1, 2], [0, 2, 3]] {
        writeln!(out, "facet normal {x} {y} {z}")?;
        writeln!(out, "outer loop")?;
        for [x, y, z] in triangle.map(|index| square[index]) {
            writeln!(out, "vertex {x} {y} {z}")?;
        }
        writeln!(out, "endloop")?;
        writeln!(out, "endfacet")?;
    }
    Ok(())
}
