//! Captures as chains of captures.
use std::fmt::Write as _;

use rustc_hash::FxHashMap;
use stochc_ir::{Cell, Face};

use super::repetition::Indices;
use crate::plan::Capture;

/// Captures one after the other, each by the block before.
#[derive(Clone, Debug)]
pub struct Statement {
    /// The places of the captures in the plan.
    captures: Vec<usize>,
    /// The cell of the first capture.
    base: Cell,
    /// The way into each cell, and how many cells on in one row.
    rows: Vec<(Face, i32)>,
    /// What the first capture waits for, in rows along an axis: the first cell and the last.
    after: Vec<(Cell, Cell)>,
    /// The place of the statement that has the capture before, of the same parent.
    pub follows: Option<usize>,
}

/// The captures of a plan as statements, in an order in which those of one parent stay in theirs.
pub fn statements(captures: &[Capture]) -> Vec<Statement> {
    let place: FxHashMap<Cell, usize> = captures
        .iter()
        .enumerate()
        .map(|(i, capture)| (capture.cell, i))
        .collect();
    let parent = |capture: &Capture| {
        let cell = capture.cell.across(capture.way.opposite())?;
        place.get(&cell).copied()
    };
    // The captures by each block, in their order.
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
        let mut statement = Statement {
            captures: vec![i],
            base: capture.cell,
            rows: vec![(capture.way, 1)],
            after: rows_of(capture.after.iter().map(|(cell, _)| *cell).collect()),
            follows: before.map(|before| within[before]),
        };
        within[i] = statements.len();
        let mut last = i;
        // Only the first capture of a chain can wait, and only the first one of a block goes on with it.
        while let Some(&next) = children[last].first()
            && captures[next].after.is_empty()
        {
            within[next] = statements.len();
            statement.captures.push(next);
            match statement.rows.last_mut() {
                Some((way, length)) if *way == captures[next].way => *length += 1,
                _ => statement.rows.push((captures[next].way, 1)),
            }
            last = next;
        }
        statements.push(statement);
    }
    statements
}

/// Cells in rows along the axis that needs the fewest.
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
    let first = all.next().expect("there are three axes");
    all.fold(
        first,
        |best, rows| if rows.len() < best.len() { rows } else { best },
    )
}

/// Whether a seed captures first, the rows, and what they wait for, seen from the base of a statement.
pub type Signature<'a> = (bool, &'a [(Face, i32)], Vec<[i32; 6]>);

impl Statement {
    /// The place of its first capture in the plan.
    pub fn first(&self) -> usize {
        self.captures[0]
    }

    /// The cell of its first capture.
    pub fn base(&self) -> Cell {
        self.base
    }

    /// The place on the plate of its seed, if a seed captures first.
    pub fn seed(&self) -> Option<(i32, i32)> {
        let is_seed = self.base.z == 1 && self.rows[0].0 == Face::Up;
        is_seed.then_some((self.base.x, self.base.y))
    }

    /// What it says, seen from its base: equal ones differ in nothing but their place.
    pub fn signature(&self) -> Signature<'_> {
        let Cell { x, y, z } = self.base;
        let after = self.after.iter().map(|(first, last)| {
            [
                first.x - x,
                first.y - y,
                first.z - z,
                last.x - x,
                last.y - y,
                last.z - z,
            ]
        });
        (self.seed().is_some(), &self.rows, after.collect())
    }

    /// Writes it with indices that count from its base.
    pub fn write(&self, out: &mut String, at: &Indices<'_>) {
        let Cell { x, y, z } = self.base;
        let [dx, dy, dz] = self.rows[0].0.normal();
        // Writing to a string cannot fail.
        let _ = match self.seed() {
            Some(_) => write!(out, "P[{}, {}]", at.x(0), at.y(0)),
            None => write!(out, "B[{}, {}, {}]", at.x(-dx), at.y(-dy), at.z(-dz)),
        };
        let mut here = Cell::new(-dx, -dy, -dz);
        for &(way, length) in &self.rows {
            let [dx, dy, dz] = way.normal();
            let step = |here: Cell, steps: i32| {
                Cell::new(
                    here.x + steps * dx,
                    here.y + steps * dy,
                    here.z + steps * dz,
                )
            };
            if length > 1 && dx + dy + dz > 0 {
                let (first, last) = (step(here, 1), step(here, length));
                let _ = write!(out, ".{way} ->> {}", at.block(first, last));
                here = last;
            } else {
                for _ in 0..length {
                    here = step(here, 1);
                    let _ = write!(out, ".{way} -> {}", at.block(here, here));
                }
            }
        }
        let from = |cell: &Cell| Cell::new(cell.x - x, cell.y - y, cell.z - z);
        for (i, (first, last)) in self.after.iter().enumerate() {
            let sign = if i == 0 { " after " } else { ", " };
            let _ = write!(out, "{sign}{}", at.block(from(first), from(last)));
        }
    }
}
