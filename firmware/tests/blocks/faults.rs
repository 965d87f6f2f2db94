//! Lost messages together with lost contacts and restarts.
use std::collections::BTreeMap;
use std::ops::Range;

use stochc_firmware::Image;

use crate::compiled::tables;
use crate::host::{Channel, Host, HostEvent};

/// Captures, notifications, releases, and captures of released blocks.
const PROGRAM: &str = "
    assembly lossy {
        seed plate 1 x 1 { M at (0, 0) }
        phase grow {
            M.up -> A.up -> B
            A.east -> C after B
        }
        phase shrink { release B }
        phase again { A.up -> D.up -> E after C2  C.up -> C2 }
    }";

/// Roles at the end: M, A, C, D, E and C2.
const ROLES: usize = 6;

/// Captures of a phase that is retried. Enough time remains for all captures.
const RETRIED: &str = "
    assembly retried {
        seed plate 1 x 1 { M at (0, 0) }
        phase grow timeout 60 ticks {
            M.up -> A.up -> B
            A.east -> C after B
        } on timeout {
            release grow
            wait 3 ticks
            retry 9
        }
    }";
/// Roles at the end: M, A, B and C.
const RETRIED_ROLES: usize = 4;
/// Rounds without dockings, so that the first two attempts time out.
const IDLE: [Range<usize>; 2] = [7..60, 72..140];
const FREE: u32 = 8;
const ROUNDS: usize = 400;

/// States of a face in `block.h`.
const NAMING: u8 = 2;
const CHILD: u8 = 3;
const FREEING: u8 = 4;

/// Side of a contact whose bytes are lost.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mute {
    Neither,
    Parent,
    Child,
}

/// Fault at the end of the silence.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    /// The contact opens. The block later docks again, turned by this number of faces.
    Lost { turn: u8 },
    /// The child restarts.
    Restart,
}

#[derive(Clone, Copy, Debug)]
struct Case {
    /// First silent round.
    start: usize,
    /// Number of silent rounds.
    length: usize,
    mute: Mute,
    fault: Fault,
    /// The contact with this number fails.
    contact: usize,
}

/// Blocks at faces, and blocks that will dock.
struct Trial<'a> {
    host: &'a mut Host,
    held: BTreeMap<(u32, u8), (u32, u8)>,
    open: Vec<(u32, u8)>,
    free: Vec<u32>,
    turn: u8,
    phase: u32,
    /// Blocks that have lost their parent, and keep their roles.
    lost: Vec<u32>,
    /// Rounds without dockings.
    idle: [Range<usize>; 2],
    aborts: usize,
}

