//! Baseline plans without a search, for comparison. They may be faster, and they may jam.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use stochc_ir::Face;

use crate::space::sites::{NONE, Sites};
use crate::target::hardware::Hardware;
use crate::timing::precedence::Waiting;
use crate::timing::rate_law::{CellState, Moment, RateLaw};
use crate::timing::schedule::Schedule;

/// Plan without a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Baseline {
    /// Blocks one by one, along a walk through the shape.
    Chain,
    /// All faces at once, by the shortest paths from the plate.
    AtOnce,
    /// All faces of a layer at once, layer by layer.
    Layers,
    /// Blocks one by one, the nearest to the plate first.
    Nearest,
}

impl Baseline {
    /// All baselines.
    pub const ALL: [Baseline; 4] = [
        Baseline::Chain,
        Baseline::AtOnce,
        Baseline::Layers,
        Baseline::Nearest,
    ];

    /// Returns a short description.
    pub fn words(self) -> &'static str {
        match self {
            Baseline::Chain => "one block at a time, along a walk",
            Baseline::AtOnce => "everything at once",
            Baseline::Layers => "layer by layer",
            Baseline::Nearest => "one block at a time, the nearest to the plate first",
        }
    }

    /// Returns a spanning tree from the plate, parents first. Each entry is a site, the direction
    /// from its parent, and its stage. A stage is a layer, or a number of steps from the plate.
    fn tree(self, sites: &Sites<'_>) -> Vec<(u32, Face, u32)> {
        let height = |site: u32| sites.cell(site).z as u32;
        let stage = |before: u32, site: u32| match self {
            Baseline::Layers => before.max(height(site)),
            Baseline::Chain | Baseline::AtOnce | Baseline::Nearest => before + 1,
        };
        let feet = (0..sites.len() as u32).filter(|&site| sites.is_on_seed(site));
        let mut added = vec![false; sites.len()];
        let mut tree = Vec::with_capacity(sites.len());
        // The chain visits the latest site first; the others visit the earliest stage first.
        let mut found = 0_u64;
        let mut entry = |stage: u32, site: u32, direction: Face| {
            found += 1;
            let urgency = match self {
                Baseline::Chain => u64::MAX - found,
                Baseline::AtOnce | Baseline::Layers | Baseline::Nearest => u64::from(stage),
            };
            Reverse((urgency, site, direction as u8, stage))
        };
        let mut open: BinaryHeap<_> = feet.map(|foot| entry(1, foot, Face::Up)).collect();
        while let Some(Reverse((_, site, direction, at))) = open.pop() {
            if std::mem::replace(&mut added[site as usize], true) {
                continue;
            }
            tree.push((site, Face::ALL[usize::from(direction)], at));
            for direction in Face::ALL {
                let next = sites.next(site, direction);
                if next != NONE && !added[next as usize] {
                    open.push(entry(stage(at, next), next, direction));
                }
            }
        }
        tree
    }

    /// Returns the opening order and the dependencies.
    pub fn schedule(
        self,
        sites: &Sites<'_>,
        hardware: Hardware,
        waits: &RateLaw<'_>,
    ) -> (Schedule, Waiting) {
        let tree = self.tree(sites);
        let count = sites.len();
        let mut schedule = Schedule {
            order: tree.iter().map(|&(site, ..)| site).collect(),
            ..Schedule::empty(count)
        };
        let mut before: Vec<Vec<u32>> = vec![Vec::new(); count];
        let (mut first, mut last) = (0, 0..0);
        for (i, &(site, direction, stage)) in tree.iter().enumerate() {
            schedule.rank[site as usize] = i as u32;
            schedule.direction[site as usize] = direction;
            before[i].extend(schedule.held(sites, site));
            before[i].extend(schedule.turn(sites, hardware, site));
            match self {
                Baseline::AtOnce => {}
                Baseline::Chain | Baseline::Nearest => {
                    before[i].extend(i.checked_sub(1).map(|i| i as u32))
                }
                Baseline::Layers => {
                    if i > 0 && stage > tree[i - 1].2 {
                        (last, first) = (first..i as u32, i as u32);
                    }
                    before[i].extend(last.clone());
                }
            }
            before[i].sort_unstable();
            before[i].dedup();
        }
        let waiting = Waiting { before };
        schedule.set_means(sites, hardware, waits, &waiting);
        (schedule, waiting)
    }
}

