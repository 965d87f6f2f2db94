//! Random orders of events, carried out by the interpreters and by the control.
use std::collections::{BTreeMap, BTreeSet};
use std::hash::Hash;

use stochc_control::{BlockFace, Body, Docking, Orientation, StructureBlock};
use stochc_firmware::Image;
use stochc_ir::Face;
use stochc_ir::table::{Phase, Tables};

use crate::control::Control;
use crate::host::{BlockState, Channel, Host, HostEvent};

/// States of a face in `block.h`.
const OFF: u8 = 0;
const OPEN: u8 = 1;

/// One structure, twice: the control, and the faces and blocks of the interpreters.
#[derive(Clone)]
pub struct Model<'a> {
    pub control: Control<'a>,
    tables: &'a Tables,
    seeds: Vec<Body>,
    /// Faces that the interpreters have switched on and that are empty.
    pub open: BTreeSet<(u32, u8)>,
    /// Blocks at faces.
    pub held: BTreeMap<(u32, u8), u32>,
    /// Free blocks.
    pub free: Vec<u32>,
    /// Blocks docked at faces that the control has switched off.
    strays: BTreeSet<u32>,
    /// Start of the phase, of its attempt or of its abort \[ticks\].
    began: u32,
    /// Blocks that had no confirmed role when a timeout ended the program.
    dropped: usize,
    outcome: RunOutcome,
}

/// A structure with random events.
struct Pair<'a> {
    host: &'a mut Host,
    model: Model<'a>,
    random: Random,
}

/// Events of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct RunOutcome {
    /// Number of retries of phases.
    pub retries: usize,
    /// Number of delayed releases.
    pub delayed: usize,
    /// Whether a timeout has ended the program.
    pub timed_out: bool,
}

/// Numbers drawn at random.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n.max(1)
    }
}

/// Returns the face of a block towards which the mark of `face` points.
fn mark(face: Face) -> Face {
    Face::ALL[(face as usize + 2) % 6]
}

fn is_open(block: &StructureBlock, own: Face) -> bool {
    block.open().iter().any(|open| open.own == own)
}

/// Builds a structure with the interpreters, in one random order. The control must accept every
/// event, and must be in the same state whenever no message is in transit.
pub fn run(tables: &Tables, host: &mut Host, channel: Channel) -> Result<RunOutcome, String> {
    let image = Image::new(tables).map_err(|error| error.to_string())?;
    let free = tables.captures() + 2;
    let model = Model::new(tables, free);
    host.load(&image, model.seeds.len() + free, channel);
    let mut pair = Pair {
        host,
        model,
        random: Random(channel.seed),
    };
    let recoveries = tables.phases.iter().filter_map(|phase| phase.recovery);
    let attempts: usize = 1 + recoveries.map(|it| it.retries as usize).sum::<usize>();
    let limit = (1000 + 400 * free) * attempts;
    for _ in 0..limit {
        pair.step()?;
        if pair.model.has_ended() {
            pair.settle()?;
            let (block, plate) = pair.host.waiting();
            if block > image.sizes.waiting || plate > image.sizes.plate_waiting {
                return Err(format!("{block} and {plate} waiting: {:?}", image.sizes));
            }
            pair.model.outcome.delayed = pair.model.control.effects.delayed;
            return Ok(pair.model.outcome);
        }
    }
    Err(format!("stuck: {:#?}", pair.host.states()))
}

