//! A world of rates: when a face captures follows from what is around it, and nothing moves.
//!
//! Each open face has a hazard by the law of [`stochc_rates`]; the faces race each other (the next-reaction method of M. A. Gibson and
//! J. Bruck 2000, with hazards that change with the age of a face). A tick in which nothing docks is skipped.
mod agenda;
mod race;

use rustc_hash::FxHashMap;
use stochc_ir::scene::{Bond, Scene};
use stochc_ir::table::Tables;
use stochc_ir::{Cell, Face};
use stochc_protocol::{BlockFace, Docking};
use stochc_rates::{FORGOTTEN, Neighbourhood, Rates, Rivals, Surroundings, Wait, feature_cells};

use super::lattice::{Changes, FaceChange, LatticeStructure, site};
use super::{Fault, SceneError, World};
use crate::counter_rng::{DrawsAhead, Stream, below, unit};
use agenda::{CaptureQueue, ScheduledCapture};
use race::{OpenFace, Race, Slot, Slots};

/// A world of cells in which waits are drawn.
#[derive(Clone, Debug)]
pub struct RateWorld<'r> {
    tick: u64,
    rates: &'r Rates,
    lattice: LatticeStructure,
    race: Race,
    agenda: CaptureQueue,
    /// Blocks released lately: when, from which cell, and which.
    released: Vec<(u64, Cell, u32)>,
    /// Waits that have been asked for, of a gas with as many free blocks as at the beginning.
    waits: FxHashMap<Seen, Wait>,
    draws: DrawsAhead,
    /// Draws so far.
    drawn: u64,
}

stochc_ir::state! {
    () RateWorld<'_>;
    values: tick, lattice, race, agenda, released, drawn;
    parts: ;
    // Of waits it only saves working them out again.
    same: rates, waits, draws
}

/// All that a wait depends on, but for the number of free blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Seen {
    near: Neighbourhood,
    layer: i32,
    way: Face,
    rivals: Rivals,
    is_cold: bool,
}

/// Waits that are kept, at most.
const KEPT: usize = 1 << 16;

