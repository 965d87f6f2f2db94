//! The structure at the end of a run, and which of its blocks remain.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::record::RunRecord;
use stochc_ir::table::{RoleId, Tables};
use stochc_ir::{Cell, Face};
use thiserror::Error;

use crate::ExistingBlock;

/// The structure at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct ExistingStructure {
    /// Blocks above the plate by name.
    blocks: BTreeMap<String, BondedBlock>,
}

#[derive(Clone, Debug, PartialEq)]
struct BondedBlock {
    cell: Cell,
    /// Direction from its parent.
    direction: Face,
    /// Name of its parent. `None` means the plate.
    parent: Option<String>,
}

/// Existing structure to continue: blocks to keep and blocks to release.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Repair {
    /// Blocks that remain.
    pub existing: Vec<ExistingBlock>,
    /// Blocks to release.
    pub released: Vec<ExistingBlock>,
}

/// Reason why an existing structure cannot be continued.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoRepair {
    /// A block has to be released, and no message reaches it.
    #[error(
        "`{wrong}` does not belong to the shape, and cannot be released with `{name}`: `{dead}` is dead, and no message comes through it"
    )]
    Unreachable {
        /// Name of the block whose cell is outside of the shape. This is the block to release or
        /// its ancestor.
        wrong: String,
        /// Block to release.
        name: String,
        /// Name of the dead block. This is the block to release or its ancestor.
        dead: String,
    },
    /// The structure is complete.
    #[error("nothing is missing")]
    Complete,
    /// The structure is complete, except that one block has to be released.
    #[error("nothing is missing, but one block must be released")]
    OneTooMany,
    /// The structure is complete, except that several blocks must be released.
    #[error("nothing is missing, but {0} blocks must be released")]
    TooMany(usize),
}

impl ExistingStructure {
    /// Returns the structure at the end of a run.
    pub fn from_record(tables: &Tables, record: &RunRecord) -> ExistingStructure {
        // Releases come before captures of the same tick, because a name is released before it is
        // reused.
        let captures = record
            .all_bonds()
            .map(|bond| (bond.docked, 1, Some(bond), bond.child));
        let releases = record.all_releases().map(|it| (it.tick, 0, None, it.child));
        let mut events: Vec<_> = captures.chain(releases).collect();
        events.sort_by_key(|&(tick, kind, ..)| (tick, kind));
        let mut there = BTreeMap::new();
        for (.., bond, child) in events {
            match bond {
                Some(bond) => there.insert(child, bond),
                None => there.remove(&child),
            };
        }
        let name = |role: RoleId| tables.roles[role.0 as usize].name.clone();
        let place = |role: RoleId| {
            let seed = tables.roles[role.0 as usize].seed;
            seed.or_else(|| there.get(&role).map(|bond| bond.cell))
        };
        let blocks = there.iter().filter_map(|(&role, bond)| {
            let from = place(bond.parent)?;
            let direction = Face::ALL
                .into_iter()
                .find(|&direction| from.across(direction) == Some(bond.cell))?;
            let parent = there.contains_key(&bond.parent).then(|| name(bond.parent));
            let block = BondedBlock {
                cell: bond.cell,
                direction,
                parent,
            };
            Some((name(role), block))
        });
        ExistingStructure {
            blocks: blocks.collect(),
        }
    }

    /// Returns the names of the blocks.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.blocks.keys().map(String::as_str)
    }

    /// Returns the blocks to keep and to release. A block is released if its cell, or the cell of
    /// an ancestor, is not in `requested`. A block can capture unless it or an ancestor is in `dead`,
    /// because dead blocks pass on no messages.
    ///
    /// # Errors
    /// If a block to release is dead or has a dead ancestor.
    pub fn repair(&self, requested: &[Cell], dead: &BTreeSet<&str>) -> Result<Repair, NoRepair> {
        let requested: BTreeSet<Cell> = requested.iter().copied().collect();
        let mut repair = Repair::default();
        for (name, block) in &self.blocks {
            let line: Vec<(&str, &BondedBlock)> = self.line(name).collect();
            let cut = line.iter().find(|(name, _)| dead.contains(name));
            let is_wrong = |(_, block): &(&str, &BondedBlock)| !requested.contains(&block.cell);
            let existing = ExistingBlock {
                cell: block.cell,
                direction: block.direction,
                can_capture: cut.is_none(),
            };
            match (line.iter().find(|it| is_wrong(it)), cut) {
                (None, _) => repair.existing.push(existing),
                (Some(_), None) => repair.released.push(existing),
                (Some((wrong, _)), Some((cut, _))) => {
                    return Err(NoRepair::Unreachable {
                        wrong: (*wrong).to_owned(),
                        name: name.clone(),
                        dead: (*cut).to_owned(),
                    });
                }
            }
        }
        Ok(repair)
    }

    /// Returns a block and its ancestors up to the plate.
    fn line(&self, name: &str) -> impl Iterator<Item = (&str, &BondedBlock)> {
        let at = |name: &str| {
            let (name, block) = self.blocks.get_key_value(name)?;
            Some((name.as_str(), block))
        };
        let line =
            std::iter::successors(at(name), move |(_, block)| at(block.parent.as_deref()?));
        line.take(self.blocks.len())
    }
}
