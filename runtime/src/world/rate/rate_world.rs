//! The world of the rate model.
use stochc_control::{BlockFace, Docking};
use stochc_estimate::{HeadStarts, Rates};
use stochc_ir::scene::Scene;
use stochc_ir::table::Tables;
use stochc_ir::{Cell, Face};

use super::event_queue::{EventQueue, ScheduledCapture, ScheduledHeadStart};
use super::open_face_hazards::{OpenFace, OpenFaceHazards, Slot};
use super::waits::RateModel;
use crate::counter_rng::{DrawsAhead, Stream, below, unit};
use crate::world::lattice::{
    Changes, FaceChange, LatticeStructure, bit, occupied_cells, seat_and_face,
};
use crate::world::{Fault, SceneError, World};

/// Lattice world with random waiting times.
#[derive(Clone, Debug)]
pub struct RateWorld<'r> {
    pub(super) tick: u64,
    pub(super) head_starts: HeadStarts<'r>,
    pub(super) lattice: LatticeStructure,
    pub(super) hazards: OpenFaceHazards,
    queue: EventQueue,
    /// Recently released blocks: tick, former cell and number.
    pub(super) released: Vec<(u64, Cell, u32)>,
    waits: RateModel<'r>,
    /// Slots of faces whose waiting times must be updated.
    pub(super) changed: Vec<Slot>,
    draws: DrawsAhead,
    /// Number of draws so far.
    drawn: u64,
}

stochc_ir::state! {
    () RateWorld<'_>;
    values: tick, lattice, hazards, queue, released, drawn;
    parts: ;
    // Not part of the state: `waits` is only a cache, and `changed` is empty between two calls.
    same: head_starts, waits, changed, draws
}

