//! What stands at the end of each phase: as layers of text, as JSON and as a picture.
use std::fmt::{self, Display, Formatter, Write as _};
use std::rc::Rc;

use serde_json::json;
use stochc_grammar::Symbols;
use stochc_ir::emit::Text;
use stochc_ir::palette::{self, LIGHT, Rgb};
use stochc_ir::table::RoleId;
use stochc_ir::{Cell, Json};

use crate::layout::Layout;
use crate::plan::{EventKind, ProgramPlan};
use crate::shape::MOST_CELLS;

/// A block of the structure.
#[derive(Clone, Copy)]
struct PlacedBlock {
    cell: Cell,
    role: RoleId,
    /// The phase that captured it.
    since: u32,
}

/// The blocks above the plate at the end of one phase after the other, sorted by cell.
fn structures<'a>(
    plan: &'a ProgramPlan,
    layout: &'a Layout,
) -> impl Iterator<Item = Vec<PlacedBlock>> + use<'a> {
    // Of each capture, the phase of a block that still stands.
    let mut standing: Vec<Option<u32>> = vec![None; plan.events.len()];
    plan.phases.iter().enumerate().map(move |(since, phase)| {
        let sound = || plan.events_of(phase).filter(|&id| plan.event(id).sound);
        for id in sound().map(|id| id.0 as usize) {
            if let (EventKind::Capture { .. }, Some(_)) = (plan.events[id].kind, layout.cells[id]) {
                standing[id] = Some(since as u32);
            }
        }
        for id in sound().filter(|&id| plan.event(id).kind == EventKind::Release) {
            if let Some(on) = layout.parents[id.0 as usize] {
                standing[on.capture.0 as usize] = None;
            }
        }
        let captures = standing.iter().zip(&plan.events).zip(&layout.cells);
        let blocks = captures.filter_map(|((since, event), cell)| {
            let (role, since, cell) = (event.role, (*since)?, (*cell)?);
            Some(PlacedBlock { cell, role, since })
        });
        let mut blocks: Vec<PlacedBlock> = blocks.collect();
        blocks.sort_by_key(|block| block.cell);
        blocks
    })
}

/// The block in a cell.
fn find(blocks: &[PlacedBlock], cell: Cell) -> Option<&PlacedBlock> {
    let at = blocks.binary_search_by_key(&cell, |block| block.cell);
    at.ok().map(|at| &blocks[at])
}

