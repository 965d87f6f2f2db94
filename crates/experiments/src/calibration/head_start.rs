//! Observation of head starts: early captures of blocks that were released near an open face.
use std::collections::BTreeMap;

use stochc_estimate::{HeadStart, relative};

use super::observation::{History, LATELY, NEAR, WaitingFace};

/// Number of ticks after a release until a capture of the released block is no longer early. After
/// that, the block counts as any other free block.
const LATEST: u64 = 2 * LATELY;

/// Smallest number of releases for estimating a head start.
const MIN: u32 = 10;

/// Largest delay of a face that opens shortly after the release \[ticks\]. Messages that take no
/// time arrive within one tick.
const A_MOMENT: u64 = 2;

/// Number of releases, number of early captures, and sum of their times. The key states whether the
/// face opened late, and the position of the block relative to the open cell ([`relative`]).
#[derive(Debug, Default)]
pub(super) struct HeadStartTally(BTreeMap<(bool, u32, i32), (u32, u32, u64)>);

impl HeadStartTally {
    pub fn add(&mut self, history: &History) {
        let released = || history.moves.iter().filter(|it| !it.came);
        for it in released() {
            // Faces that are open, or that open with the release or shortly after.
            let open =
                |wait: &&WaitingFace| wait.since <= it.tick + A_MOMENT && wait.until > it.tick;
            for wait in history.waits.iter().filter(open) {
                let Some((squared, before)) = relative(wait.cell, wait.direction, it.cell)
                    .filter(|(squared, _)| *squared <= NEAR)
                else {
                    continue;
                };
                let late = wait.since > it.tick;
                if late && squared > 0 {
                    continue;
                }
                let ticks = wait.until - it.tick.max(wait.since);
                let docked = wait.captured == Some(it.body) && ticks <= LATEST;
                // Another block that was released at the same time was captured first.
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

    /// Returns the probability and the mean time of early captures, for each position of the
    /// released block.
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
