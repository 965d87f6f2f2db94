//! Captures as chained statements.
use std::fmt::Write as _;

use rustc_hash::FxHashMap;
use stochc_ir::{Cell, Face};

use super::loop_nest::Indices;
use crate::plan::capture::Capture;

/// Kind of a block's name. The indices of the name are the block's cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Called {
    /// Block of the target.
    Block,
    /// Block of a scaffold.
    Scaffold,
}

/// First words of the names of blocks, by kind of block.
#[derive(Clone, Copy, Debug)]
pub struct NameWords<'a> {
    pub block: &'a str,
    pub scaffold: &'a str,
}

impl NameWords<'_> {
    /// First words in a program that contains only a plan.
    pub const OWN: NameWords<'static> = NameWords {
        block: "B",
        scaffold: "S",
    };

    pub fn name(&self, called: Called) -> &str {
        match called {
            Called::Block => self.block,
            Called::Scaffold => self.scaffold,
        }
    }
}

impl Called {
    fn from_capture(capture: &Capture) -> Called {
        if capture.is_temporary {
            Called::Scaffold
        } else {
            Called::Block
        }
    }
}

/// Statement that writes a chain of captures, each by the previous block.
#[derive(Clone, Debug)]
pub struct Statement {
    /// Indices of the captures in the plan.
    captures: Vec<usize>,
    base: Cell,
    /// Direction and number of cells of each straight section.
    rows: Vec<(Face, i32)>,
    /// Blocks that must exist before the first capture, as rows along an axis. Each row has the
    /// kind of its names, its first cell and its last cell.
    after: Vec<(Called, Cell, Cell)>,
    /// Kind of the first parent's name, and kind of the names of the captured blocks.
    called: [Called; 2],
    /// Name of the first parent, if it is not a block of the plan.
    parent: Option<String>,
    /// Index of the statement that contains the previous capture by the same parent.
    pub follows: Option<usize>,
}

/// Returns the captures of a plan as statements that keep the order of each parent's captures.
///
/// `other` returns the name of an existing block that is not named by its position on the plate.
pub fn statements(captures: &[Capture], other: impl Fn(Cell) -> Option<String>) -> Vec<Statement> {
    let place: FxHashMap<Cell, usize> = captures
        .iter()
        .enumerate()
        .map(|(i, capture)| (capture.cell, i))
        .collect();
    let parent = |capture: &Capture| {
        let cell = capture.cell.across(capture.direction.opposite())?;
        place.get(&cell).copied()
    };
    // Captures by parent, in order.
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); captures.len()];
    for (i, capture) in captures.iter().enumerate() {
        if let Some(parent) = parent(capture) {
            children[parent].push(i);
        }
    }
    let mut within = vec![usize::MAX; captures.len()];
    let mut statements: Vec<Statement> = Vec::new();
    for (i, capture) in captures.iter().enumerate() {
        if within[i] != usize::MAX {
            continue;
        }
        let parent = parent(capture);
        let before = parent.and_then(|parent| {
            let siblings = &children[parent];
            let here = siblings.iter().position(|&child| child == i)?;
            siblings[..here].last().copied()
        });
        let outside = match parent {
            Some(_) => None,
            None => capture
                .cell
                .across(capture.direction.opposite())
                .and_then(&other),
        };
        let mut statement = Statement {
            parent: outside,
            captures: vec![i],
            base: capture.cell,
            rows: vec![(capture.direction, 1)],
            after: after(capture, |cell| {
                let found = place.get(&cell);
                found.map_or(Called::Block, |&at| Called::from_capture(&captures[at]))
            }),
            called: [
                parent.map_or(Called::Block, |parent| {
                    Called::from_capture(&captures[parent])
                }),
                Called::from_capture(capture),
            ],
            follows: before.map(|before| within[before]),
        };
        within[i] = statements.len();
        let mut last = i;
        // Only the first capture of a chain can have predecessors, and only a block's first capture
        // can extend its chain.
        while let Some(&next) = children[last].first()
            && captures[next].after.is_empty()
            && captures[next].is_temporary == capture.is_temporary
        {
            within[next] = statements.len();
            statement.captures.push(next);
            match statement.rows.last_mut() {
                Some((direction, length)) if *direction == captures[next].direction => *length += 1,
                _ => statement.rows.push((captures[next].direction, 1)),
            }
            last = next;
        }
        statements.push(statement);
    }
    statements
}

/// Returns the predecessors of a capture as rows of blocks of one kind.
fn after(capture: &Capture, called: impl Fn(Cell) -> Called) -> Vec<(Called, Cell, Cell)> {
    let rows = [Called::Block, Called::Scaffold]
        .into_iter()
        .flat_map(|name| {
            let cells = capture.after.iter().map(|(cell, _)| *cell);
            let rows = rows_of(cells.filter(|&cell| called(cell) == name).collect());
            rows.into_iter()
                .map(move |(first, last)| (name, first, last))
        });
    rows.collect()
}

