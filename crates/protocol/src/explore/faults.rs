//! What can go wrong in hardware.
use std::collections::BTreeSet;

use stochc_ir::table::{RoleId, Tables};
use stochc_ir::{Cell, Face};

use super::expected::ProgramGoals;

/// Faults that an exploration brings about, in every place and at every time; default: none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Faults {
    /// Times that *each* transfer of a message from a block to its neighbour may be lost: the
    /// message itself, or the acknowledgement alone.
    pub lost: u8,
    /// Whether a sender that hears no acknowledgement sends again; default: yes, as in a run.
    pub sent_again: bool,
    /// Blocks that die while they are anchored: they neither act nor pass anything on, and hold
    /// what they hold.
    pub dead: u8,
    /// Blocks that dock on a face of the structure that is not on.
    pub strays: u8,
    /// Whether a stray cannot be shaken off; default: it can, by switching its face off.
    pub stuck: bool,
    /// Blocks that are mistaken about how they sit: by which of their own faces they were captured,
    /// or how they are turned about it.
    pub mistaken: u8,
}

impl Default for Faults {
    fn default() -> Faults {
        Faults {
            lost: 0,
            sent_again: true,
            dead: 0,
            strays: 0,
            stuck: false,
            mistaken: 0,
        }
    }
}

/// Who the faults strike. Each choice is explored for itself; in it, a fault may strike at any
/// time, or never.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct FaultChoice {
    /// The blocks in these roles die.
    pub dead: Vec<RoleId>,
    /// Strays come to these cells.
    pub strays: Vec<Cell>,
    /// The blocks in these roles are mistaken from their capture on.
    pub mistaken: Vec<RoleId>,
}

impl Faults {
    /// Whether there are any.
    pub fn is_none(&self) -> bool {
        self.lost == 0 && self.dead == 0 && self.strays == 0 && self.mistaken == 0
    }

    /// Every choice of those who are struck: in turn, so that few have to be kept.
    pub(super) fn choices(&self, tables: &Tables, expected: &ProgramGoals) -> Vec<FaultChoice> {
        // The plate is one solid body; only what is captured can be struck.
        let roles: Vec<RoleId> = (0..tables.roles.len() as u32)
            .map(RoleId)
            .filter(|role| tables.roles[role.0 as usize].seed.is_none())
            .collect();
        let cells = if self.strays > 0 {
            around(tables, expected)
        } else {
            Vec::new()
        };
        let mut choices = Vec::new();
        for dead in subsets(&roles, self.dead) {
            for strays in subsets(&cells, self.strays) {
                for mistaken in subsets(&roles, self.mistaken) {
                    choices.push(FaultChoice {
                        dead: dead.clone(),
                        strays: strays.clone(),
                        mistaken,
                    });
                }
            }
        }
        choices
    }
}

/// The cells above the plate where a block may sit at some time, or beside which one may.
fn around(tables: &Tables, expected: &ProgramGoals) -> Vec<Cell> {
    let seeds = tables.seeds().map(|(_, cell)| cell);
    let built = expected.phases.iter().flat_map(|stage| stage.cells.iter());
    let own: BTreeSet<Cell> = seeds.chain(built.copied()).collect();
    let beside = own.iter().flat_map(|cell| {
        let faces: &[Face] = if cell.z == 0 { &[Face::Up] } else { &Face::ALL };
        faces.iter().filter_map(|&face| cell.across(face))
    });
    let cells: BTreeSet<Cell> = beside.filter(|cell| cell.z >= 1).collect();
    cells.into_iter().collect()
}

/// All subsets of up to `most` members, the empty one first.
fn subsets<T: Clone>(all: &[T], most: u8) -> Vec<Vec<T>> {
    let mut sets = vec![Vec::new()];
    if most == 0 {
        return sets;
    }
    for (i, first) in all.iter().enumerate() {
        for mut rest in subsets(&all[i + 1..], most - 1) {
            rest.insert(0, first.clone());
            sets.push(rest);
        }
    }
    sets
}
