//! Integrator for rigid cubes that rarely touch.
use nalgebra::Vector3;
use stochc_ir::scene::ContactLaw;
use stochc_ir::table::Plate;

use super::bodies::Bodies;
use super::collision_detection::{Contacts, Ground};
use super::free_flight::FreeFlight;
use super::local_steps::LocalSteps;
use super::neighbour_list::NeighbourList;
use super::simd::Lane;
use crate::counter_rng::StepDraws;
use crate::settings::Settings;
use crate::world::blocks::Blocks;
use crate::world::free_bonds::FreeBonds;
use crate::world::motion_limits::MotionLimits;
use crate::world::parameters::{Kicks, WorldParameters};
use crate::world::stepper::{Integrator, Moving};
use crate::world::{BodyState, Fault, SceneError};

/// Integrator of the model `rigid`, in one precision.
pub(super) struct Kernel<R: Lane> {
    flight: FreeFlight<R>,
    /// Buffer for the random words of one tick.
    words: Vec<u8>,
    contacts: Option<Contacts<R>>,
    /// Neighbour list. `None` if nothing needs neighbours.
    neighbours: Option<NeighbourList<R>>,
    /// Local time steps. `None` if all blocks take the same steps.
    local: Option<LocalSteps<R>>,
    /// Steady acceleration if contacts are rigid \[block lengths / tick^2\]. Zero for compliant
    /// contacts.
    acceleration: Vector3<R>,
    limits: MotionLimits,
    /// Centres of the seeds of a planar world.
    seeds: Vec<Vector3<R>>,
}

stochc_ir::state! {
    (<R: Lane>) Kernel<R>;
    values: neighbours, local, seeds;
    parts: ;
    // Not part of the state: contacts are recomputed in every step, and the other fields are
    // constant.
    same: flight, words, contacts, acceleration, limits
}

impl<R: Lane> Integrator for Kernel<R> {
    type Real = R;
    type Blocks = Bodies<R>;

    fn rates(parameters: &WorldParameters, settings: &Settings) -> [u32; 2] {
        parameters.rates(settings)
    }

    fn span(&self, bodies: &Bodies<R>, id: u32) -> f64 {
        match self.local {
            Some(_) => (bodies.span(id) / bodies.dt).double(),
            None => 1.0,
        }
    }

    fn new(
        parameters: &WorldParameters,
        plate: &Plate,
        settings: &Settings,
        blocks: &[BodyState],
    ) -> Result<(Bodies<R>, Kernel<R>), SceneError> {
        let rates = parameters.rates(settings);
        let steps = rates.map(|rate| 1.0 / f64::from(rate));
        let limits = MotionLimits::new(rates[0], parameters.contact.is_some());
        let ground = Ground::new(parameters, plate);
        let contacts = (parameters.contact.as_ref())
            .map(|contact| Contacts::new(contact, ground, settings, blocks.len()));
        let neighbours = (contacts.is_some() || parameters.bond.is_some()).then(|| {
            let farthest = blocks.iter().map(|b| b.position.amax()).fold(0.0, f64::max);
            let is_flat = parameters.is_planar;
            let (span, floor) = match parameters.wall {
                Some(wall) => (wall.interior.reach(), Some(0.0)),
                None => (farthest, is_flat.then_some(0.0)),
            };
            NeighbourList::new(blocks.len(), span + 2.0, floor, is_flat)
        });
        let kernel = Kernel {
            flight: FreeFlight::new(
                parameters.wall,
                parameters.drag,
                limits,
                parameters.is_planar,
                steps,
            ),
            words: Vec::new(),
            contacts,
            neighbours,
            acceleration: match &parameters.contact {
                Some(contact) if matches!(contact.law, ContactLaw::Rigid { .. }) => {
                    let acceleration = parameters.acceleration.unwrap_or_else(Vector3::zeros);
                    acceleration.map(R::from_double)
                }
                _ => Vector3::zeros(),
            },
            local: (rates[0] != rates[1]).then(|| LocalSteps::new(steps)),
            limits,
            seeds: Vec::new(),
        };
        let [long, short] = steps.map(R::from_double);
        Ok((Bodies::new(blocks, long, short), kernel))
    }

