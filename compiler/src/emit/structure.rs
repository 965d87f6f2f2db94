//! What stands at the end of each phase: as layers of text, as JSON and as a picture.
use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::{Value, json};
use stochc_grammar::Symbols;

use crate::Cell;
use crate::layout::Layout;
use crate::plan::{Deed, EventId, Plan};
use crate::table::RoleId;

/// A block of the structure.
struct Standing {
    role: RoleId,
    /// The phase that captured it.
    since: usize,
}

/// The blocks above the plate at the end of each phase, by cell.
fn structures(plan: &Plan, layout: &Layout) -> Vec<BTreeMap<Cell, Standing>> {
    let mut standing: BTreeMap<EventId, (Cell, Standing)> = BTreeMap::new();
    let mut phases = Vec::new();
    for (since, phase) in plan.phases.iter().enumerate() {
        let sound = || plan.events_of(phase).filter(|&id| plan.event(id).sound);
        for id in sound() {
            let event = plan.event(id);
            if let (Deed::Capture { .. }, Some(cell)) = (event.deed, layout.cells[id.0 as usize]) {
                let role = event.role;
                standing.insert(id, (cell, Standing { role, since }));
            }
        }
        for id in sound().filter(|&id| plan.event(id).deed == Deed::Release) {
            if let Some(on) = layout.parents[id.0 as usize] {
                standing.remove(&on.capture);
            }
        }
        let blocks = standing.values();
        phases.push(
            blocks
                .map(|(cell, block)| {
                    let Standing { role, since } = *block;
                    (*cell, Standing { role, since })
                })
                .collect(),
        );
    }
    phases
}

/// The structure after each phase in the syntax of a `shape`, the cells in use only.
pub fn structure_text(plan: &Plan, layout: &Layout) -> String {
    let mut out = String::new();
    if plan.aggregate.is_some() {
        return format!(
            "// aggregate {}: chance decides what it looks like\n",
            plan.name
        );
    }
    for (phase, blocks) in plan.phases.iter().zip(structures(plan, layout)) {
        let bounds = |axis: fn(&Cell) -> i32| {
            let values = || blocks.keys().map(axis);
            (values().min().unwrap_or(0), values().max().unwrap_or(0))
        };
        let ((west, east), (south, north)) = (bounds(|cell| cell.x), bounds(|cell| cell.y));
        let heights = bounds(|cell| cell.z);
        // Writing to a string cannot fail.
        let count = blocks.len();
        let plural = if count == 1 { "" } else { "s" };
        let _ = writeln!(out, "// after phase {}: {count} block{plural}", phase.name);
        let _ = writeln!(out, "shape {} at ({west}, {south}) {{", plan.name);
        for z in heights.0.max(1)..=heights.1 {
            let _ = writeln!(out, "    layer {z} {{");
            for y in (south..=north).rev() {
                let row = (west..=east).map(|x| {
                    let block = blocks.contains_key(&Cell::new(x, y, z));
                    if block { "#" } else { "." }
                });
                let _ = writeln!(out, "        {}", row.collect::<Vec<_>>().join(" "));
            }
            out.push_str("    }\n");
        }
        out.push_str("}\n");
    }
    out
}

/// `{ assembly, phases: [{ name, blocks: [{ name, cell, captured_in }] }] }`
pub fn structure_json(plan: &Plan, layout: &Layout, symbols: &Symbols) -> Value {
    let phases: Vec<Value> = (plan.phases.iter().zip(structures(plan, layout)))
        .map(|(phase, blocks)| {
            let blocks: Vec<Value> = (blocks.iter())
                .map(|(cell, block)| {
                    json!({
                        "name": plan.roles.name(block.role, symbols),
                        "cell": cell,
                        "captured_in": plan.phases[block.since].name,
                    })
                })
                .collect();
            json!({ "name": phase.name, "blocks": blocks })
        })
        .collect();
    json!({ "assembly": plan.name, "phases": phases })
}

/// Pixels along the edge of a cube.
const EDGE: f64 = 26.0;
/// Blocks that a picture can show before it is of no use.
const MOST_BLOCKS: usize = 20_000;

/// A picture of each phase's end side by side, seen from the south-east; blocks that the phase has
/// captured are lighter. `None`: too many blocks for a picture.
pub fn structure_svg(plan: &Plan, layout: &Layout, symbols: &Symbols) -> Option<String> {
    let phases = structures(plan, layout);
    let plate = plan.plate.width as usize * plan.plate.depth as usize;
    let most = phases.iter().map(|blocks| blocks.len() + plate).max()?;
    if most * phases.len() > MOST_BLOCKS {
        return None;
    }
    let ground: Vec<Cell> = (0..plan.plate.width as i32)
        .flat_map(|x| (0..plan.plate.depth as i32).map(move |y| Cell::new(x, y, 0)))
        .collect();
    let all = phases
        .iter()
        .flat_map(|blocks| blocks.keys())
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
         <rect width=\"100%\" height=\"100%\" fill=\"#fcfcfa\"/>\n",
        width * phases.len() as f64,
        width * phases.len() as f64,
    );
    for (number, (phase, blocks)) in plan.phases.iter().zip(&phases).enumerate() {
        let x = width * number as f64 - left + EDGE / 2.0;
        let _ = writeln!(
            out,
            "<g transform=\"translate({x:.1} {:.1})\">",
            EDGE / 2.0 - top
        );
        let mut cells: Vec<Cell> = ground.iter().chain(blocks.keys()).copied().collect();
        // From the farthest to the nearest.
        cells.sort_by_key(|cell| (cell.x - cell.y + cell.z, cell.z));
        for cell in cells {
            let block = blocks.get(&cell);
            let colours = match block {
                None => ["#d8d6cf", "#bfbcb3", "#aaa79e"],
                Some(block) if block.since == number => ["#ffd9a0", "#f2b45c", "#d9913a"],
                Some(_) => ["#a9c9e8", "#7ba6d0", "#5b88b5"],
            };
            cube(&mut out, cell, colours);
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
                    "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"{size}\" fill=\"#333\">{name}</text>",
                    y + 4.0
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
fn cube(out: &mut String, cell: Cell, [top, south, east]: [&str; 3]) {
    let (x, y) = (f64::from(cell.x), f64::from(cell.y));
    let at = |(dx, dy, up): (f64, f64, f64)| project(x + dx, y + dy, cell.z, up);
    let sides = [
        (
            top,
            [
                (0.0, 0.0, 1.0),
                (0.0, 1.0, 1.0),
                (1.0, 1.0, 1.0),
                (1.0, 0.0, 1.0),
            ],
        ),
        (
            south,
            [
                (0.0, 0.0, 1.0),
                (1.0, 0.0, 1.0),
                (1.0, 0.0, 0.0),
                (0.0, 0.0, 0.0),
            ],
        ),
        (
            east,
            [
                (1.0, 0.0, 1.0),
                (1.0, 1.0, 1.0),
                (1.0, 1.0, 0.0),
                (1.0, 0.0, 0.0),
            ],
        ),
    ];
    for (colour, points) in sides {
        let points: Vec<String> = (points.into_iter().map(at))
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        let _ = writeln!(
            out,
            "<polygon points=\"{}\" fill=\"{colour}\" stroke=\"#fff\" stroke-width=\"0.8\"/>",
            points.join(" ")
        );
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