impl Schedule {
    /// Sets the mean waiting times of sites, as if all captures took equally long.
    pub fn set_means(
        &mut self,
        sites: &Sites<'_>,
        hardware: Hardware,
        waits: &RateLaw<'_>,
        waiting: &Waiting,
    ) {
        let first = self.first_phase;
        // Sites of the second phase are absent in the first and keep their waiting times. Existing
        // blocks do not wait.
        let mut level: Vec<u32> = vec![u32::MAX; sites.len()];
        let standing = sites.existing_count();
        for &site in &self.order[..standing] {
            level[site as usize] = 0;
        }
        let captures = self.order.iter().copied().zip(&waiting.before);
        let captures: Vec<_> = captures.take(first).skip(standing).collect();
        for &(site, before) in &captures {
            let others = before
                .iter()
                .map(|&other| level[self.order[other as usize] as usize] + 1);
            level[site as usize] = others.max().unwrap_or(1);
        }
        let mut earlier = vec![0u32; sites.len() + 2];
        let levels = level.iter().filter(|level| **level != u32::MAX);
        levels.for_each(|&level| earlier[level as usize + 1] += 1);
        for i in 1..earlier.len() {
            earlier[i] += earlier[i - 1];
        }
        for (site, before) in captures {
            let here = level[site as usize];
            let bound = f64::from(earlier[here as usize]) / f64::from(hardware.free.max(1));
            let moment = Moment {
                free: 1.0 - bound,
                is_first: here == 1 && sites.target.is_at_rest(),
            };
            let mean = waits.mean(
                sites.cell(site),
                self.direction[site as usize],
                moment,
                |near| match sites.at(near) {
                    near if near == NONE || near == site => CellState::Empty,
                    near => match level[near as usize].cmp(&here) {
                        std::cmp::Ordering::Less => CellState::Full,
                        std::cmp::Ordering::Equal => {
                            CellState::Awaited(self.direction[near as usize])
                        }
                        std::cmp::Ordering::Greater => CellState::Empty,
                    },
                },
            );
            self.mean[site as usize] = mean as f32;
            let start = before
                .iter()
                .map(|&other| self.end[self.order[other as usize] as usize]);
            self.end[site as usize] = start.fold(0.0, f32::max) + mean as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use stochc_ir::Cell;
    use stochc_ir::table::Plate;

    use super::*;
    use crate::Target;

    #[test]
    fn every_block_has_an_earlier_parent() {
        let cells = (0..27).map(|i| Cell::new(i % 3, i / 3 % 3, i / 9 + 1));
        let plate = Plate { width: 3, depth: 3 };
        let target = Target::new(cells.collect(), plate, None, 100).unwrap();
        let sites = Sites::new(&target);
        let hardware = Hardware {
            faces: 1,
            attracts_always: false,
            free: 100,
        };
        for baseline in Baseline::ALL {
            let (schedule, waiting) = baseline.schedule(&sites, hardware, &RateLaw::new(None));
            assert_eq!(schedule.order.len(), 27);
            let mut height = 0;
            for (i, (&site, before)) in schedule.order.iter().zip(&waiting.before).enumerate() {
                let i = i as u32;
                assert!(before.iter().all(|&other| other < i));
                let held = schedule.held(&sites, site);
                assert!(held.map_or(sites.is_on_seed(site), |held| before.contains(&held)));
                assert!(schedule.mean[site as usize] > 0.0);
                let is_serial = matches!(baseline, Baseline::Chain | Baseline::Nearest);
                assert!(!is_serial || i == 0 || before.contains(&(i - 1)));
                if baseline == Baseline::Layers {
                    assert!(sites.cell(site).z >= height);
                    height = sites.cell(site).z;
                }
            }
        }
    }
}