impl<'r> RateWorld<'r> {
    /// Returns the world of a program in a scene with calibrated rates. (`seed`, `run`) is the key
    /// of its random draws.
    ///
    /// # Errors
    ///
    /// [`SceneError::NoRates`], [`SceneError::InaccurateRates`], and [`SceneError::NotInModel`] for
    /// unsupported features.
    pub fn new(
        tables: &Tables,
        scene: &Scene,
        rates: &'r [Rates],
        seed: u64,
        run: u64,
    ) -> Result<RateWorld<'r>, SceneError> {
        if let Some(error) = RateWorld::unsupported_by(tables, scene) {
            return Err(error);
        }
        let given = rates.iter().find(|rates| rates.are_of(scene));
        let rates = given.or_else(|| Rates::built_in(scene));
        let rates = rates.ok_or(SceneError::NoRates)?;
        rates.check_accuracy()?;
        let count = scene.free.count;
        Ok(RateWorld {
            tick: 0,
            lattice: LatticeStructure::new(tables, count),
            hazards: OpenFaceHazards::new(count, occupied_cells(tables)),
            queue: EventQueue::default(),
            released: Vec::new(),
            waits: RateModel::new(rates),
            changed: Vec::new(),
            head_starts: rates.head_starts(),
            draws: DrawsAhead::new(seed, run, Stream::Rate),
            drawn: 0,
        })
    }

    /// Returns the first feature of a program or its scene that the rate model does not support.
    pub fn unsupported_by(tables: &Tables, scene: &Scene) -> Option<SceneError> {
        let is_aggregate = tables.aggregate.is_some();
        let of_program = is_aggregate.then(|| not_known("aggregate"));
        of_program.or_else(|| RateWorld::unsupported(scene))
    }

    /// Returns the first feature of a scene that the rate model does not support.
    pub fn unsupported(scene: &Scene) -> Option<SceneError> {
        let is_without = scene.bond.is_none();
        is_without.then(|| not_known("scene without bonds"))
    }

    /// Returns the random words of the next draw.
    fn draw(&mut self) -> [u32; 4] {
        self.drawn += 1;
        self.draws.block(self.drawn - 1, 0)
    }

    /// Processes the change of a face without a change of any cell.
    fn note_face(&mut self, change: FaceChange) {
        let mut changed = std::mem::take(&mut self.changed);
        match change {
            FaceChange::Opened(face) => self.open(face, &mut changed),
            FaceChange::Closed(face) => {
                if let Some((cell, direction)) = self.close(face) {
                    self.hazards.drop_rivals(cell, bit(direction), &mut changed);
                }
            }
        }
        self.estimate_all(changed);
    }

    /// Processes a cell that became occupied or empty, and the resulting changes of faces.
    fn note_cell(&mut self, cell: Cell, is_full: bool, changes: Changes) {
        let mut changed = std::mem::take(&mut self.changed);
        let mut directions = 0;
        for change in changes {
            match change {
                FaceChange::Opened(face) => self.open(face, &mut changed),
                FaceChange::Closed(face) => {
                    if let Some((towards, direction)) = self.close(face) {
                        debug_assert_eq!(towards, cell);
                        directions |= bit(direction);
                    }
                }
            }
        }
        self.hazards.fill(cell, is_full, directions, &mut changed);
        self.estimate_all(changed);
    }

    /// Updates the capture times of the faces in `changed`.
    fn estimate_all(&mut self, mut changed: Vec<Slot>) {
        self.hazards.sort(&mut changed);
        for slot in changed.drain(..) {
            self.estimate(slot);
        }
        self.changed = changed;
    }

    /// Closes a face if it was open. Returns the cell in front and its direction.
    pub(super) fn close(&mut self, face: usize) -> Option<(Cell, Face)> {
        let (seat, own) = seat_and_face(face);
        let of = self.lattice.seats[seat];
        let cell = of.across(own)?;
        let slot = self.hazards.close(face, cell)?;
        self.queue.forget(slot);
        Some((cell, of.orientation.to_structure(own)))
    }

    /// Opens a face. Its waiting time is not drawn yet.
    pub(super) fn open(&mut self, face: usize, changed: &mut Vec<Slot>) {
        let (seat, own) = seat_and_face(face);
        let of = self.lattice.seats[seat];
        let Some(cell) = of.across(own) else { return };
        let direction = of.orientation.to_structure(own);
        let near = self.lattice.neighbourhood(cell);
        let [threshold, ..] = self.draw();
        let left = exponential(threshold);
        let open = OpenFace::new(face, (cell, direction), near, self.tick, left);
        let slot = self.hazards.open(open, changed);
        // Blocks that were released recently may still be near this face.
        let tick = self.tick;
        let head_starts = self.head_starts;
        self.released
            .retain(|(when, ..)| !head_starts.are_over((tick - when) as f64));
        for number in 0..self.released.len() {
            let (when, from, block) = self.released[number];
            self.head_start(slot, from, block, tick - when);
        }
    }

    /// With some probability, schedules the capture of a block that was released nearby. `since` is
    /// the number of ticks since the release.
    fn head_start(&mut self, slot: Slot, from: Cell, block: u32, since: u64) {
        let Some(face) = self.hazards.face(slot) else {
            return;
        };
        let opening = face.opening();
        let nearby = self.head_starts.nearby(face.cell, face.direction, from);
        let Some(start) = nearby.and_then(|nearby| nearby.after(since as f64)) else {
            return;
        };
        let [whether, when, ..] = self.draw();
        if unit(whether) < start.probability {
            let time = self.tick as f64 + start.time(exponential(when));
            let start = ScheduledHeadStart {
                slot,
                opening,
                block,
            };
            self.queue.note_head_start(time, start);
        }
    }

    /// Schedules the capture of a face from its current surroundings.
    fn estimate(&mut self, slot: Slot) {
        let Some(face) = self.hazards.face(slot) else {
            return;
        };
        let mut wait = self.waits.wait(face);
        wait.rate *= self.waits.of_free(self.hazards.part());
        if let Some(earliest) = self.hazards.update(slot, self.tick, wait) {
            self.queue.note(slot, earliest);
        }
    }

    /// Updates all capture times if the hazards must be computed for another number of free blocks.
    fn follow_free_blocks(&mut self) {
        if self.hazards.follow(self.lattice.free.len()) {
            for slot in self.hazards.all() {
                self.estimate(slot);
            }
        }
    }

    /// Returns the tick of the earliest valid capture: the first tick at or after its time.
    fn next_tick(&mut self) -> Option<u64> {
        loop {
            let (time, first) = self.queue.first()?;
            let tick = boundary(time);
            if tick == u64::MAX {
                return None;
            }
            match first {
                ScheduledCapture::OfAny(slot) => {
                    if boundary(self.hazards.face(slot)?.latest()) == tick {
                        return Some(tick);
                    }
                    self.look_closer(slot)?;
                }
                ScheduledCapture::HeadStart(start) => {
                    let is_open = self.hazards.opening(start.slot, start.opening).is_some();
                    if is_open && self.lattice.free.contains(start.block as usize) {
                        return Some(tick);
                    }
                    self.queue.drop_head_start();
                }
            }
        }
    }

    /// Returns the earliest valid capture if its tick has come.
    pub(super) fn next(&mut self) -> Option<ScheduledCapture> {
        while self.next_tick()? <= self.tick {
            let (time, first) = self.queue.first()?;
            if let ScheduledCapture::OfAny(slot) = first {
                let latest = self.hazards.face(slot)?.latest();
                if time < latest && self.queue.second(slot) <= latest {
                    self.look_closer(slot)?;
                    continue;
                }
            }
            return Some(first);
        }
        None
    }

    /// Replaces the lower bound of a face's capture time in the queue by the exact time. Returns
    /// `None` if the face has no waiting time.
    fn look_closer(&mut self, slot: Slot) -> Option<()> {
        let time = self.hazards.time(slot)?;
        self.queue.put_off(slot, time);
        Some(())
    }

    /// Returns the ratio of the hazard with `free` free blocks to the computed hazard.
    fn share(&self, free: u32) -> f64 {
        let hazards = &self.hazards;
        self.waits.of_free(hazards.part_of(free)) / self.waits.of_free(hazards.part())
    }

    /// Captures a block at an open face. Rejects some captures to correct for the number of free
    /// blocks.
    pub(super) fn capture(&mut self, scheduled: ScheduledCapture, dockings: &mut Vec<Docking>) {
        let slot = match scheduled {
            ScheduledCapture::OfAny(slot) => {
                self.queue.forget(slot);
                slot
            }
            ScheduledCapture::HeadStart(start) => {
                self.queue.drop_head_start();
                start.slot
            }
        };
        let Some(face) = self.hazards.face(slot) else {
            return;
        };
        let (seat, face) = seat_and_face(face.number);
        let [which_block, how, whether, threshold] = self.draw();
        let free = self.lattice.free.len();
        let child = match scheduled {
            ScheduledCapture::HeadStart(start) => start.block,
            // Thinning: the hazard was computed for more free blocks than there are.
            _ if free == 0 || unit(whether) >= self.share(free) => {
                self.hazards.continue_wait(slot, exponential(threshold));
                self.estimate(slot);
                return;
            }
            _ => self.lattice.free.select(below(which_block, free)) as u32,
        };
        let pose = below(how, 24) as u8;
        let docking = Docking {
            // Blocks have no positions in this model.
            entries: 0,
            ..self.lattice.docking(seat, face, child, pose, self.tick)
        };
        if self.put(seat, face, &docking) {
            dockings.push(docking);
        }
    }

    /// Puts a block into the cell in front of a face. Returns `false` if the cell is occupied.
    fn put(&mut self, seat: usize, face: Face, docking: &Docking) -> bool {
        let Some(cell) = self.lattice.target(seat, face) else {
            return false;
        };
        let mut changes = Changes::new();
        let record = |change| changes.push(change);
        self.lattice.dock(seat, face, cell, docking, record);
        self.note_cell(cell, true, changes);
        self.follow_free_blocks();
        true
    }
}

