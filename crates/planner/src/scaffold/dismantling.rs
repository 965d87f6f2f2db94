//! What happens once all that is temporary is there.
use rustc_hash::{FxHashMap, FxHashSet};
use serde::Serialize;
use stochc_ir::{Cell, Face};

use super::{MastPiece, Scaffolding};
use crate::capture::Capture;

/// The second phase of a plan with scaffolds.
#[derive(Clone, Debug, Serialize)]
pub struct Dismantling {
    /// Blocks that are handed over, each behind the one that holds it then.
    pub hand_overs: Vec<HandOver>,
    /// Masts.
    pub masts: Vec<Mast>,
    /// Whether masts stay where they are.
    pub are_kept: bool,
    /// The captures that follow, in the order in which their faces open if all waits are as long as their means.
    pub captures: Vec<Capture>,
}

/// A block that is let go and taken at once by another one beside it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HandOver {
    /// Where it is, and stays.
    pub cell: Cell,
    /// From the block that takes it.
    pub way: Face,
    /// The cell of the capture of the same phase before which it is not let go.
    pub after: Option<Cell>,
}

/// A column of temporary blocks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mast {
    /// Its place on the plate, as (x, y).
    pub foot: (i32, i32),
    /// Its blocks.
    pub height: i32,
    /// The cells that have been handed over when it is taken down.
    pub after: Vec<Cell>,
}

impl Dismantling {
    /// Of scaffolds, with the captures that follow.
    pub fn new(scaffolding: &Scaffolding, captures: Vec<Capture>, are_kept: bool) -> Dismantling {
        // What is captured in this phase, and the last hand-over to each block.
        let mut new: FxHashSet<Cell> = captures.iter().map(|capture| capture.cell).collect();
        let mut last: FxHashMap<Cell, Cell> = FxHashMap::default();
        let mut hand_overs = Vec::new();
        for piece in in_order(scaffolding) {
            for (cell, way) in piece.handed_over() {
                let holder = cell.across(way.opposite());
                let holder = holder.expect("it is a cell of the target");
                let before = last.insert(holder, cell);
                hand_overs.push(HandOver {
                    cell,
                    way,
                    after: before.or_else(|| new.contains(&holder).then_some(holder)),
                });
                new.insert(cell);
            }
        }
        let masts = scaffolding.masts().into_iter().map(|(foot, height)| {
            let pieces = scaffolding.pieces.iter();
            let held = pieces.filter(|piece| piece.foot == foot);
            Mast {
                foot,
                height,
                after: held.map(|piece| piece.cells[0]).collect(),
            }
        });
        Dismantling {
            hand_overs,
            masts: masts.collect(),
            are_kept,
            captures,
        }
    }
}

/// The pieces, each behind the one that it joins.
fn in_order(scaffolding: &Scaffolding) -> Vec<&MastPiece> {
    let mut left: Vec<&MastPiece> = scaffolding.pieces.iter().collect();
    let mut order = Vec::new();
    while !left.is_empty() {
        let is_last =
            |piece: &&MastPiece| !left.iter().any(|other| other.cells.contains(&piece.join));
        let (next, rest): (Vec<&MastPiece>, Vec<&MastPiece>) =
            left.iter().copied().partition(is_last);
        // Pieces that joined each other in a circle would hold nothing.
        assert!(!next.is_empty(), "pieces hang on the target in the end");
        order.extend(next);
        left = rest;
    }
    order
}