impl Trial<'_> {
    fn new<'a>(host: &'a mut Host, image: &Image) -> Trial<'a> {
        let channel = Channel {
            loss: 0,
            noise: 0,
            seed: 0,
        };
        host.load(image, 1 + FREE as usize, channel);
        Trial {
            host,
            held: BTreeMap::new(),
            open: Vec::new(),
            free: (1..=FREE).rev().collect(),
            turn: 0,
            phase: 0,
            lost: Vec::new(),
            idle: [0..0, 0..0],
            aborts: 0,
        }
    }

    fn is_attached(&self, unit: u32) -> bool {
        unit == 0 || self.held.values().any(|&(child, _)| child == unit)
    }

    fn command(&mut self, command: &str) -> Result<(), String> {
        for event in self.host.events(command) {
            match event {
                HostEvent::Opened { unit, face } => {
                    if !self.is_attached(unit) && !self.lost.contains(&unit) {
                        return Err(format!("unit {unit} is free and attracts blocks"));
                    }
                    self.open.push((unit, face));
                }
                HostEvent::Closed { unit, face } => {
                    let (child, _) = self.held.remove(&(unit, face)).ok_or("nothing held")?;
                    self.free.push(child);
                }
                HostEvent::Emptied { unit, face } => self.open.retain(|it| *it != (unit, face)),
                HostEvent::Phase(phase) => self.phase = phase,
                HostEvent::Abort => self.aborts += 1,
                HostEvent::TimedOut => return Err("timed out".into()),
                _ => {}
            }
        }
        Ok(())
    }

    /// Lets all blocks work once. Every third round, the block that was released last docks.
    fn round(&mut self, number: usize) -> Result<(), String> {
        self.command("G")?;
        let mut open = self.open.iter();
        let position = open.position(|&(unit, _)| self.is_attached(unit));
        let is_idle = self.idle.iter().any(|idle| idle.contains(&number));
        let Some(position) = position.filter(|_| number % 3 == 2 && !is_idle) else {
            return Ok(());
        };
        let (unit, face) = self.open.remove(position);
        let child = self.free.pop().ok_or("no free block")?;
        let own = (1 + self.turn) % 6;
        self.held.insert((unit, face), (child, own));
        self.command(&format!("D {unit} {face} {child} {own} {}", (own + 2) % 6))
    }

    fn state(&mut self, unit: u32, face: u8) -> u8 {
        let states = self.host.states();
        let state = states.iter().find(|state| state.unit == unit);
        state.map_or(0, |state| state.faces[usize::from(face)])
    }

    fn mute(&mut self, mute: Mute, parent: (u32, u8), child: (u32, u8), on: u8) {
        let (unit, face) = match mute {
            Mute::Neither => return,
            Mute::Parent => parent,
            Mute::Child => child,
        };
        self.host.events(&format!("M {unit} {face} {on}"));
    }

    /// Runs a case. Returns whether the fault happened before the end of a capture or release.
    fn run(&mut self, case: Case) -> Result<bool, String> {
        for number in 0..case.start {
            self.round(number)?;
        }
        let Some((&parent, &child)) = self.held.iter().nth(case.contact) else {
            return Ok(false);
        };
        self.mute(case.mute, parent, child, 1);
        for number in case.start..case.start + case.length {
            self.round(number)?;
        }
        self.mute(case.mute, parent, child, 0);
        let state = self.state(parent.0, parent.1);
        let is_held = self.held.get(&parent) == Some(&child);
        if !is_held || (state != NAMING && state != FREEING) {
            return Ok(false);
        }
        match case.fault {
            Fault::Lost { turn } => {
                self.turn = turn;
                self.command(&format!("U {} {}", parent.0, parent.1))?;
                if state == NAMING {
                    self.open.push(parent);
                }
            }
            Fault::Restart => self.command(&format!("X {}", child.0))?,
        }
        for number in 0..ROUNDS {
            self.round(number)?;
            if self.phase == 3 {
                return self.compare(ROLES).map(|()| true);
            }
        }
        Err(format!(
            "stuck: {:?} {:?} {:?}",
            self.held,
            self.aborts,
            self.host.states()
        ))
    }

    /// Runs a phase with retries until its end, with a fault at a contact after `start` rounds.
    /// Returns the number of aborts before and after the fault. Returns `None` if the contact holds
    /// no child.
    fn run_with_retries(
        &mut self,
        start: usize,
        contact: usize,
        fault: Fault,
    ) -> Result<Option<[usize; 2]>, String> {
        self.idle = IDLE;
        for number in 0..start {
            self.round(number)?;
        }
        let Some((&parent, &(child, _))) = self.held.iter().nth(contact) else {
            return Ok(None);
        };
        let holds = |trial: &Self| trial.held.keys().any(|&(unit, _)| unit == child);
        if self.phase > 0 || self.state(parent.0, parent.1) != CHILD {
            return Ok(None);
        }
        match fault {
            // A block with children ignores names, so it cannot dock again.
            Fault::Lost { .. } if holds(self) => return Ok(None),
            Fault::Lost { turn } => {
                self.turn = turn;
                self.lost.push(child);
                self.command(&format!("U {} {}", parent.0, parent.1))?;
            }
            Fault::Restart => {
                self.command(&format!("X {child}"))?;
                self.open.retain(|&(unit, _)| unit != child);
            }
        }
        let before = self.aborts;
        for number in start..start + ROUNDS {
            self.round(number)?;
            if self.phase == 1 {
                let after = self.aborts - before;
                // Without an abort, the plate had all reports before the fault.
                if after > 0 {
                    self.compare(RETRIED_ROLES)?;
                }
                return Ok(Some([before, after]));
            }
        }
        Err(format!(
            "stuck: {:?} {:?} {:?}",
            self.held,
            self.aborts,
            self.host.states()
        ))
    }

    /// Compares the structure with that of the program.
    fn compare(&mut self, count: usize) -> Result<(), String> {
        let states = self.host.states();
        let attached = states.iter().filter(|state| self.is_attached(state.unit));
        let mut roles: Vec<u32> = attached.map(|state| state.role).collect();
        roles.sort_unstable();
        roles.dedup();
        if roles.len() == count && self.held.len() + 1 == count {
            return Ok(());
        }
        Err(format!("{} blocks: {states:#?}", self.held.len()))
    }
}