impl Pair<'_> {
    fn step(&mut self) -> Result<(), String> {
        match self.random.below(8) {
            0 => self.settle()?,
            1 => self.stray()?,
            2 | 3 => self.capture()?,
            _ => {
                let polls = 1 + self.random.below(40);
                self.command(&format!("R {polls}"))?;
            }
        }
        Ok(())
    }

    fn command(&mut self, command: &str) -> Result<(), String> {
        for event in self.host.events(command) {
            self.model
                .apply(event)
                .map_err(|error| format!("{event:?}: {error}"))?;
        }
        Ok(())
    }

    /// Lets a random free block dock at a random open face.
    fn capture(&mut self) -> Result<(), String> {
        let open: Vec<_> = self.model.open.iter().copied().collect();
        if open.is_empty() || self.model.free.is_empty() {
            return Ok(());
        }
        let (unit, face) = open[self.random.below(open.len())];
        let block_face = BlockFace {
            body: self.model.body(unit),
            face: Face::ALL[usize::from(face)],
        };
        if !self.model.has_target(block_face) {
            return Ok(());
        }
        let child = self
            .model
            .free
            .swap_remove(self.random.below(self.model.free.len()));
        let child_face = Face::ALL[self.random.below(6)];
        let turn = self.random.below(4) as u8;
        let command = self.model.dock((unit, face), child, child_face, turn)?;
        self.command(&command)
    }

    /// Lets a free block dock at a face that is off. The capturing block must release it at once.
    fn stray(&mut self) -> Result<(), String> {
        let blocks: Vec<_> = self.model.control.structure.blocks().collect();
        let block = blocks[self.random.below(blocks.len())];
        let face = Face::ALL[self.random.below(6)];
        let body = block.body();
        let block_face = BlockFace { body, face };
        if is_open(block, face) || !self.model.has_target(block_face) {
            return Ok(());
        }
        let unit = match body {
            Body::Seed(_) => self
                .model
                .seeds
                .iter()
                .position(|seed| *seed == body)
                .unwrap() as u32,
            Body::Free(free) => self.model.unit(free),
        };
        if self.model.held.contains_key(&(unit, face as u8)) || self.model.free.len() < 2 {
            return Ok(());
        }
        // The capturing block may not have its role yet: it would keep the stray block.
        let states = self.host.states();
        let state = states.iter().find(|state| state.unit == unit);
        if state.is_none_or(|state| state.faces[face as usize] != OFF) {
            return Ok(());
        }
        let child = self
            .model
            .free
            .swap_remove(self.random.below(self.model.free.len()));
        self.model.strays.insert(child);
        self.model.held.insert((unit, face as u8), child);
        let number = self.model.unit(child);
        self.command(&format!("D {unit} {} {number} 0 2", face as u8))?;
        self.command(&format!("T {unit}"))?;
        if self.model.strays.contains(&child) {
            let states = self.host.states();
            if states.iter().any(|state| state.unit == unit) {
                return Err(format!("unit {unit} keeps a stray block"));
            }
            // The capturing block has lost its role in the meantime.
            self.command(&format!("U {unit} {}", face as u8))?;
        }
        Ok(())
    }

    /// Lets all messages arrive, and compares the states.
    fn settle(&mut self) -> Result<(), String> {
        self.command("Q")?;
        let states = self.host.states();
        self.model.compare(states)
    }
}