/// Returns cells as rows along an axis. Selects the axis with the fewest rows.
fn rows_of(mut cells: Vec<Cell>) -> Vec<(Cell, Cell)> {
    type Key = fn(&Cell) -> (i32, i32, i32);
    const KEYS: [Key; 3] = [
        |cell| (cell.y, cell.z, cell.x),
        |cell| (cell.x, cell.z, cell.y),
        |cell| (cell.x, cell.y, cell.z),
    ];
    let mut rows = |key: Key| {
        cells.sort_unstable_by_key(key);
        let mut rows: Vec<(Cell, Cell)> = Vec::new();
        for &cell in &cells {
            let at = key(&cell);
            match rows.last_mut() {
                Some((_, last)) if key(last) == (at.0, at.1, at.2 - 1) => *last = cell,
                _ => rows.push((cell, cell)),
            }
        }
        rows
    };
    let all = KEYS.map(&mut rows);
    let mut all = all.into_iter();
    let first = all.next().expect("three axes");
    all.fold(
        first,
        |best, rows| if rows.len() < best.len() { rows } else { best },
    )
}

/// Content of a statement, relative to its base cell. Its parts are: whether a seed captures first,
/// the name of a first parent outside of the plan, the kinds of names, the straight sections, and
/// the predecessors.
pub type StatementSignature<'a> = (
    bool,
    Option<&'a str>,
    [Called; 2],
    &'a [(Face, i32)],
    Vec<(Called, [i32; 6])>,
);

impl Statement {
    /// Returns the index of the statement's first capture in the plan.
    pub fn first(&self) -> usize {
        self.captures[0]
    }

    pub fn base(&self) -> Cell {
        self.base
    }

    /// Returns the plate position of the seed that captures first. Returns `None` if no seed does.
    pub fn seed(&self) -> Option<(i32, i32)> {
        let is_seed = self.base.z == 1 && self.rows[0].0 == Face::Up && self.parent.is_none();
        is_seed.then_some((self.base.x, self.base.y))
    }

    /// Returns the statement relative to its base. Equal signatures differ only in position.
    pub fn signature(&self) -> StatementSignature<'_> {
        let Cell { x, y, z } = self.base;
        let after = self.after.iter().map(|&(called, first, last)| {
            let ends = [
                first.x - x,
                first.y - y,
                first.z - z,
                last.x - x,
                last.y - y,
                last.z - z,
            ];
            (called, ends)
        });
        let is_on_seed = self.seed().is_some();
        let parent = self.parent.as_deref();
        (is_on_seed, parent, self.called, &self.rows, after.collect())
    }

    /// Writes the statement with indices relative to its base.
    pub fn write(&self, out: &mut String, at: &Indices<'_>, words: NameWords<'_>) {
        let Cell { x, y, z } = self.base;
        let [dx, dy, dz] = self.rows[0].0.normal();
        // Writing to a string cannot fail.
        let _ = match (&self.parent, self.seed()) {
            (Some(name), _) => write!(out, "{name}"),
            (None, Some(_)) => write!(out, "P[{}, {}]", at.x(0), at.y(0)),
            (None, None) => {
                let name = words.name(self.called[0]);
                write!(out, "{name}[{}, {}, {}]", at.x(-dx), at.y(-dy), at.z(-dz))
            }
        };
        let name = words.name(self.called[1]);
        let mut here = Cell::new(-dx, -dy, -dz);
        for &(direction, length) in &self.rows {
            let [dx, dy, dz] = direction.normal();
            let step = |here: Cell, steps: i32| {
                Cell::new(
                    here.x + steps * dx,
                    here.y + steps * dy,
                    here.z + steps * dz,
                )
            };
            if length > 1 && dx + dy + dz > 0 {
                let (first, last) = (step(here, 1), step(here, length));
                let _ = write!(out, ".{direction} ->> {name}{}", at.block(first, last));
                here = last;
            } else {
                for _ in 0..length {
                    here = step(here, 1);
                    let _ = write!(out, ".{direction} -> {name}{}", at.block(here, here));
                }
            }
        }
        let from = |cell: &Cell| Cell::new(cell.x - x, cell.y - y, cell.z - z);
        for (i, (called, first, last)) in self.after.iter().enumerate() {
            let sign = if i == 0 { " after " } else { ", " };
            let name = words.name(*called);
            let _ = write!(out, "{sign}{name}{}", at.block(from(first), from(last)));
        }
    }
}
