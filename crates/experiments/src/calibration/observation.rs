//! Waiting times of a run, split into intervals of constant surroundings.
use std::collections::BTreeSet;

use stochc_estimate::{Neighbourhood, Surroundings, around, density_in, relative, rivalry, sees};
use stochc_ir::record::{BondRecord, RunRecord};
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, Face};

/// Largest squared distance of a release with a head start \[block lengths^2\].
pub(super) const NEAR: u32 = 8;

/// Number of ticks after which a release has no effect.
pub(super) const LATELY: u64 = 150;

/// Largest time that a face is observed, as a multiple of the median waiting time. If waiting times
/// are exponential, only one in 65,536 is longer.
const LONGEST: f64 = 16.0;

/// History of a run, in order of time.
#[derive(Debug)]
pub(super) struct History {
    /// Arrivals and departures of blocks in cells.
    pub moves: Vec<Move>,
    pub waits: Vec<WaitingFace>,
}

/// Arrival of a block in a cell, or departure from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move {
    pub tick: u64,
    pub cell: Cell,
    pub body: u32,
    pub came: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct WaitingFace {
    pub cell: Cell,
    pub direction: Face,
    pub since: u64,
    pub until: u64,
    /// Number of the captured block. `None` if the run ended before a capture.
    pub captured: Option<u32>,
}

impl History {
    pub fn from_record(record: &RunRecord) -> History {
        let mut moves: Vec<Move> = Vec::new();
        let mut waits = Vec::new();
        for bond in record.all_bonds() {
            moves.push(Move {
                tick: bond.docked,
                cell: bond.cell,
                body: bond.body,
                came: true,
            });
            waits.push(WaitingFace {
                cell: bond.cell,
                direction: bond.face,
                since: bond.magnetized,
                until: bond.docked,
                captured: Some(bond.body),
            });
        }
        for (wait, until) in record.all_waiting() {
            waits.push(WaitingFace {
                cell: wait.cell,
                direction: wait.face,
                since: wait.magnetized,
                until,
                captured: None,
            });
        }
        let bonds: Vec<&BondRecord> = record.all_bonds().collect();
        for release in record.all_releases() {
            let held = bonds
                .iter()
                .rev()
                .find(|bond| bond.body == release.body && bond.docked <= release.tick);
            if let Some(bond) = held {
                moves.push(Move {
                    tick: release.tick,
                    cell: bond.cell,
                    body: release.body,
                    came: false,
                });
            }
        }
        moves.sort_by_key(|it| (it.tick, it.came));
        waits.sort_by_key(|it| (it.since, it.cell, it.direction as u8));
        History { moves, waits }
    }
}

impl WaitingFace {
    /// Returns the squared distance of a cell from the open cell \[block lengths^2\], or `None` on
    /// overflow.
    fn squared_distance(&self, cell: Cell) -> Option<u32> {
        relative(self.cell, self.direction, cell).map(|(squared, _)| squared)
    }
}

/// Part of a waiting time with constant surroundings.
#[derive(Clone, Copy, Debug)]
pub(super) struct WaitInterval {
    /// Number of the calibration program.
    pub structure: usize,
    pub surroundings: Surroundings,
    /// Start of the interval, in ticks since the face was switched on.
    pub from: f64,
    /// End of the interval, in ticks since the face was switched on.
    pub to: f64,
    /// Whether the interval ended with the capture.
    pub captured: bool,
}

/// All intervals of waiting times that a calibration observes.
#[derive(Debug)]
pub(super) struct Observations {
    pub intervals: Vec<WaitInterval>,
    pub highest: i32,
    pub least_open: f64,
    pub least_free: f64,
}

impl Default for Observations {
    fn default() -> Observations {
        Observations {
            intervals: Vec::new(),
            highest: 0,
            least_open: 1.0,
            least_free: 1.0,
        }
    }
}

impl Observations {
    pub fn captures(&self) -> u64 {
        self.intervals
            .iter()
            .filter(|interval| interval.captured)
            .count() as u64
    }

