//! The terms of a scene put together, one substep after the other.
use nalgebra::Vector3;
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};
use stochc_protocol::Orientation;

use super::bodies::Bodies;
use super::detect::Shape;
use super::fault;
use super::flight::Flight;
use super::lanes::Lane;
use super::neighbours::Neighbours;
use super::solver::Solver;
use crate::draw::{Draws, Stream};
use crate::settings::{ROUNDS, Reduction, Settings};
use crate::world::ambient::{Ambient, Response};
use crate::world::free_bonds::FreeBonds;
use crate::world::groups::Flock;
use crate::world::limits::Limits;
use crate::world::magnet::{Faces, Release};
use crate::world::plate::Seats;
use crate::world::real::cast;
use crate::world::terms::{Contact, Kicks, Shell, Terms, built};
use crate::world::{BlockFace, Body, BodyState, Docking, Fault};

/// A world in one precision.
pub(super) struct Kernel<R: Lane> {
    tick: u64,
    substeps: u32,
    pub(super) bodies: Bodies<R>,
    flight: Flight<R>,
    kicks: Option<(Kicks, Draws)>,
    /// The words of one tick, kept to be used again.
    words: Vec<u8>,
    pub(super) contacts: Option<Contacts<R>>,
    faces: Option<Faces<R>>,
    /// `None` where nothing is around the blocks.
    ambient: Option<Ambient>,
    response: Response,
    /// `None` where free blocks do not bond to each other.
    pub(super) free_bonds: Option<FreeBonds>,
    /// The free blocks, kept to be used again.
    free: Vec<u32>,
    /// `None` where nobody asks who is near whom.
    pub(super) neighbours: Option<Neighbours<R>>,
    /// Somebody has set a block in motion by hand.
    doubtful: bool,
    /// Something has moved since it was looked who is where.
    stale: bool,
    /// A face does not know yet who is near it.
    blind: bool,
    /// The blocks near a face, kept to be used again.
    nearby: Vec<u32>,
    seats: Seats,
    turns: bool,
    limits: Limits,
}

/// Who can touch what.
pub(super) struct Contacts<R: Lane> {
    pub shape: Shape<R>,
    pub solver: Solver<R>,
    /// Free blocks touch each other, and not only what does not move.
    pub mutual: bool,
    /// Who may touch the ground, and who each other; kept to be used again.
    pub low: Vec<u32>,
    pub close: Vec<(u32, u32)>,
}

impl<R: Lane> Kernel<R> {
    pub fn new(
        terms: Terms,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
        blocks: &[BodyState],
    ) -> Kernel<R> {
        let substeps = settings.substeps.max(1);
        let dt = 1.0 / f64::from(substeps);
        let without = |reduction| settings.reduction == Some(reduction);
        let rounds = settings.solver_iterations.unwrap_or(ROUNDS);
        let turns = !without(Reduction::NoRotation);
        let limits = Limits::new(substeps, terms.contact.is_some());
        let ambient = Ambient::new(&terms, substeps, seed, run);
        let response = ambient.as_ref().map_or(Response::FREE, Ambient::response);
        let contacts = terms.contact.clone().map(|contact| {
            let contact = Contact {
                law: contact.law_with(response.linear),
                friction: if without(Reduction::NoFriction) {
                    0.0
                } else {
                    contact.friction
                },
            };
            Contacts {
                shape: Shape::new(terms.shell.is_some(), plate, without(Reduction::Spheres)),
                solver: Solver::new(&contact, blocks.len(), rounds, turns),
                mutual: !without(Reduction::NoBlockContact),
                low: Vec::new(),
                close: Vec::new(),
            }
        });
        let faces = terms.bond.map(Faces::new);
        let free_bonds = terms.bond.as_ref().and_then(FreeBonds::new);
        let shell = terms.shell.map(|shell| Shell {
            stiffness: shell.stiffness * response.linear,
            ..shell
        });
        let neighbours = (contacts.is_some() || faces.is_some()).then(|| {
            let farthest = blocks.iter().map(|b| b.position.amax()).fold(0.0, f64::max);
            let (span, floor) = match terms.shell {
                Some(shell) => (shell.radius + shell.height, Some(0.0)),
                None => (farthest, None),
            };
            Neighbours::new(blocks.len(), span + 2.0, floor)
        });
        Kernel {
            tick: 0,
            substeps,
            bodies: Bodies::new(blocks, R::of(dt)),
            flight: Flight::new(shell, terms.drag, limits, dt),
            kicks: terms
                .kicks
                .map(|kicks| (kicks, Draws::new(seed, run, Stream::Kick))),
            words: Vec::new(),
            contacts,
            faces,
            ambient,
            response,
            free_bonds,
            free: Vec::new(),
            neighbours,
            doubtful: true,
            stale: true,
            blind: true,
            nearby: Vec::new(),
            seats: Seats::new(plate),
            turns,
            limits,
        }
    }

