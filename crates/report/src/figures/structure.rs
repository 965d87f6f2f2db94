//! Figure of the structure at the end of each phase.
use stochc_ir::structure::{BuiltBlock, BuiltStructure};
use stochc_ir::{Cell, CellBounds};
use stochc_text::palette::{self, LIGHT, Rgb};

use crate::svg::letters::{fitted, widest};
use crate::svg::{Drawing, Medium, Paint, Style};

/// Edge of a cube, in units of a drawing.
const EDGE: f64 = 26.0;

/// Width of a cube in the projection, in units of a drawing.
const WIDTH: f64 = 2.0 * COS * EDGE;

/// Cosine of 30 degrees, the angle of horizontal edges in the projection.
const COS: f64 = 0.866;

/// Draws the structure at the end of each phase, seen from the south-east. A block has the colour
/// of the phase that captured it. Blocks that were captured in the shown phase have dark edges.
pub fn structure(built: &BuiltStructure) -> Drawing {
    let ground = ground(built);
    let blocks = built.phases.iter().flat_map(|phase| &phase.blocks);
    let seeds = built.seeds.iter().map(|(cell, _)| *cell);
    let blocks = blocks.map(|block| block.cell).chain(seeds);
    let all = blocks.chain(ground.iter().copied());
    let corners = all.flat_map(|cell| {
        SIDES
            .into_iter()
            .flat_map(move |(_, side)| corners(cell, side))
    });
    let corners: Vec<(f64, f64)> = corners.collect();
    let bounds = |of: fn(&(f64, f64)) -> f64| {
        let bounds = corners.iter().map(of).map(|it| (it, it));
        let bounds = bounds.reduce(|(low, high), (it, _)| (low.min(it), high.max(it)));
        bounds.unwrap_or((0.0, 0.0))
    };
    let ((left, right), (top, bottom)) = (bounds(|it| it.0), bounds(|it| it.1));
    let names = widest(built.phases.iter().map(|phase| phase.name.as_str()));
    let column = (right - left).max(names.min(3.0 * WIDTH)) + EDGE;
    let height = bottom - top + 2.5 * EDGE;
    let counts = built.phases.iter().map(|phase| match phase.blocks.len() {
        1 => format!("phase {}: 1 block", phase.name),
        count => format!("phase {}: {count} blocks", phase.name),
    });
    let description = if corners.is_empty() {
        "The structure grows at random.".to_owned()
    } else {
        format!(
            "At the end of {}.",
            counts.collect::<Vec<_>>().join(", of ")
        )
    };
    let title = format!("Structure that {} builds", built.program);
    let width = column * built.phases.len() as f64;
    let name = format!("structure-{}", built.program.replace('_', "-"));
    let mut out = Drawing::sized(Medium::Screen, width, &name, &title, &description);
    for (number, phase) in built.phases.iter().enumerate() {
        let middle = column * (number as f64 + 0.5);
        let shift = (middle - (left + right) / 2.0, EDGE / 2.0 - top);
        let mut cubes: Vec<Cube<'_>> = (phase.blocks.iter())
            .map(|block| Cube::of_block(block, number))
            .chain(ground.iter().map(|&cell| Cube::of_plate(cell, "")))
            .chain((built.seeds.iter()).map(|(cell, name)| Cube::of_plate(*cell, name)))
            .collect();
        // Draw cells from the farthest to the nearest.
        cubes.sort_by_key(|Cube { cell, .. }| (cell.x - cell.y + cell.z, cell.z));
        cubes.iter().for_each(|cube| cube.draw(&mut out, shift));
        let foot = (middle, height - 0.9 * EDGE);
        out.text_around("ink", foot, &fitted(&phase.name, column - EDGE / 2.0));
    }
    out.high(height)
}

/// Returns the cells of the plate to draw. In a planar world, the plate covers the table. Only its
/// cells near the structure are drawn.
fn ground(built: &BuiltStructure) -> Vec<Cell> {
    let plate = &built.plate;
    let all = (0..plate.width as i32)
        .flat_map(|x| (0..plate.depth as i32).map(move |y| Cell::new(x, y, 0)));
    let seeds = built.seeds.iter().map(|(cell, _)| *cell);
    let blocks = built.phases.iter().flat_map(|phase| &phase.blocks);
    let standing = seeds.chain(blocks.map(|block| block.cell));
    let near = CellBounds::enclosing(standing).filter(|_| !built.seeds.is_empty());
    let is_near = |cell: &Cell| {
        near.is_none_or(|CellBounds { low, high }| {
            (low.x - 1..=high.x + 1).contains(&cell.x) && (low.y - 1..=high.y + 1).contains(&cell.y)
        })
    };
    all.filter(is_near).collect()
}