impl<'r> RateWorld<'r> {
    /// The world of a program in a scene, by rates that were measured there; its chance is that of (`seed`, `run`).
    ///
    /// # Errors
    /// [`SceneError::NoRates`], and [`SceneError::NotInModel`] for what the law does not know.
    pub fn new(
        tables: &Tables,
        scene: &Scene,
        rates: &'r [Rates],
        seed: u64,
        run: u64,
    ) -> Result<RateWorld<'r>, SceneError> {
        if let Some(error) = RateWorld::refusal_of(tables, scene) {
            return Err(error);
        }
        let given = rates.iter().find(|rates| rates.are_of(scene));
        let rates = given.or_else(|| Rates::built_in(scene));
        let rates = rates.ok_or(SceneError::NoRates)?;
        let count = scene.free.count;
        Ok(RateWorld {
            tick: 0,
            lattice: LatticeStructure::new(tables, count),
            race: Race::new(count),
            agenda: CaptureQueue::default(),
            released: Vec::new(),
            waits: FxHashMap::default(),
            rates,
            draws: DrawsAhead::new(seed, run, Stream::Rate),
            drawn: 0,
        })
    }

    /// What a program or its scene has that the law does not know.
    pub fn refusal_of(tables: &Tables, scene: &Scene) -> Option<SceneError> {
        let is_aggregate = tables.aggregate.is_some();
        let of_program = is_aggregate.then(|| not_known("aggregate"));
        of_program.or_else(|| RateWorld::refusal(scene))
    }

    /// What a scene has that the law does not know.
    pub fn refusal(scene: &Scene) -> Option<SceneError> {
        let what = match &scene.bond {
            Some(Bond::Reject { .. }) => "bond by magnets that always attract",
            Some(Bond::Suction { .. }) => "bond by suction",
            None => "scene without bonds",
            Some(_) if scene.fluid.is_some() || scene.flow.is_some() => "fluid",
            Some(_) if scene.gravity.is_some() => "gravity",
            Some(_) => return None,
        };
        Some(not_known(what))
    }

    /// The next draw.
    fn draw(&mut self) -> [u32; 4] {
        self.drawn += 1;
        self.draws.block(self.drawn - 1, 0)
    }

    /// Takes in what happened to faces, and to a cell that is full now or empty.
    fn note(
        &mut self,
        changes: impl IntoIterator<Item = FaceChange>,
        filled: Option<(Cell, bool)>,
    ) {
        let mut changed = Slots::new();
        for change in changes {
            match change {
                FaceChange::Opened(face) => self.open(face, &mut changed),
                FaceChange::Closed(face) => self.race.close(face, &mut changed),
            }
        }
        if let Some((cell, is_full)) = filled {
            self.race.fill(cell, is_full, &mut changed);
        }
        self.race.sort(&mut changed);
        for slot in changed {
            self.estimate(slot);
        }
    }

    /// A face begins to wait; for how long, nobody has said yet.
    fn open(&mut self, face: usize, changed: &mut Slots) {
        let (seat, own) = site(face);
        let of = self.lattice.seats[seat];
        let Some(cell) = of.across(own) else { return };
        let way = of.orientation.to_structure(own);
        let near = self.lattice.neighbourhood(cell);
        let [threshold, ..] = self.draw();
        let left = exponential(threshold);
        let open = OpenFace::new(face, (cell, way), near, self.tick, left);
        let slot = self.race.open(open, changed);
        // Those who were let go near it are still there.
        let tick = self.tick;
        self.released.retain(|(when, ..)| tick < when + FORGOTTEN);
        for number in 0..self.released.len() {
            let (when, from, block) = self.released[number];
            let left = 1.0 - (tick - when) as f64 / FORGOTTEN as f64;
            self.head_start(slot, from, block, left);
        }
    }

    /// By chance, a block that was let go near an open face comes first.
    fn head_start(&mut self, slot: Slot, from: Cell, block: u32, left: f64) {
        let Some(face) = self.race.face(slot) else {
            return;
        };
        let opening = face.opening();
        let Some(start) = self.rates.head_start(face.cell, face.way, from) else {
            return;
        };
        let [whether, when, ..] = self.draw();
        if unit(whether) < start.probability * left {
            let time = self.tick as f64 + start.ticks * exponential(when);
            self.agenda.push(
                time,
                ScheduledCapture {
                    slot,
                    opening,
                    block: Some(block),
                },
            );
        }
    }

    /// Puts the time of a face's capture on the agenda, from what is around it now.
    fn estimate(&mut self, slot: Slot) {
        let Some(face) = self.race.face(slot) else {
            return;
        };
        let opening = face.opening();
        let mut wait = self.wait(face.cell, seen_by(face));
        wait.rate *= self.race.part();
        if let Some(time) = self.race.update(slot, self.tick, wait) {
            let entry = ScheduledCapture {
                slot,
                opening,
                block: None,
            };
            self.agenda.push(time, entry);
        }
    }

    /// The wait of a face in a gas with as many free blocks as at the beginning.
    fn wait(&mut self, cell: Cell, seen: Seen) -> Wait {
        if let Some(known) = self.waits.get(&seen) {
            return *known;
        }
        if self.waits.len() >= KEPT {
            self.waits.clear();
        }
        let alone = |_| None;
        let wait = self.rates.wait(&Surroundings {
            rivals: seen.rivals,
            cold: seen.is_cold,
            ..self.rates.surroundings(cell, seen.way, seen.near, alone)
        });
        self.waits.insert(seen, wait);
        wait
    }

    /// Estimates all faces anew where the number of free blocks has changed much.
    fn follow_free_blocks(&mut self) {
        if self.race.follow(self.lattice.free.len()) {
            for slot in self.race.all() {
                self.estimate(slot);
            }
        }
    }

    /// The next entry of the agenda that still holds, and its tick: the first boundary at or after its time.
    fn next(&mut self) -> Option<(u64, ScheduledCapture)> {
        loop {
            let (time, entry) = self.agenda.first()?;
            let holds = match entry.block {
                None => self.race.holds(entry.slot, entry.opening, time),
                Some(block) => {
                    self.race.opening(entry.slot, entry.opening).is_some()
                        && self.lattice.free.contains(block as usize)
                }
            };
            match holds {
                true => return Some((time.ceil().min(9e15) as u64, entry)),
                false => self.agenda.drop_first(),
            }
        }
    }

    /// Docks a block on an open face, unless by chance there is none.
    fn capture(&mut self, entry: ScheduledCapture, dockings: &mut Vec<Docking>) {
        let Some(face) = self.race.opening(entry.slot, entry.opening) else {
            return;
        };
        let (seat, face) = site(face.number);
        let [who, how, whether, threshold] = self.draw();
        let free = self.lattice.free.len();
        let child = match entry.block {
            Some(block) => block,
            // The hazard was that of more blocks than there are now.
            None if free == 0 || unit(whether) >= self.race.share(free) => {
                self.race.go_on(entry.slot, exponential(threshold));
                self.estimate(entry.slot);
                return;
            }
            None => self.lattice.free.select(below(who, free)) as u32,
        };
        let pose = below(how, 24) as u8;
        let docking = Docking {
            // Nobody has come into any reach.
            entries: 0,
            ..self.lattice.docking(seat, face, child, pose, self.tick)
        };
        if self.put(seat, face, &docking) {
            dockings.push(docking);
        }
    }

    /// Puts a block into the cell before a face; `false`: there is no room.
    fn put(&mut self, seat: usize, face: stochc_ir::Face, docking: &Docking) -> bool {
        let Some(cell) = self.lattice.target(seat, face) else {
            return false;
        };
        let mut changes = Changes::new();
        let tell = |change| changes.push(change);
        self.lattice.dock(seat, face, cell, docking, tell);
        self.note(changes, Some((cell, true)));
        self.follow_free_blocks();
        true
    }
}