    pub fn count(&self) -> usize {
        self.bodies.count()
    }

    pub fn tick(&self) -> u64 {
        self.tick
    }

    pub fn state(&self, id: u32) -> BodyState {
        self.bodies.state(id as usize)
    }

    pub fn set_state(&mut self, id: u32, state: &BodyState) {
        if self.bodies.is_free(id as usize) {
            self.bodies.set_state(id as usize, state);
            self.doubtful = true;
            self.disturb();
        }
    }

    pub fn anchored(&self, id: u32) -> Option<Orientation> {
        self.bodies.anchored[id as usize]
    }

    pub fn active(&self) -> Vec<(BlockFace, u32)> {
        self.faces.iter().flat_map(Faces::active).collect()
    }

    pub fn entries(&self, site: BlockFace) -> u32 {
        self.faces.as_ref().map_or(0, |faces| faces.entries(site))
    }

    pub fn in_reach(&self) -> Vec<(BlockFace, u32, u64)> {
        self.faces.iter().flat_map(Faces::in_reach).collect()
    }

    pub fn groups(&self) -> Vec<Vec<u32>> {
        let groups = self.free_bonds.as_ref().map(|bonds| bonds.groups.list());
        groups.unwrap_or_default()
    }

    pub fn centre(&self, cell: Cell) -> Vector3<f64> {
        self.seats.centre(cell)
    }

    pub fn magnetize(&mut self, site: BlockFace) {
        let (centre, orientation) = match site.body {
            Body::Seed(cell) => (cast(self.seats.centre(cell)), Orientation::IDENTITY),
            Body::Free(id) => {
                let i = id as usize;
                let Some(orientation) = self.bodies.anchored[i] else {
                    return;
                };
                (self.bodies.centre(i), orientation)
            }
        };
        if let Some(faces) = &mut self.faces
            && faces.magnetize(site, centre, orientation)
        {
            (self.stale, self.blind) = (true, true);
        }
    }

    pub fn plant(&mut self, site: BlockFace) -> Option<Docking> {
        self.magnetize(site);
        let id = (0..self.count()).rev().find(|&i| self.bodies.is_free(i))? as u32;
        let (held, docking) = self.faces.as_mut()?.plant(site, id, self.tick)?;
        (self.bodies).anchor(id as usize, held.seat, held.orientation);
        self.disturb();
        self.blind = true;
        Some(docking)
    }

    pub fn switch_off(&mut self, site: BlockFace) {
        let Some(faces) = &mut self.faces else {
            return;
        };
        if let Some(Release { body: id, velocity }) = faces.switch_off(site) {
            self.bodies.release(id as usize);
            if let Some(neighbours) = &mut self.neighbours {
                neighbours.forget();
            }
            self.bodies.set_velocity(id as usize, velocity);
            self.disturb();
            self.blind = true;
            for face in Face::ALL {
                let body = Body::Free(id);
                self.switch_off(BlockFace { body, face });
            }
        }
    }

