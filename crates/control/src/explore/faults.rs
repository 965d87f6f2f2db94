//! Hardware faults that an exploration injects.
use std::collections::BTreeSet;

use stochc_ir::table::{RoleId, Tables};
use stochc_ir::{Cell, Face};

use super::expected::ProgramGoals;

/// Faults that an exploration injects at every place and time. Default: none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Faults {
    /// Largest number of losses for *each* transfer of a message. Either the message or only its
    /// acknowledgement is lost.
    pub lost: u8,
    /// Whether a sender resends a message that was not acknowledged. Default: yes, as in a run.
    pub sent_again: bool,
    /// Number of anchored blocks that fail: they no longer act or forward messages, but keep their
    /// children.
    pub dead: u8,
    /// Number of captured blocks that do not acknowledge their name. They acknowledge it later or
    /// never.
    pub silent: u8,
    /// Number of stray blocks, which are captured at faces that are off.
    pub strays: u8,
    /// Whether a stray block remains attached when its face is switched off. Default: it is
    /// rejected.
    pub stuck: bool,
    /// Number of blocks that misjudge their orientation: the touching face or the quarter turn.
    pub mistaken: u8,
}

impl Default for Faults {
    fn default() -> Faults {
        Faults {
            lost: 0,
            sent_again: true,
            dead: 0,
            silent: 0,
            strays: 0,
            stuck: false,
            mistaken: 0,
        }
    }
}

/// Blocks affected by faults. Each choice is explored separately, with faults at any time or never.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct FaultChoice {
    /// Roles whose blocks fail.
    pub dead: Vec<RoleId>,
    /// Cells of stray blocks.
    pub strays: Vec<Cell>,
    /// Roles whose blocks misjudge their orientation from their capture on.
    pub mistaken: Vec<RoleId>,
}

impl Faults {
    /// Returns whether there are no faults.
    pub fn is_none(&self) -> bool {
        let blocks = [self.dead, self.silent, self.strays, self.mistaken];
        self.lost == 0 && blocks == [0; 4]
    }

    /// Returns every choice of affected blocks, in an order that needs little memory.
    pub(super) fn choices(&self, tables: &Tables, expected: &ProgramGoals) -> Vec<FaultChoice> {
        // The plate is one solid body. Only captured blocks can be affected.
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

/// Returns the cells above the plate that may be occupied, and their neighbours.
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

/// Returns all subsets of up to `most` elements, the empty one first.
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
