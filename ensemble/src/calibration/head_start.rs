//! What blocks do that are let go near an open face.
use std::collections::BTreeMap;

use stochc_rates::{FORGOTTEN, HeadStart, relative};

use super::observation::{History, NEAR, WaitingFace};

/// Ticks after which a block that comes back has come by chance.
const LATEST: u64 = 2 * FORGOTTEN;

/// Releases of which there have to be so many for a place to count.
const LEAST: u32 = 10;

/// By where it was from the open cell ([`relative`]): how many were let go there, how many docked, and in how many ticks together.
#[derive(Debug, Default)]
pub(super) struct HeadStarts(BTreeMap<(u32, i32), (u32, u32, u64)>);

impl HeadStarts {
    /// Takes the releases of a run into account.
    pub fn add(&mut self, history: &History) {
        let released = || history.moves.iter().filter(|it| !it.came);
        for it in released() {
            // What opens with the release, or waits already; what opens later is nearly as likely.
            let open = |wait: &&WaitingFace| wait.since <= it.tick + 1 && wait.until > it.tick;
            for wait in history.waits.iter().filter(open) {
                let Some(place) =
                    relative(wait.cell, wait.way, it.cell).filter(|(squared, _)| *squared <= NEAR)
                else {
                    continue;
                };
                let ticks = wait.until - it.tick.max(wait.since);
                let docked = wait.captured == Some(it.body) && ticks <= LATEST;
                // Another that was let go with it was faster.
                let beaten = ticks <= LATEST
                    && released().any(|other| {
                        other.body != it.body
                            && other.tick == it.tick
                            && wait.captured == Some(other.body)
                    });
                if docked || !beaten {
                    let (all, those, together) = self.0.entry(place).or_default();
                    *all += 1;
                    *those += u32::from(docked);
                    *together += if docked { ticks } else { 0 };
                }
            }
        }
    }

    /// What is known of them.
    pub fn summary(&self) -> Vec<HeadStart> {
        let known = self
            .0
            .iter()
            .filter(|(_, (all, docked, _))| *all >= LEAST && *docked > 0);
        known
            .map(
                |(&(squared_distance, before), &(all, docked, ticks))| HeadStart {
                    squared_distance,
                    before,
                    probability: f64::from(docked) / f64::from(all),
                    ticks: ticks as f64 / f64::from(docked),
                },
            )
            .collect()
    }
}