    /// Returns the time limit of observed waiting times \[ticks\]. `None` without captures.
    pub fn longest_wait(&self) -> Option<f64> {
        let mut waits: Vec<f64> = (self.intervals.iter())
            .filter(|interval| interval.captured)
            .map(|interval| interval.to)
            .collect();
        waits.sort_unstable_by(f64::total_cmp);
        waits.get(waits.len() / 2).map(|median| median * LONGEST)
    }

    /// Returns the intervals, cut at a time limit. Waiting times above the limit are very probably
    /// jams, which the rate model does not include.
    ///
    /// The limit is the same for all faces, so it causes no bias.
    pub fn without_jams(&self) -> Vec<WaitInterval> {
        let last = self.longest_wait().unwrap_or(f64::INFINITY);
        let watched = self
            .intervals
            .iter()
            .filter(|interval| interval.from < last);
        watched
            .map(|interval| WaitInterval {
                to: interval.to.min(last),
                captured: interval.captured && interval.to <= last,
                ..*interval
            })
            .collect()
    }

    /// Adds the waiting times of a run of the program `structure`. Skips faces near a release,
    /// because the released block may return.
    pub fn add(&mut self, structure: usize, history: &History, profile: &[f64], scene: &Scene) {
        for wait in &history.waits {
            let disturbed = history.moves.iter().any(|it| {
                let lately = it.tick + LATELY > wait.since && it.tick < wait.until;
                !it.came
                    && lately
                    && wait
                        .squared_distance(it.cell)
                        .is_some_and(|squared| squared <= NEAR)
            });
            if !disturbed {
                let density = density_in(profile, wait.cell.z);
                self.follow(structure, history, wait, density, scene);
            }
        }
    }

    /// Adds a waiting time, as one interval for each period with constant surroundings.
    fn follow(
        &mut self,
        structure: usize,
        history: &History,
        wait: &WaitingFace,
        density: f64,
        scene: &Scene,
    ) {
        let count = scene.free.count;
        let rivals: Vec<&WaitingFace> = (history.waits.iter())
            .filter(|other| other.since < wait.until && other.until > wait.since)
            .filter(|other| {
                rivalry((wait.cell, wait.direction), (other.cell, other.direction)).is_some()
            })
            .collect();
        let within = |tick: &u64| *tick > wait.since && *tick < wait.until;
        let mut cuts: Vec<u64> = (history.moves.iter())
            .filter(|it| sees(wait.cell, it.cell))
            .map(|it| it.tick)
            .chain(rivals.iter().flat_map(|rival| [rival.since, rival.until]))
            .filter(within)
            .chain([wait.since, wait.until])
            .collect();
        cuts.sort_unstable();
        cuts.dedup();
        let (mut full, mut moved, mut free) = (BTreeSet::new(), 0, count);
        for pair in cuts.windows(2) {
            let [from, to] = *pair else { continue };
            while let Some(it) = history.moves.get(moved).filter(|it| it.tick <= from) {
                moved += 1;
                if it.came {
                    full.insert(it.cell)
                } else {
                    full.remove(&it.cell)
                };
                free = if it.came {
                    free.saturating_sub(1)
                } else {
                    free + 1
                };
            }
            let open = |cell: Cell| {
                let mut waiting = rivals
                    .iter()
                    .filter(|it| it.since <= from && it.until >= to);
                waiting.find(|it| it.cell == cell).map(|it| it.direction)
            };
            let surroundings = Surroundings {
                density,
                free: f64::from(free) / f64::from(count.max(1)),
                cold: wait.since == 0,
                ..around(
                    wait.cell,
                    wait.direction,
                    Neighbourhood::new(wait.cell, |cell| full.contains(&cell)).in_world_of(scene),
                    open,
                )
            };
            let captured = wait.captured.is_some() && to == wait.until;
            if captured {
                self.highest = self.highest.max(wait.cell.z);
                self.least_open = self.least_open.min(surroundings.open);
                self.least_free = self.least_free.min(surroundings.free);
            }
            self.intervals.push(WaitInterval {
                structure,
                surroundings,
                from: (from - wait.since) as f64,
                to: (to - wait.since) as f64,
                captured,
            });
        }
    }
}