    pub fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        if std::mem::take(&mut self.doubtful)
            && let Some(fault) = fault::find(&self.bodies, &self.limits)
        {
            return Err(fault);
        }
        for substep in 0..self.substeps {
            self.refresh();
            if let (true, Some(faces)) = (built::BOND, &mut self.faces) {
                faces.survey(self.tick, &mut self.bodies);
            }
            self.detect();
            self.surround(substep)?;
            self.pull()?;
            self.settle();
            let kicks = self.kicks.as_mut().filter(|_| substep == 0);
            let kicks = kicks.map(|(kicks, draws)| (&*kicks, draws.step(self.tick)));
            let sound = self.flight.fly(&mut self.bodies, kicks, &mut self.words);
            if !sound && let Some(fault) = fault::find(&self.bodies, &self.limits) {
                return Err(fault);
            }
            self.collide()?;
            self.bodies.now += 1;
            self.carry();
            self.stale = true;
            self.refresh();
            self.capture(dockings);
        }
        self.tick += 1;
        Ok(())
    }

    /// Something other than a step has moved, freed or fixed a block.
    fn disturb(&mut self) {
        self.stale = true;
        if let Some(faces) = &mut self.faces {
            faces.disturb();
        }
    }

    /// Looks again who is where, if something has moved.
    fn refresh(&mut self) {
        let (true, Some(neighbours)) = (self.stale, &mut self.neighbours) else {
            return;
        };
        self.stale = false;
        let anew = neighbours.follow(&self.bodies);
        if let Some(faces) = &mut self.faces
            && (anew || self.blind)
        {
            self.blind = false;
            for active in 0..faces.count() {
                let centre = faces.centre(active).into();
                neighbours.around(centre, faces.horizon(), &mut self.nearby);
                faces.set_nearby(active, self.nearby.iter().copied());
            }
        }
    }

    /// What is around the blocks, for each of them alone.
    fn surround(&mut self, substep: u32) -> Result<(), Fault> {
        let (true, Some(ambient)) = (built::FLUID || built::GRAVITY, &mut self.ambient) else {
            return Ok(());
        };
        let sinks = self
            .faces
            .as_mut()
            .filter(|_| built::BOND)
            .map(Faces::sinks);
        let sinks = sinks.unwrap_or_default();
        ambient.begin(self.tick, substep, self.bodies.now);
        for i in 0..self.bodies.count() {
            if !self.bodies.is_free(i) {
                continue;
            }
            let id = i as u32;
            let mut motion = self.bodies.motion(id);
            ambient.act(id, &mut motion, &sinks);
            if !self.turns {
                motion.spin = Vector3::zeros();
            }
            (self.bodies).set_velocity_of(id, motion.velocity, motion.spin);
            fault::check(&self.bodies, &self.limits, i)?;
        }
        Ok(())
    }

    /// What free blocks do to each other from afar, and what becomes of groups.
    fn settle(&mut self) {
        let (true, Some(bonds)) = (built::BOND, &mut self.free_bonds) else {
            return;
        };
        let (dt, response) = (self.bodies.dt.double(), self.response);
        self.bodies.list_free(&mut self.free);
        bonds.pull(&self.free, &mut self.bodies, dt, response);
        bonds.settle(&mut self.bodies, dt, response);
    }

    /// Keeps groups together after their blocks have been moved one by one.
    fn carry(&mut self) {
        if let (true, Some(bonds)) = (built::BOND, &mut self.free_bonds) {
            let dt = self.bodies.dt.double();
            bonds.carry(&mut self.bodies, dt);
        }
    }

    /// The magnets' part.
    fn pull(&mut self) -> Result<(), Fault> {
        let (true, Some(faces)) = (built::BOND, &mut self.faces) else {
            return Ok(());
        };
        let mut pushes = Vec::new();
        faces.pull(&mut self.bodies, |id, push| pushes.push((id, push)));
        for (id, push) in pushes {
            let i = id as usize;
            let (linear, angular) = (R::of(self.response.linear), R::of(self.response.angular));
            let velocity = self.bodies.velocity(i) + push.linear * (self.bodies.dt * linear);
            self.bodies.set_velocity(i, velocity);
            if self.turns {
                // What it is turned by now, it was turned to before its spin changes.
                self.bodies.rotation_now(i);
                let change = push.angular * (self.bodies.dt * angular);
                self.bodies.spin[i] += change;
            }
            fault::check(&self.bodies, &self.limits, i)?;
        }
        Ok(())
    }

    /// Corrects the motion of the blocks that touch something.
    fn collide(&mut self) -> Result<(), Fault> {
        let (true, Some(contacts)) = (built::CONTACT, &mut self.contacts) else {
            return Ok(());
        };
        let (mut sound, limits) = (Ok(()), &self.limits);
        let shell = self.flight.shell;
        let late = |place| shell.map_or_else(Vector3::zeros, |shell| shell.half_push(place));
        contacts.solver.solve(&mut self.bodies, late, |bodies, i| {
            if sound.is_ok() {
                sound = fault::check(bodies, limits, i);
            }
        });
        sound
    }

    fn capture(&mut self, dockings: &mut Vec<Docking>) {
        let (true, Some(faces)) = (built::BOND, &mut self.faces) else {
            return;
        };
        let mut held = Vec::new();
        faces.capture(self.tick, &mut self.bodies, |block, docking| {
            held.push(block);
            dockings.push(docking);
        });
        for block in held {
            if let (Some(bonds), Some(faces)) = (&mut self.free_bonds, &mut self.faces) {
                let hanging = bonds.leave(block.body, &mut self.bodies);
                hanging.into_iter().for_each(|body| faces.reject(body));
            }
            self.bodies
                .anchor(block.body as usize, block.seat, block.orientation);
            self.disturb();
            self.blind = true;
        }
        if let Some(bonds) = &mut self.free_bonds {
            self.bodies.list_free(&mut self.free);
            let dt = self.bodies.dt.double();
            if bonds.join(&self.free, &mut self.bodies, dt) {
                self.disturb();
            }
        }
    }
}