fn not_known(what: &'static str) -> SceneError {
    SceneError::NotInModel {
        what,
        model: "rate",
        instead: "rigid",
    }
}

/// Returns the first tick at or after a time, or `u64::MAX` beyond the precision of ticks.
fn boundary(time: f64) -> u64 {
    if time >= 9e15 {
        return u64::MAX;
    }
    let whole = time as u64;
    whole + u64::from((whole as f64) < time)
}

/// Returns a draw from the exponential distribution with mean 1.
fn exponential(word: u32) -> f64 {
    -libm::log(unit(word))
}

impl World for RateWorld<'_> {
    fn tick(&self) -> u64 {
        self.tick
    }

    fn magnetize(&mut self, block_face: BlockFace) {
        if let Some(seat) = self.lattice.seat(block_face.body) {
            let change = self.lattice.magnetize(seat, block_face.face);
            if let Some(change) = change {
                self.note_face(change);
            }
        }
    }

    fn switch_off(&mut self, block_face: BlockFace) {
        let Some(seat) = self.lattice.seat(block_face.body) else {
            return;
        };
        let mut going = vec![(seat, block_face.face)];
        while let Some((seat, face)) = going.pop() {
            if let Some(closed) = self.lattice.close(seat, face) {
                self.note_face(closed);
            }
            let mut changes = Changes::new();
            let record = |change| changes.push(change);
            let Some(child) = self.lattice.release(seat, face, record) else {
                continue;
            };
            going.extend(self.lattice.active_faces(child));
            let from = self.lattice.seats[child].cell;
            self.note_cell(from, false, changes);
            let block = (child - self.lattice.seeds.len()) as u32;
            for slot in self.hazards.near(from) {
                self.head_start(slot, from, block, 0);
            }
            self.released.push((self.tick, from, block));
        }
        self.follow_free_blocks();
    }

    fn plant(&mut self, block_face: BlockFace) -> Option<Docking> {
        self.magnetize(block_face);
        let seat = self.lattice.seat(block_face.body)?;
        let (_, docking) = self
            .lattice
            .pre_attached(seat, block_face.face, self.tick)?;
        self.put(seat, block_face.face, &docking).then_some(docking)
    }

    fn skip(&mut self, last: u64) {
        let next = self.next_tick().unwrap_or(u64::MAX);
        // The capture happens in the step after this tick.
        self.tick = self.tick.max(next.saturating_sub(1).min(last));
    }

    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        self.tick += 1;
        while let Some(scheduled) = self.next() {
            self.capture(scheduled, dockings);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::boundary;

    #[test]
    fn captures_come_at_the_next_tick_or_never() {
        assert_eq!([0.0, 0.2, 3.0, 3.5].map(boundary), [0, 1, 3, 4]);
        assert_eq!(boundary(8.9e15), 8_900_000_000_000_000);
        assert_eq!([1e16, 1e300, f64::INFINITY].map(boundary), [u64::MAX; 3]);
    }
}
