//! Existing structure at the start: pre-attached blocks. Some of them are released.
use std::fmt::Write as _;

use rustc_hash::FxHashMap;
use stochc_ir::Cell;

use super::statement::{Called, NameWords};
use crate::plan::capture::Capture;
use crate::target::structure::{ExistingBlock, Target};

/// Returns the pre-attached blocks, each after its parent. Empty in a planar world.
pub fn pre_attached(target: &Target) -> Vec<Capture> {
    if target.plane().is_some() {
        return Vec::new();
    }
    let all = || target.existing().iter().chain(target.released());
    let there: FxHashMap<Cell, &ExistingBlock> = all().map(|block| (block.cell, block)).collect();
    let parent = |block: &ExistingBlock| {
        let cell = block.cell.across(block.direction.opposite())?;
        there.get(&cell).copied()
    };
    let depth = |block: &ExistingBlock| {
        let above = std::iter::successors(parent(block), |block| parent(block));
        above.take(there.len()).count()
    };
    let mut sorted: Vec<(usize, &ExistingBlock)> =
        all().map(|block| (depth(block), block)).collect();
    sorted.sort_unstable();
    let captures = sorted
        .into_iter()
        .map(|(_, block)| Capture::at_once(block.cell, block.direction));
    captures.collect()
}

/// Returns the name of the pre-attached block, or of the seed of a planar world, in a cell. Returns
/// `None` if there is none.
pub fn name_of(target: &Target, cell: Cell) -> Option<String> {
    let Cell { x, y, z } = target.existing_at(cell)?.cell;
    if target.plane().is_some() {
        return Some(format!("P[{x}, {y}]"));
    }
    let word = NameWords::OWN.name(Called::Block);
    Some(format!("{word}[{x}, {y}, {z}]"))
}

/// Returns the positions of a planar world's seeds, sorted. Empty in space. Seeds without captures
/// are obstacles.
pub fn seeds_among_cells(target: &Target) -> Vec<(i32, i32)> {
    let seeds = target.plane().map(|_| target.existing());
    let seeds = seeds.into_iter().flatten();
    seeds.map(|it| (it.cell.x, it.cell.y)).collect()
}

/// Writes the phase that releases existing blocks. It follows the plate in the source.
pub fn write_releases(target: &Target, out: &mut String) {
    let word = NameWords::OWN.name(Called::Block);
    let released = target.released().iter();
    let names: Vec<String> = released
        .map(|ExistingBlock { cell, .. }| format!("{word}[{}, {}, {}]", cell.x, cell.y, cell.z))
        .collect();
    if names.is_empty() {
        return;
    }
    // Writing to a string cannot fail.
    let _ = write!(
        out,
        "}}\nphase clear {{\n/// Blocks outside the shape, with everything attached to them.\nrelease {}\n",
        names.join(", ")
    );
}