    fn follow(&mut self, bodies: &Bodies<R>) -> bool {
        let neighbours = self.neighbours.as_mut();
        neighbours.is_some_and(|neighbours| neighbours.follow(bodies))
    }

    fn distance(&self, bodies: &Bodies<R>, id: Option<u32>) -> R {
        let speed = id.map_or_else(|| bodies.fastest(), |id| bodies.velocity(id).norm());
        let local = self.local.as_ref();
        local.map_or_else(R::zero, |local| local.distance(speed))
    }

    fn begin_long_step(&mut self, bodies: &mut Bodies<R>, in_field: &[u32]) {
        if let (Some(local), Some(neighbours)) = (&mut self.local, &self.neighbours) {
            local.begin(bodies, neighbours, in_field);
        }
    }

    fn short_steps(&self) -> &[u32] {
        self.local.as_ref().map_or(&[], |local| &local.blocks)
    }

    fn near(&self, _bodies: &Bodies<R>, position: Vector3<R>, reach: R, found: &mut Vec<u32>) {
        if let Some(neighbours) = &self.neighbours {
            neighbours.around(position, reach, found);
        }
    }

    fn find_contacts(&mut self, bodies: &mut Bodies<R>, bonds: Option<&FreeBonds>, moving: Moving) {
        if let (Some(contacts), Some(neighbours)) = (&mut self.contacts, &mut self.neighbours) {
            match (moving, &self.local) {
                (Moving::Short, Some(local)) => contacts.find_short(bodies, local, &self.seeds),
                _ => contacts.find(bodies, neighbours, bonds, &self.seeds),
            }
        }
    }

    fn check(&self, bodies: &Bodies<R>, id: u32) -> Result<(), Fault> {
        bodies.check(id, &self.limits)
    }

    fn pushed(&mut self, id: u32, change: Vector3<R>) {
        if let Some(contacts) = &mut self.contacts {
            contacts.solver.pushed(id, change);
        }
    }

    fn advance(
        &mut self,
        bodies: &mut Bodies<R>,
        kicks: Option<(&Kicks, StepDraws<'_>)>,
        bonds: Option<&mut FreeBonds>,
        moving: Moving,
    ) -> Result<(), Fault> {
        match (moving, &self.local) {
            (Moving::Short, Some(local)) => {
                self.flight.fly_short(bodies, &local.blocks);
                (local.blocks.iter()).try_for_each(|&id| self.check(bodies, id))?;
            }
            _ => {
                if !self.flight.fly(bodies, kicks, &mut self.words) {
                    (0..bodies.count()).try_for_each(|id| self.check(bodies, id))?;
                }
            }
        }
        self.collide(bodies)?;
        if let (Moving::All, Some(local)) = (moving, &self.local) {
            local.has_begun(bodies);
        }
        bodies.now += 1;
        if let Some(bonds) = bonds {
            let dt = bodies.dt.double();
            bonds.carry(bodies, dt);
        }
        Ok(())
    }

    fn place_seeds(&mut self, _bodies: &mut Bodies<R>, centres: &[Vector3<R>]) {
        self.seeds = centres.to_vec();
    }

    fn released(&mut self) {
        if let Some(neighbours) = &mut self.neighbours {
            neighbours.forget();
        }
    }
}

impl<R: Lane> Kernel<R> {
    /// Finds the contact impulses and applies them to the touching blocks.
    fn collide(&mut self, bodies: &mut Bodies<R>) -> Result<(), Fault> {
        let Some(contacts) = &mut self.contacts else {
            return Ok(());
        };
        let (mut result, limits, wall) = (Ok(()), &self.limits, self.flight.wall);
        let acceleration = self.acceleration;
        let push = |position| {
            let inward = wall.map_or_else(Vector3::zeros, |wall| wall.push(position));
            inward + acceleration
        };
        (contacts.solver).solve(bodies, push, |id, motion, rotation| {
            if result.is_ok() {
                result = limits.check(id, motion, rotation);
            }
        });
        result
    }
}
