//! Every order of messages and captures, with the interpreters in C as the machines.
//!
//! A transition is a call of `sa_poll`, a capture, or a loss of all bytes at a face. It can also end
//! a time of the program, at any moment. No frame is sent again while it or its
//! acknowledgement is in transit.
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use stochc_control::BlockFace;
use stochc_firmware::Image;
use stochc_ir::Face;
use stochc_ir::table::Tables;

use crate::compiled::tables;
use crate::driver::Model;
use crate::host::{Channel, Host, HostEvent};
use crate::random::{Reuse, declare_with};

/// Largest number of states of an exploration.
const MAX_STATES: usize = 40_000;
/// The same for a random program.
const MAX_STATES_RANDOM: usize = 4_000;
/// Number of random programs.
const RANDOM: u64 = 60;

/// Transition of the blocks.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// A block, or the plate, works once.
    Poll(u32),
    /// A block docks at a face.
    Dock(u32, u8),
    /// A block sends its frames again.
    Repeat(u32),
    /// The bytes at a face are lost.
    Lose(u32, u8),
    /// The times of a block, or of the plate, end.
    Wait(u32),
}

/// State on the current path.
struct Visit<'a> {
    number: u32,
    model: Model<'a>,
    /// Losses that may still happen.
    losses: u8,
    todo: Vec<Step>,
    last: Option<Step>,
}

/// Depth-first search of all states.
struct Search<'a> {
    host: &'a mut Host,
    /// Number of each state.
    known: HashMap<u64, u32>,
    /// Transitions between different states.
    edges: Vec<(u32, u32)>,
    /// Final states. The program is complete, or has timed out.
    ends: Vec<u32>,
    path: Vec<Visit<'a>>,
}

/// Returns the number of states of a program, or `None` if there are more than `most`. In every state, all
/// earlier events are those of the control, and the program can still be completed.
fn explore(
    tables: &Tables,
    losses: u8,
    most: usize,
    host: &mut Host,
) -> Result<Option<usize>, String> {
    let image = Image::new(tables).map_err(|error| error.to_string())?;
    let free = tables.roles.len() - image.sizes.seeds + 1;
    let channel = Channel {
        loss: 0,
        noise: 0,
        seed: 0,
    };
    host.load(&image, image.sizes.seeds + free, channel);
    let mut search = Search {
        host,
        known: HashMap::new(),
        edges: Vec::new(),
        ends: Vec::new(),
        path: Vec::new(),
    };
    let tables = timeless(tables);
    let mut model = Model::new(&tables, free);
    model.control.effects.is_timeless = true;
    let result = search.run(model, losses, most);
    result.map_err(|error| {
        let steps: Vec<_> = search.path.iter().filter_map(|visit| visit.last).collect();
        format!("{error} after {steps:?}")
    })
}

/// Returns tables whose times are over at once.
fn timeless(tables: &Tables) -> Tables {
    let mut tables = tables.clone();
    for phase in &mut tables.phases {
        phase.wait = 0;
        phase.timeout = phase.timeout.map(|_| 0);
        if let Some(recovery) = &mut phase.recovery {
            recovery.pause = 0;
        }
    }
    tables
}

impl<'a> Search<'a> {
    fn run(&mut self, model: Model<'a>, losses: u8, most: usize) -> Result<Option<usize>, String> {
        self.enter("Z 0", model, losses)?;
        while let Some(visit) = self.path.last_mut() {
            let Some(step) = visit.todo.pop() else {
                let number = visit.number;
                // Edges of a state are added while it is on the path.
                let is_end = !self.edges.iter().rev().any(|edge| edge.0 == number);
                if is_end {
                    self.end()?;
                }
                self.path.pop();
                continue;
            };
            visit.last = Some(step);
            let (mut model, losses) = (visit.model.clone(), visit.losses);
            let slot = self.path.len();
            let (command, losses) = match step {
                Step::Poll(unit) => (format!("T {unit}"), losses),
                Step::Repeat(unit) => (format!("P {unit}"), losses),
                Step::Wait(unit) => (format!("V {unit}"), losses),
                Step::Lose(unit, face) => (format!("Y {unit} {face}"), losses - 1),
                Step::Dock(unit, face) => (dock(&mut model, unit, face)?, losses),
            };
            let command = format!("J {}\n{command}\nZ {slot}", slot - 1);
            self.enter(&command, model, losses)?;
            if self.known.len() > most {
                return Ok(None);
            }
        }
        self.check_ends()?;
        Ok(Some(self.known.len()))
    }

    /// Carries out a transition, and enters its state unless it was visited before.
    fn enter(&mut self, command: &str, mut model: Model<'a>, losses: u8) -> Result<(), String> {
        let events = self.host.events(command);
        let mut todo = Vec::new();
        let mut stored = 0;
        for event in events {
            match event {
                HostEvent::Stored(hash) => stored = hash,
                HostEvent::HasBytes { unit, face } if losses > 0 => {
                    todo.push(Step::Lose(unit, face));
                }
                HostEvent::HasBytes { .. } => {}
                HostEvent::CanRepeat(unit) => todo.push(Step::Repeat(unit)),
                HostEvent::HasTimes(unit) => todo.push(Step::Wait(unit)),
                event => model
                    .apply(event)
                    .map_err(|error| format!("{event:?}: {error}"))?,
            }
        }
        let mut hasher = DefaultHasher::new();
        (stored, losses, model.key()).hash(&mut hasher);
        let next = self.known.len() as u32;
        let number = *self.known.entry(hasher.finish()).or_insert(next);
        let before = self.path.last().map(|visit| visit.number);
        if let Some(before) = before.filter(|before| *before != number) {
            self.edges.push((before, number));
        }
        if number == next {
            let open = model.open.iter().filter(|_| !model.has_ended());
            todo.extend(open.map(|&(unit, face)| Step::Dock(unit, face)));
            let attached = model.held.values().map(|&child| model.unit(child));
            todo.extend(attached.map(Step::Poll));
            todo.push(Step::Poll(0));
            self.path.push(Visit {
                number,
                model,
                losses,
                todo,
                last: None,
            });
        }
        Ok(())
    }