/// What the law sees around a face.
fn seen_by(face: &OpenFace) -> Seen {
    Seen {
        near: face.near.within(feature_cells(face.way)),
        layer: face.cell.z,
        way: face.way,
        rivals: face.rivals,
        is_cold: face.since == 0,
    }
}

fn not_known(what: &'static str) -> SceneError {
    SceneError::NotInModel {
        what,
        model: "rate",
        instead: "rigid",
    }
}

/// A draw from the exponential distribution of mean 1.
fn exponential(word: u32) -> f64 {
    -libm::log(unit(word))
}

impl World for RateWorld<'_> {
    fn tick(&self) -> u64 {
        self.tick
    }

    fn magnetize(&mut self, site: BlockFace) {
        if let Some(seat) = self.lattice.seat(site.body) {
            let changes = self.lattice.magnetize(seat, site.face);
            self.note(changes, None);
        }
    }

    fn switch_off(&mut self, site: BlockFace) {
        let Some(seat) = self.lattice.seat(site.body) else {
            return;
        };
        let mut going = vec![(seat, site.face)];
        while let Some((seat, face)) = going.pop() {
            let closed = self.lattice.close(seat, face);
            self.note(closed, None);
            let mut changes = Changes::new();
            let tell = |change| changes.push(change);
            let Some(child) = self.lattice.let_go(seat, face, tell) else {
                continue;
            };
            going.extend(stochc_ir::Face::ALL.map(|face| (child, face)));
            let from = self.lattice.seats[child].cell;
            self.note(changes, Some((from, false)));
            let block = (child - self.lattice.seeds.len()) as u32;
            for slot in self.race.near(from) {
                self.head_start(slot, from, block, 1.0);
            }
            self.released.push((self.tick, from, block));
        }
        self.follow_free_blocks();
    }

    fn plant(&mut self, site: BlockFace) -> Option<Docking> {
        self.magnetize(site);
        let seat = self.lattice.seat(site.body)?;
        let (_, docking) = self.lattice.planted(seat, site.face, self.tick)?;
        self.put(seat, site.face, &docking).then_some(docking)
    }

    fn skip(&mut self, last: u64) {
        let next = self.next().map_or(u64::MAX, |(tick, _)| tick);
        // The step that comes after this one docks.
        self.tick = self.tick.max(next.saturating_sub(1).min(last));
    }

    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        self.tick += 1;
        while let Some((tick, entry)) = self.next() {
            if tick > self.tick {
                break;
            }
            self.agenda.drop_first();
            self.capture(entry, dockings);
        }
        Ok(())
    }
}
