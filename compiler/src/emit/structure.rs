//! Prints the structures at the ends of phases as text, JSON and drawings.
use std::fmt::{self, Display, Formatter};
use std::rc::Rc;

use serde_json::json;
use stochc_grammar::Symbols;
use stochc_ir::emit::Text;
use stochc_ir::structure::{BuiltBlock, BuiltPhase, BuiltStructure};
use stochc_ir::{Cell, CellBounds, Json};
use stochc_text::counted;

use crate::expanded::ExpandedProgram;
use crate::shapes::layout::Layout;
use crate::shapes::placed_blocks::{PlacedBlock, placed_blocks};
use crate::shapes::shape::MAX_CELLS;

pub(super) fn find(blocks: &[PlacedBlock], cell: Cell) -> Option<&PlacedBlock> {
    let at = blocks.binary_search_by_key(&cell, |block| block.cell);
    at.ok().map(|at| &blocks[at])
}

/// Returns the structure after each phase in the syntax of a `shape`. Only rows and columns with
/// blocks are included.
pub fn structure_text(plan: &ExpandedProgram, layout: &Layout) -> impl Display {
    Text(move |out: &mut Formatter<'_>| write_layers(out, plan, layout))
}

fn write_layers(out: &mut Formatter<'_>, plan: &ExpandedProgram, layout: &Layout) -> fmt::Result {
    if plan.aggregate.is_some() {
        return writeln!(out, "// aggregate {}: it grows at random", plan.name);
    }
    for (phase, blocks) in plan.phases.iter().zip(placed_blocks(plan, layout)) {
        let bounds = CellBounds::enclosing(blocks.iter().map(|block| block.cell));
        let (low, high) = bounds.map_or_else(Default::default, |it| (it.low, it.high));
        let ((west, east), (south, north)) = ((low.x, high.x), (low.y, high.y));
        let layers = low.z.max(1)..=high.z;
        let count = counted(blocks.len(), "block");
        writeln!(out, "// after phase {}: {count}", phase.name)?;
        let edges = [
            (west, east),
            (south, north),
            (*layers.start(), *layers.end()),
        ];
        let edges = edges.map(|(first, last)| (i64::from(last) - i64::from(first) + 1).max(0));
        let cells = edges.iter().map(|&edge| edge as u128).product::<u128>();
        if cells > MAX_CELLS as u128 {
            writeln!(
                out,
                "// {} x {} x {} cells are more than a shape may have; `--json` lists the blocks",
                edges[0], edges[1], edges[2]
            )?;
            continue;
        }
        writeln!(out, "shape {} at ({west}, {south}) {{", plan.name)?;
        for z in layers {
            writeln!(out, "    layer {z} {{")?;
            for y in (south..=north).rev() {
                let row = (west..=east).map(|x| {
                    let block = find(&blocks, Cell::new(x, y, z));
                    if block.is_some() { "#" } else { "." }
                });
                writeln!(out, "        {}", row.collect::<Vec<_>>().join(" "))?;
            }
            out.write_str("    }\n")?;
        }
        out.write_str("}\n")?;
    }
    Ok(())
}

/// Returns the structure as JSON: `{ assembly, phases: [{ name, blocks: [{ name, cell, captured_in
/// }] }] }`.
pub fn structure_json<'a>(
    plan: &'a ExpandedProgram,
    layout: &'a Layout,
    symbols: &'a Symbols,
) -> Json<'a> {
    let block = move |block: PlacedBlock| {
        Json::from(json!({
            "name": plan.roles.name(block.role, symbols),
            "cell": block.cell,
            "captured_in": plan.phases[block.since as usize].name,
        }))
    };
    let phases = move || {
        let phases = plan.phases.iter().zip(placed_blocks(plan, layout));
        phases.map(move |(phase, blocks)| {
            let blocks = Rc::new(blocks);
            let blocks = move || {
                let blocks = blocks.clone();
                (0..blocks.len()).map(move |i| block(blocks[i]))
            };
            Json::object([
                ("name", phase.name.as_str().into()),
                ("blocks", Json::list(blocks)),
            ])
        })
    };
    Json::object([
        ("assembly", plan.name.as_str().into()),
        ("phases", Json::list(phases)),
    ])
}

/// Largest number of blocks in a picture. More cannot be distinguished.
const MAX_BLOCKS: usize = 20_000;

/// Returns the structures to draw. Returns `None` if there are too many blocks for a picture.
pub fn built_structure(
    plan: &ExpandedProgram,
    layout: &Layout,
    symbols: &Symbols,
) -> Option<BuiltStructure> {
    let plate = plan.plate.width as usize * plan.plate.depth as usize;
    let most = *layout.sizes.iter().max()? as usize + plate;
    if most.saturating_mul(plan.phases.len()) > MAX_BLOCKS {
        return None;
    }
    let block = |block: PlacedBlock| BuiltBlock {
        cell: block.cell,
        name: plan.roles.name(block.role, symbols),
        since: block.since as usize,
    };
    let phases = plan.phases.iter().zip(placed_blocks(plan, layout));
    let phases = phases.map(|(phase, blocks)| BuiltPhase {
        name: phase.name.clone(),
        blocks: blocks.into_iter().map(block).collect(),
    });
    let seeds = plan.seeds.iter().filter(|seed| seed.cell.z > 0);
    let seeds = seeds.map(|seed| (seed.cell, plan.roles.name(seed.role, symbols)));
    Some(BuiltStructure {
        program: plan.name.clone(),
        plate: plan.plate.clone(),
        seeds: seeds.collect(),
        phases: phases.collect(),
    })
}