/// The structure after each phase in the syntax of a `shape`, the cells in use only.
pub fn structure_text(plan: &ProgramPlan, layout: &Layout) -> impl Display {
    Text(move |out: &mut Formatter<'_>| write_layers(out, plan, layout))
}

fn write_layers(out: &mut Formatter<'_>, plan: &ProgramPlan, layout: &Layout) -> fmt::Result {
    if plan.aggregate.is_some() {
        return writeln!(
            out,
            "// aggregate {}: chance decides what it looks like",
            plan.name
        );
    }
    for (phase, blocks) in plan.phases.iter().zip(structures(plan, layout)) {
        let bounds = |axis: fn(&Cell) -> i32| {
            let values = || blocks.iter().map(|block| axis(&block.cell));
            (values().min().unwrap_or(0), values().max().unwrap_or(0))
        };
        let ((west, east), (south, north)) = (bounds(|cell| cell.x), bounds(|cell| cell.y));
        let (low, high) = bounds(|cell| cell.z);
        let layers = low.max(1)..=high;
        let count = blocks.len();
        let plural = if count == 1 { "" } else { "s" };
        writeln!(out, "// after phase {}: {count} block{plural}", phase.name)?;
        let edges = [
            (west, east),
            (south, north),
            (*layers.start(), *layers.end()),
        ];
        let edges = edges.map(|(first, last)| (i64::from(last) - i64::from(first) + 1).max(0));
        let cells = edges.iter().map(|&edge| edge as u128).product::<u128>();
        if cells > MOST_CELLS as u128 {
            writeln!(
                out,
                "// {} x {} x {} cells are more than a shape may have; `--format json` lists the blocks",
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

/// `{ assembly, phases: [{ name, blocks: [{ name, cell, captured_in }] }] }`
pub fn structure_json<'a>(
    plan: &'a ProgramPlan,
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
        let phases = plan.phases.iter().zip(structures(plan, layout));
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

/// Pixels along the edge of a cube.
const EDGE: f64 = 26.0;
/// Blocks that a picture can show before it is of no use.
const MOST_BLOCKS: usize = 20_000;

/// A picture of each phase's end side by side, seen from the south-east; blocks have the colour of the phase that captured
/// them, and dark edges at the end of that phase. `None`: too many blocks for a picture.
pub fn structure_svg(plan: &ProgramPlan, layout: &Layout, symbols: &Symbols) -> Option<String> {
    let plate = plan.plate.width as usize * plan.plate.depth as usize;
    let most = structures(plan, layout)
        .map(|blocks| blocks.len() + plate)
        .max()?;
    if most.saturating_mul(plan.phases.len()) > MOST_BLOCKS {
        return None;
    }
    let phases: Vec<_> = structures(plan, layout).collect();
    let ground: Vec<Cell> = (0..plan.plate.width as i32)
        .flat_map(|x| (0..plan.plate.depth as i32).map(move |y| Cell::new(x, y, 0)))
        .collect();
    let all = phases
        .iter()
        .flat_map(|blocks| blocks.iter().map(|block| &block.cell))
        .chain(&ground);
    let corners: Vec<(f64, f64)> = all.flat_map(|cell| outline(*cell)).collect();
    let bounds = |axis: fn(&(f64, f64)) -> f64| {
        let values = || corners.iter().map(axis);
        (
            values().fold(f64::MAX, f64::min),
            values().fold(f64::MIN, f64::max),
        )
    };
    let ((left, right), (top, bottom)) = (bounds(|point| point.0), bounds(|point| point.1));
    let (width, height) = (right - left + EDGE, bottom - top + 2.5 * EDGE);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {height:.0}\" \
         width=\"{:.0}\" font-family=\"Helvetica, Arial, sans-serif\" text-anchor=\"middle\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n",
        width * phases.len() as f64,
        width * phases.len() as f64,
        LIGHT.paper,
    );
    for (number, (phase, blocks)) in plan.phases.iter().zip(&phases).enumerate() {
        let x = width * number as f64 - left + EDGE / 2.0;
        let _ = writeln!(
            out,
            "<g transform=\"translate({x:.1} {:.1})\">",
            EDGE / 2.0 - top
        );
        let standing = blocks.iter().map(|block| block.cell);
        let mut cells: Vec<Cell> = ground.iter().copied().chain(standing).collect();
        // From the farthest to the nearest.
        cells.sort_by_key(|cell| (cell.x - cell.y + cell.z, cell.z));
        for cell in cells {
            let block = find(blocks, cell);
            let colour = block.map_or(LIGHT.plate, |block| palette::phase(block.since as usize));
            let rim = match block {
                Some(block) if block.since as usize == number => {
                    "stroke=\"#000\" stroke-width=\"1.6\""
                }
                _ => "stroke=\"#fff\" stroke-width=\"0.8\"",
            };
            cube(&mut out, cell, colour, rim);
            if let Some(block) = block {
                let (x, y) = project(
                    f64::from(cell.x) + 0.5,
                    f64::from(cell.y) + 0.5,
                    cell.z,
                    1.0,
                );
                let name = escape(&plan.roles.name(block.role, symbols));
                let size = if name.chars().count() > 3 { 8 } else { 11 };
                let _ = writeln!(
                    out,
                    "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"{size}\" fill=\"{}\">{name}</text>",
                    y + 4.0,
                    colour.ink()
                );
            }
        }
        let middle = (left + right) / 2.0;
        let _ = writeln!(
            out,
            "<text x=\"{middle:.1}\" y=\"{:.1}\" font-size=\"14\" fill=\"#222\">{}</text>\n</g>",
            bottom + 1.1 * EDGE,
            escape(&phase.name),
        );
    }
    out.push_str("</svg>\n");
    Some(out)
}

/// Where a point is drawn, `up` sides above the lower side of layer `z`.
fn project(x: f64, y: f64, z: i32, up: f64) -> (f64, f64) {
    let height = f64::from(z) + up;
    (EDGE * 0.866 * (x + y), EDGE * (0.5 * (x - y) - height))
}

fn outline(cell: Cell) -> [(f64, f64); 6] {
    let (x, y) = (f64::from(cell.x), f64::from(cell.y));
    let at = |dx: f64, dy: f64, up: f64| project(x + dx, y + dy, cell.z, up);
    [
        at(0.0, 0.0, 1.0),
        at(0.0, 1.0, 1.0),
        at(1.0, 1.0, 1.0),
        at(1.0, 1.0, 0.0),
        at(1.0, 0.0, 0.0),
        at(0.0, 0.0, 0.0),
    ]
}

/// The three sides that are seen: top, south and east.
fn cube(out: &mut String, cell: Cell, colour: Rgb, rim: &str) {
    let (x, y) = (f64::from(cell.x), f64::from(cell.y));
    let at = |(dx, dy, up): (f64, f64, f64)| project(x + dx, y + dy, cell.z, up);
    let sides = [
        (
            1.0,
            [
                (0.0, 0.0, 1.0),
                (0.0, 1.0, 1.0),
                (1.0, 1.0, 1.0),
                (1.0, 0.0, 1.0),
            ],
        ),
        (
            0.85,
            [
                (0.0, 0.0, 1.0),
                (1.0, 0.0, 1.0),
                (1.0, 0.0, 0.0),
                (0.0, 0.0, 0.0),
            ],
        ),
        (
            0.7,
            [
                (1.0, 0.0, 1.0),
                (1.0, 1.0, 1.0),
                (1.0, 1.0, 0.0),
                (1.0, 0.0, 0.0),
            ],
        ),
    ];
    for (light, points) in sides {
        let points: Vec<String> = (points.into_iter().map(at))
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        let _ = writeln!(
            out,
            "<polygon points=\"{}\" fill=\"{}\" {rim}/>",
            points.join(" "),
            colour.shaded(light)
        );
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