    /// Checks a state without further transitions.
    fn end(&mut self) -> Result<(), String> {
        let slot = self.path.len() - 1;
        let Some(visit) = self.path.last() else {
            return Ok(());
        };
        if !visit.model.has_ended() {
            return Err("nothing can happen".into());
        }
        self.host.events(&format!("J {slot}"));
        visit.model.compare(self.host.states())?;
        self.ends.push(visit.number);
        Ok(())
    }

    /// Checks that every state leads to an end.
    fn check_ends(&mut self) -> Result<(), String> {
        let count = self.known.len();
        let mut before = vec![Vec::new(); count];
        for &(from, to) in &self.edges {
            before[to as usize].push(from);
        }
        let mut leads = vec![false; count];
        let mut todo = self.ends.clone();
        while let Some(number) = todo.pop() {
            if !std::mem::replace(&mut leads[number as usize], true) {
                todo.extend(&before[number as usize]);
            }
        }
        match leads.iter().position(|leads| !leads) {
            Some(number) => Err(format!("state {number} of {count} leads to no end")),
            None => Ok(()),
        }
    }
}

/// Docks the block with the number of the expected role, so that equal structures are equal states.
fn dock(model: &mut Model<'_>, unit: u32, face: u8) -> Result<String, String> {
    let block_face = BlockFace {
        body: model.body(unit),
        face: Face::ALL[usize::from(face)],
    };
    let role = model.control.structure.awaited(block_face);
    let number = role.map_or(0, |role| role.0 - model.unit(0));
    model.free.sort_unstable();
    let position = model.free.partition_point(|&free| free < number);
    if role.is_some() && model.free.get(position) != Some(&number) {
        return Err(format!("a block with the role {role:?} is attached"));
    }
    let child = model.free.remove(position);
    model.dock((unit, face), child, Face::Down, 0)
}

/// Programs with notifications between branches and seeds, releases, and captures of released roles.
const PROGRAMS: [&str; 5] = [
    "assembly branches {
        seed plate 1 x 1 { M at (0, 0) }
        phase grow {
            M.up -> A.up -> B
            A.east -> C after B
        }
        phase shrink { release B }
        phase again { A.up -> D.up -> E after C2  C.up -> C2 }
    }",
    "assembly seeds {
        seed plate 3 x 1 { M at (0, 0)  N at (2, 0) }
        phase grow {
            M.up -> A
            A.up -> C after B
            N.up -> B after A
        }
        phase swap {
            release C
            B.up -> D after release C
        }
    }",
    "assembly moved {
        seed plate 1 x 1 { M at (0, 0) }
        phase grow { M.up -> A.up -> B }
        phase move {
            release B
            A.east -> B after release B
        }
    }",
    "assembly timed {
        seed plate 1 x 1 { M at (0, 0) }
        phase grow { wait 9 ticks  M.up -> A.up -> B }
        phase shrink timeout 99 ticks { release B after 9 ticks }
    }",
    "assembly retried {
        seed plate 1 x 1 { M at (0, 0) }
        phase grow timeout 9 ticks { M.up -> A.up -> B } on timeout { release grow  wait 9 ticks  retry 1 }
    }",
];

#[test]
fn every_order_completes_small_programs() {
    let mut host = Host::small();
    for program in PROGRAMS {
        let tables = tables(program);
        for losses in [0, 1] {
            let states = explore(&tables, losses, MAX_STATES, &mut host);
            let states = states.unwrap_or_else(|error| panic!("{}: {error}", tables.assembly));
            println!("{}, {losses} losses: {states:?} states", tables.assembly);
            assert!(states.is_some_and(|states| states > 50));
        }
    }
}

#[test]
fn every_order_completes_random_programs() {
    let mut host = Host::small();
    let (mut explored, mut states) = (0, 0);
    for seed in 0..RANDOM {
        let choices = (0..16 + seed % 32).map(|i| {
            let mut hasher = DefaultHasher::new();
            (seed, i).hash(&mut hasher);
            hasher.finish() as u32
        });
        let reuse = [Reuse::Later, Reuse::AtOnce][seed as usize % 2];
        let declared = declare_with(reuse, choices.collect(), 1 + (seed % 3) as u8);
        let mut tables = declared.tables();
        for phase in &mut tables.phases {
            // Each attempt would have as many states as the phase.
            (phase.timeout, phase.recovery) = (None, None);
        }
        if tables.captures() > 8 {
            continue;
        }
        let found = explore(&tables, 0, MAX_STATES_RANDOM, &mut host);
        let found = found.unwrap_or_else(|error| panic!("{error} {}", declared.text));
        explored += usize::from(found.is_some());
        states += found.unwrap_or(MAX_STATES_RANDOM);
    }
    println!("{explored} programs, {states} states");
    assert!(explored > 30, "{explored}");
}