/// Returns the rounds and contacts with an unfinished capture or release.
fn unfinished(host: &mut Host, image: &Image) -> Vec<(usize, usize)> {
    let mut trial = Trial::new(host, image);
    let mut found = Vec::new();
    for number in 0..ROUNDS {
        trial.round(number).unwrap();
        let held: Vec<_> = trial.held.keys().copied().collect();
        for (contact, parent) in held.into_iter().enumerate() {
            if [NAMING, FREEING].contains(&trial.state(parent.0, parent.1)) {
                // The silence may begin before the capture or release does.
                found.extend((0..3).map(|before| (number + 1 - before, contact)));
            }
        }
        if trial.phase == 3 {
            found.sort_unstable();
            found.dedup();
            return found;
        }
    }
    panic!("stuck without faults");
}

#[test]
fn lost_messages_with_lost_contacts_and_restarts_leave_no_trace() {
    let image = Image::new(&tables(PROGRAM)).unwrap();
    let mut host = Host::new();
    let mut counts = BTreeMap::new();
    for (start, contact) in unfinished(&mut host, &image) {
        for mute in [Mute::Neither, Mute::Parent, Mute::Child] {
            let faults = [0, 1, 2, 4].map(|turn| Fault::Lost { turn });
            for fault in faults.into_iter().chain([Fault::Restart]) {
                for length in [0, 1, 2, 9] {
                    let case = Case {
                        start,
                        length,
                        mute,
                        fault,
                        contact,
                    };
                    let mut trial = Trial::new(&mut host, &image);
                    match trial.run(case) {
                        Ok(true) => *counts.entry(format!("{mute:?}")).or_insert(0) += 1,
                        Ok(false) => {}
                        Err(error) => panic!("{case:?}: {error}"),
                    }
                }
            }
        }
    }
    println!("{counts:?}");
    assert!(
        counts.len() == 3 && counts.values().all(|&n| n > 30),
        "{counts:?}"
    );
}

#[test]
fn a_retry_repairs_lost_contacts_and_restarts_of_attached_blocks() {
    let image = Image::new(&tables(RETRIED)).unwrap();
    let mut host = Host::new();
    let mut counts = BTreeMap::new();
    let faults = [0, 1, 4].map(|turn| Fault::Lost { turn });
    for fault in faults.into_iter().chain([Fault::Restart]) {
        for (start, contact) in (0..160).flat_map(|start| (0..3).map(move |it| (start, it))) {
            let mut trial = Trial::new(&mut host, &image);
            match trial.run_with_retries(start, contact, fault) {
                Ok(Some([before, after])) if after > 0 => {
                    *counts
                        .entry((fault == Fault::Restart, before.min(1)))
                        .or_insert(0) += 1;
                }
                Ok(_) => {}
                Err(error) => panic!("{fault:?} of contact {contact} after {start}: {error}"),
            }
        }
    }
    println!("{counts:?}");
    assert!(
        counts.len() == 4 && counts.values().all(|&n| n > 20),
        "{counts:?}"
    );
}
