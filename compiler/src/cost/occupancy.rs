//! Which cells are full while a phase goes on.
use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};
use stochc_ir::Cell;

use super::phase_events::PhaseEvent;

/// When a cell is full, in levels of the phase.
#[derive(Clone, Copy, Debug)]
struct Stay {
    since: u32,
    /// Its last level.
    until: u32,
}

/// The cells of a structure that are full at some time of a phase.
#[derive(Debug, Default)]
pub struct Occupancy {
    stays: FxHashMap<Cell, SmallVec<[Stay; 1]>>,
}

impl Occupancy {
    /// Begins a phase with these events, in source order.
    pub fn begin(&mut self, events: &[PhaseEvent]) {
        for event in events.iter().filter(|event| !event.is_release()) {
            let stays = self.stays.entry(event.cell).or_default();
            stays.push(Stay {
                since: event.level,
                until: u32::MAX,
            });
        }
        for event in events {
            let Some(since) = event.releases_since else {
                continue;
            };
            let stays = self.stays.get_mut(&event.cell).into_iter().flatten();
            for stay in stays.filter(|stay| stay.since == since) {
                stay.until = event.level;
            }
        }
    }

    /// Whether a block is in a cell when the captures of a level wait; `with_mates`: those of the same level count as well.
    pub fn is_full(&self, cell: Cell, level: u32, with_mates: bool) -> bool {
        let stays = self.stays.get(&cell).into_iter().flatten();
        let mut stays = stays.filter(|stay| level <= stay.until);
        stays.any(|stay| stay.since < level || (with_mates && stay.since == level))
    }

    /// Ends the phase: what is left was there before the next one.
    pub fn end(&mut self, events: &[PhaseEvent]) {
        for event in events {
            let Some(stays) = self.stays.get_mut(&event.cell) else {
                continue;
            };
            match stays.iter().any(|stay| stay.until == u32::MAX) {
                true => {
                    *stays = smallvec![Stay {
                        since: 0,
                        until: u32::MAX,
                    }];
                }
                false => drop(self.stays.remove(&event.cell)),
            }
        }
    }
}