impl<'a> Model<'a> {
    /// Returns the start of a program with a number of free blocks.
    pub fn new(tables: &'a Tables, free: usize) -> Model<'a> {
        Model {
            control: Control::new(tables),
            tables,
            seeds: tables.seeds().map(|(_, cell)| Body::Seed(cell)).collect(),
            open: BTreeSet::new(),
            held: BTreeMap::new(),
            free: (0..free as u32).collect(),
            strays: BTreeSet::new(),
            began: 0,
            dropped: 0,
            outcome: RunOutcome::default(),
        }
    }

    /// Returns a value that differs between states.
    pub fn key(&self) -> impl Hash {
        let ends = (self.outcome.timed_out, self.dropped);
        let faces = (&self.open, &self.held, &self.strays);
        (self.control.hash(), faces, ends)
    }

    /// Returns whether all phases are complete, or a timeout has ended the program.
    pub fn has_ended(&self) -> bool {
        self.control.is_complete() || self.outcome.timed_out
    }

    fn has_target(&self, face: BlockFace) -> bool {
        self.control.effects.lattice.target(face).is_some()
    }

    pub fn body(&self, unit: u32) -> Body {
        let seed = self.seeds.get(unit as usize);
        seed.map_or_else(|| Body::Free(unit - self.seeds.len() as u32), |seed| *seed)
    }

    pub fn unit(&self, free: u32) -> u32 {
        free + self.seeds.len() as u32
    }

    fn is_stray(&self, unit: u32) -> bool {
        self.strays.iter().any(|&free| self.unit(free) == unit)
    }

    /// Returns an error if a time of the running phase is not over. Begins the next one.
    fn check_time(&mut self, time: impl Fn(&Phase) -> u64) -> Result<(), String> {
        let phase = self
            .control
            .structure
            .phase()
            .ok_or("no phase is running")?;
        let ticks = time(&self.tables.phases[phase.0 as usize]);
        let now = self.control.effects.now;
        let passed = now - self.began;
        if u64::from(passed) < ticks {
            return Err(format!("after {passed} instead of {ticks} ticks"));
        }
        self.began = now;
        Ok(())
    }

    pub fn apply(&mut self, event: HostEvent) -> Result<(), String> {
        let timeout = |phase: &Phase| phase.timeout.unwrap_or(u64::MAX);
        match event {
            HostEvent::Time(now) => self.control.effects.now = now,
            // A block that does not know about an abort yet.
            HostEvent::Opened { unit, .. } if self.is_stray(unit) => {}
            HostEvent::Opened { unit, face } if self.control.structure.is_aborting() => {
                self.open.insert((unit, face));
            }
            HostEvent::Opened { unit, face } => {
                let block = self.control.structure.block(self.body(unit));
                let block = block.ok_or("a block without a role")?;
                let own = Face::ALL[usize::from(face)];
                if !is_open(block, own) {
                    return Err("the control has not opened it".into());
                }
                self.open.insert((unit, face));
            }
            HostEvent::Closed { unit, face } => {
                let child = self.held.remove(&(unit, face)).ok_or("it holds nothing")?;
                self.free.push(child);
                if !self.strays.remove(&child) {
                    let block_face = BlockFace {
                        body: self.body(unit),
                        face: Face::ALL[usize::from(face)],
                    };
                    match self.control.release(block_face, Body::Free(child)) {
                        Err(_) if self.outcome.timed_out => self.dropped += 1,
                        result => result?,
                    }
                }
            }
            HostEvent::Emptied { unit, face } => {
                self.open.remove(&(unit, face));
            }
            HostEvent::Phase(_) => {
                self.check_time(|phase| phase.wait)?;
                self.control.next_phase()?;
            }
            HostEvent::Abort => {
                self.check_time(timeout)?;
                self.control.abort()?;
            }
            HostEvent::Retry => {
                self.outcome.retries += 1;
                self.check_time(|phase| phase.recovery.map_or(0, |it| it.pause))?;
                self.control.retry()?;
            }
            HostEvent::TimedOut => {
                self.check_time(timeout)?;
                if self.control.structure.can_abort() {
                    return Err("the phase can be retried".into());
                }
                self.outcome.timed_out = true;
            }
            HostEvent::Stored(_)
            | HostEvent::HasBytes { .. }
            | HostEvent::CanRepeat(_)
            | HostEvent::HasTimes(_) => {}
        }
        Ok(())
    }

    /// Docks a free block, which is no longer in `free`. Returns the command for the interpreters.
    pub fn dock(
        &mut self,
        (unit, face): (u32, u8),
        child: u32,
        child_face: Face,
        turn: u8,
    ) -> Result<String, String> {
        let block_face = BlockFace {
            body: self.body(unit),
            face: Face::ALL[usize::from(face)],
        };
        let block = self.control.structure.block(block_face.body);
        let is_late = !block.is_some_and(|block| is_open(block, block_face.face));
        let pose = self.control.effects.lattice.pose(block_face.body);
        let parent = pose.ok_or("a parent without a place")?.orientation;
        let orientation = Orientation::docked(parent, block_face.face, child_face, turn);
        let pointed = orientation.to_own(parent.to_structure(mark(block_face.face)));
        self.open.remove(&(unit, face));
        self.held.insert((unit, face), child);
        let number = self.unit(child);
        let (own, pointed) = (child_face as u8, pointed as u8);
        if is_late {
            self.strays.insert(child);
        } else {
            self.control.dock(&Docking {
                block_face,
                child,
                child_face,
                turn,
                entries: 1,
                entered: 0,
            });
        }
        Ok(format!("D {unit} {face} {number} {own} {pointed}"))
    }

    /// Compares the states of the interpreters with the control, when no message is in transit.
    pub fn compare(&self, mut states: Vec<BlockState>) -> Result<(), String> {
        // An abort may have released a block before it learnt the confirmation of its role.
        states.retain(|state| !self.free.iter().any(|&free| self.unit(free) == state.unit));
        let count = self.control.structure.count() - self.dropped;
        if states.len() != count {
            return Err(format!("{} blocks instead of {count}", states.len()));
        }
        let has_ended = self.outcome.timed_out;
        let phase = self.control.structure.phase();
        let phase = phase.filter(|_| !has_ended);
        for state in &states {
            let body = self.body(state.unit);
            let block = self.control.structure.block(body);
            let block = block.ok_or_else(|| format!("{state:?} is not attached"))?;
            let orientation = block.orientation();
            let directions = Face::ALL.map(|own| orientation.to_structure(own) as u8);
            // At the end, faces without a block are off.
            let open = block.open().iter().filter(|_| !has_ended);
            let mut open: Vec<u8> = open.map(|open| open.own as u8).collect();
            open.sort_unstable();
            let has: Vec<u8> = (0..6)
                .filter(|&f| state.faces[usize::from(f)] == OPEN)
                .collect();
            let is_phase = phase.is_none_or(|phase| phase.0 == state.phase);
            if state.role != block.role().0
                || state.directions != directions
                || has != open
                || !is_phase
            {
                return Err(format!("{state:?} and {block:?} in phase {phase:?}"));
            }
        }
        Ok(())
    }
}
