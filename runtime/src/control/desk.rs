//! The books of a run: the clock, the post, and the record of what happened when.
use std::collections::BTreeMap;

use stochc_ir::Face;
use stochc_ir::record::{BondRecord, Origin, ReleaseRecord, UnplannedRecord};
use stochc_ir::table::{PhaseId, RoleId};

use super::block::Open;
use super::medium::{Capture, Medium, Recalled};
use super::message::{Message, Reporter};
use super::post::Post;
use crate::observe::{Event, Log};
use crate::world::{Body, Docking, Site, World};

/// What a run keeps besides the structure and the world.
#[derive(Debug)]
pub(super) struct Desk {
    pub tick: u64,
    /// The phase that is running, or ran last.
    phase: PhaseId,
    pub post: Post,
    /// Since when the faces are on that hold nothing.
    since: BTreeMap<Site, u64>,
    /// Where released blocks come from.
    released: BTreeMap<u32, Origin>,
    pub bonds: Vec<BondRecord>,
    pub releases: Vec<ReleaseRecord>,
    /// Blocks that docked where nobody expected them.
    pub unplanned: Vec<UnplannedRecord>,
    pub log: Log,
}

impl Desk {
    pub fn new(post: Post) -> Desk {
        Desk {
            tick: 0,
            phase: PhaseId(0),
            post,
            since: BTreeMap::new(),
            released: BTreeMap::new(),
            bonds: Vec::new(),
            releases: Vec::new(),
            unplanned: Vec::new(),
            log: Log::default(),
        }
    }

    /// Takes the next message that has arrived, with where it is.
    pub fn due(&mut self) -> Option<(Body, Message)> {
        self.post.due(self.tick, &mut self.log)
    }

    /// Writes down that a phase begins; `None`: the last one has ended.
    pub fn note_phase(&mut self, phase: Option<PhaseId>) {
        if let Some(phase) = phase {
            self.phase = phase;
            self.log.note(Event::Phase(phase));
        }
    }

    /// Since when a face is on that holds nothing.
    pub fn on_since(&self, site: Site) -> Option<u64> {
        self.since.get(&site).copied()
    }

    /// The desk with a world at hand.
    pub fn beside<'a, W: World>(&'a mut self, world: &'a mut W) -> Beside<'a, W> {
        Beside { desk: self, world }
    }
}

/// Carries the structure's wishes to the world, and writes down what happens.
pub(super) struct Beside<'a, W> {
    desk: &'a mut Desk,
    world: &'a mut W,
}

impl<W: World> Medium for Beside<'_, W> {
    fn magnetize(&mut self, site: Site, by: RoleId, open: &Open) {
        self.desk.log.note(Event::Magnetized {
            body: site.body,
            by,
            face: open.face,
            child: open.child,
            cell: open.cell,
        });
        self.desk.since.insert(site, self.desk.tick);
        self.world.magnetize(site);
    }

    fn switch_off(&mut self, site: Site) {
        self.desk.since.remove(&site);
        self.world.switch_off(site);
    }

    fn send(&mut self, from: Body, to: Body, message: Message) {
        let Desk {
            tick, post, log, ..
        } = self.desk;
        post.send(*tick, from, to, message, log);
    }

    fn recall(&mut self, gone: Body) -> Recalled {
        self.desk.post.recall(gone)
    }

    fn hush(&mut self) {
        self.desk.post.clear();
    }

    fn captured(&mut self, capture: &Capture, docking: &Docking) {
        let Desk {
            tick,
            since,
            released,
            bonds,
            log,
            ..
        } = self.desk;
        log.note(Event::Captured {
            body: docking.child,
            on: docking.site.body,
            face: capture.face,
            role: capture.child,
            cell: capture.cell,
        });
        bonds.push(BondRecord {
            phase: capture.phase,
            parent: capture.parent,
            face: capture.face,
            child: capture.child,
            cell: capture.cell,
            magnetized: since.remove(&docking.site).unwrap_or(*tick),
            docked: *tick,
            entries: docking.entries,
            docking: *tick - docking.entered,
            body: docking.child,
            origin: (released.get(&docking.child).cloned()).unwrap_or(Origin::Free),
        });
    }

    fn unplanned(&mut self, by: RoleId, face: Face, docking: &Docking) {
        self.desk.unplanned.push(UnplannedRecord {
            phase: self.desk.phase,
            parent: by,
            face,
            tick: self.desk.tick,
            body: docking.child,
        });
        self.desk.log.note(Event::Unplanned {
            body: docking.child,
            on: docking.site.body,
            face,
            by,
        });
    }

    fn released(&mut self, by: RoleId, role: RoleId, body: Body, _orphans: usize) {
        if let Body::Free(id) = body {
            let body = id;
            self.desk.log.note(Event::Released { body, role, by });
            let tick = self.desk.tick;
            self.desk.releases.push(ReleaseRecord {
                phase: self.desk.phase,
                parent: by,
                child: role,
                tick,
                body,
            });
            (self.desk.released).insert(id, Origin::Released { role, tick });
        }
    }

    fn reported(&mut self, by: Reporter) {
        self.desk.log.note(Event::Reported { by: by.role });
    }
}
