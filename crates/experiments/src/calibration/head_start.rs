//! What blocks do that are let go near an open face.
use std::collections::BTreeMap;

use stochc_estimate::{HeadStart, relative};

use super::observation::{History, LATELY, NEAR, WaitingFace};

/// Ticks after which a block that comes back has come by chance.
const LATEST: u64 = 2 * LATELY;

/// Releases of which there have to be so many for a place to count.
const MIN: u32 = 10;

/// Ticks after which a face is no longer a moment late: messages that take no time are there in one.
const A_MOMENT: u64 = 2;

/// By whether the face was late, and where the block was from the open cell ([`relative`]): how many were let go there, how many docked,
/// and in how many ticks together.
#[derive(Debug, Default)]
pub(super) struct HeadStartTally(BTreeMap<(bool, u32, i32), (u32, u32, u64)>);

impl HeadStartTally {
    /// Takes the releases of a run into account.
    pub fn add(&mut self, history: &History) {
        let released = || history.moves.iter().filter(|it| !it.came);
        for it in released() {
            // What opens with the release or a moment later, or waits already.
            let open =
                |wait: &&WaitingFace| wait.since <= it.tick + A_MOMENT && wait.until > it.tick;
            for wait in history.waits.iter().filter(open) {
                let Some((squared, before)) =
                    relative(wait.cell, wait.way, it.cell).filter(|(squared, _)| *squared <= NEAR)
                else {
                    continue;
                };
                let late = wait.since > it.tick;
                if late && squared > 0 {
                    continue;
                }
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
                    let (all, those, together) = self.0.entry((late, squared, before)).or_default();
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
            .filter(|(_, (all, docked, _))| *all >= MIN && *docked > 0);
        known
            .map(
                |(&(late, squared_distance, before), &(all, docked, ticks))| HeadStart {
                    squared_distance,
                    before,
                    probability: f64::from(docked) / f64::from(all),
                    ticks: ticks as f64 / f64::from(docked),
                    late,
                },
            )
            .collect()
    }
}