/// Visible sides of a cube (top, south and east): brightness and corners of each.
const SIDES: [(f64, [[i32; 3]; 4]); 3] = [
    (1.0, [[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]),
    (0.85, [[0, 0, 1], [1, 0, 1], [1, 0, 0], [0, 0, 0]]),
    (0.7, [[1, 0, 1], [1, 1, 1], [1, 1, 0], [1, 0, 0]]),
];

fn project([x, y, z]: [f64; 3]) -> (f64, f64) {
    (EDGE * COS * (x + y), EDGE * (0.5 * (x - y) - z))
}

/// Returns the corners of a side of a cell's cube.
fn corners(cell: Cell, side: [[i32; 3]; 4]) -> [(f64, f64); 4] {
    let low = [cell.x, cell.y, cell.z].map(f64::from);
    side.map(|corner| project(std::array::from_fn(|i| low[i] + f64::from(corner[i]))))
}

/// Block of the structure or of the plate.
struct Cube<'a> {
    cell: Cell,
    /// Name on the top. Empty for blocks without a name.
    name: &'a str,
    colour: Rgb,
    /// Whether the shown phase captured the block.
    is_new: bool,
}

impl Cube<'_> {
    fn of_block(block: &BuiltBlock, phase: usize) -> Cube<'_> {
        Cube {
            cell: block.cell,
            name: &block.name,
            colour: palette::phase(block.since),
            is_new: block.since == phase,
        }
    }

    fn of_plate(cell: Cell, name: &str) -> Cube<'_> {
        Cube {
            cell,
            name,
            colour: LIGHT.plate,
            is_new: false,
        }
    }

    fn draw(&self, out: &mut Drawing, (right, down): (f64, f64)) {
        let Cube { cell, colour, .. } = *self;
        let (rim, width) = if self.is_new {
            (Rgb(0, 0, 0), 1.6)
        } else {
            (Rgb(0xff, 0xff, 0xff), 0.8)
        };
        let position = |(x, y): (f64, f64)| (x + right, y + down);
        for (light, side) in SIDES {
            let style = Style {
                stroke: Some(Paint::Colour(rim)),
                ..Style::line(width)
            };
            let style = Style::area(colour.shaded(light)).then(style);
            out.polygon(&corners(cell, side).map(position), style);
        }
        if !self.name.is_empty() {
            let low = [cell.x, cell.y, cell.z].map(f64::from);
            let top = position(project([low[0] + 0.5, low[1] + 0.5, low[2] + 1.0]));
            let name = fitted(self.name, 0.8 * WIDTH);
            out.label((top.0, top.1 + 4.0), &name, colour.ink());
        }
    }
}

#[cfg(test)]
mod tests {
    use stochc_ir::structure::BuiltPhase;
    use stochc_ir::table::Plate;

    use super::*;

    fn tower(height: i32) -> BuiltPhase {
        let block = |z| BuiltBlock {
            cell: Cell::new(0, 0, z),
            name: format!("T[{z}]"),
            since: 0,
        };
        BuiltPhase {
            name: "grow & go".to_owned(),
            blocks: (1..=height).map(block).collect(),
        }
    }

    fn drawn(phases: Vec<BuiltPhase>, edge: u32, seeds: usize) -> String {
        let plate = Plate {
            width: edge,
            depth: edge,
        };
        let program = "tower".to_owned();
        structure(&BuiltStructure {
            program,
            plate,
            seeds: vec![(Cell::new(1, 0, 1), "M".to_owned()); seeds],
            phases,
        })
        .file()
    }

    #[test]
    fn each_block_has_three_sides_and_a_name() {
        let picture = drawn(vec![tower(1), tower(3)], 2, 0);
        let document = roxmltree::Document::parse(&picture).unwrap();
        let count = |name| {
            let nodes = document.descendants();
            nodes
                .filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", name)))
                .count()
        };
        assert_eq!(count("polygon"), 3 * (2 * 4 + 1 + 3));
        // There are four labels of blocks and two of phases.
        assert_eq!(count("text"), 4 + 2);
        assert!(picture.contains("grow &amp; go: 3 blocks"));
    }

    #[test]
    fn seeds_of_a_planar_world_have_names() {
        let polygons = |picture: &str| picture.matches("<polygon").count();
        // Only the 3 x 2 cells of the plate around the seed and the block are drawn.
        let picture = drawn(vec![tower(1)], 9, 1);
        assert_eq!(polygons(&picture), 3 * (6 + 1 + 1));
        assert!(picture.contains(">M<"), "{picture}");
    }

    #[test]
    fn an_empty_structure_can_be_drawn() {
        let empty = BuiltPhase {
            blocks: Vec::new(),
            ..tower(0)
        };
        let picture = drawn(vec![empty], 0, 0);
        assert!(roxmltree::Document::parse(&picture).is_ok(), "{picture}");
        assert!(picture.contains("at random") && !picture.contains("NaN"));
    }
}
