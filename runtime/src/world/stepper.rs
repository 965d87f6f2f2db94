//! Order of operations in a step of a world of rigid blocks, for all integrators.
//!
//! A substep has four stages. The first finds neighbours and contacts. The second changes
//! velocities by external forces, faces, free bonds and heat. In the third, the integrator moves
//! all blocks with collisions. The last makes captures and bonds. Positions move with the new
//! velocities, so this is the symplectic Euler method.
use nalgebra::Vector3;
use stochc_control::Orientation;
use stochc_ir::scene::Scene;
use stochc_ir::state::State;
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};

use super::blocks::{Blocks, Motion};
use super::bonding::{Anchored, Faces, ReleasedBlock};
use super::cell_centres::CellCentres;
use super::external_forces::{ExternalForces, Response};
use super::free_bonds::FreeBonds;
use super::parameters::{Kicks, WorldParameters};
use super::real::{Real, cast};
use super::{
    BlockFace, Body, BodyState, Docking, Fault, FreeBond, SceneError, SpatialWorld, World,
};
use crate::counter_rng::{Draws, StepDraws, Stream};
use crate::settings::{Reduction, Settings};

/// Set of the blocks that move in a short step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Moving {
    /// All blocks. Blocks with long steps move by a whole long step.
    All,
    /// Only blocks with short steps.
    Short,
}

/// Method that moves and collides blocks. The worlds of rigid blocks differ only in this method.
pub(crate) trait Integrator: Sized + State {
    type Real: Real;
    type Blocks: Blocks<Real = Self::Real> + State;

    /// Returns the numbers of long and of short steps per tick.
    fn rates(_parameters: &WorldParameters, settings: &Settings) -> [u32; 2] {
        [settings.substeps.max(1); 2]
    }

    /// Returns blocks and an integrator for the terms of a scene. Forces and impulses are already
    /// scaled by [`WorldParameters::weakened`].
    ///
    /// # Errors
    ///
    /// If a term or a setting is not supported.
    fn new(
        parameters: &WorldParameters,
        plate: &Plate,
        settings: &Settings,
        blocks: &[BodyState],
    ) -> Result<(Self::Blocks, Self), SceneError>;

    /// Updates the neighbour search to the current positions. Returns whether results of
    /// [`Integrator::near`] may have changed.
    fn follow(&mut self, _blocks: &Self::Blocks) -> bool {
        false
    }

    /// Lists the blocks that may come within `reach` of a position until [`Integrator::follow`]
    /// next returns `true`. The list is in ascending order.
    fn near(
        &self,
        blocks: &Self::Blocks,
        position: Vector3<Self::Real>,
        reach: Self::Real,
        found: &mut Vec<u32>,
    );

    /// Returns the largest distance that block `_id` may move in a long step \[block lengths\]. If
    /// `_id` is `None`, returns this distance for the fastest block. Returns 0 if all steps are
    /// equally long.
    fn distance(&self, _blocks: &Self::Blocks, _id: Option<u32>) -> Self::Real {
        Self::Real::from_double(0.0)
    }

    /// Begins a long step with short steps for some blocks. `in_field` are the blocks that may
    /// enter the field of a magnetized face, in ascending order.
    fn begin_long_step(&mut self, _blocks: &mut Self::Blocks, _in_field: &[u32]) {}

    fn short_steps(&self) -> &[u32] {
        &[]
    }

    /// Returns the number of short steps over which forces act before a block's next move.
    fn span(&self, _blocks: &Self::Blocks, _id: u32) -> f64 {
        1.0
    }

    /// Finds contacts, before any velocity changes.
    fn find_contacts(
        &mut self,
        _blocks: &mut Self::Blocks,
        _bonds: Option<&FreeBonds>,
        _who: Moving,
    ) {
    }

    /// Records the velocity change of a block by forces other than enclosure, weight and drag.
    fn pushed(&mut self, _id: u32, _change: Vector3<Self::Real>) {}

    /// Checks a block after a force changed its motion. Unnecessary if [`Integrator::advance`]
    /// checks all blocks.
    ///
    /// # Errors
    ///
    /// If its motion is invalid.
    fn check(&self, _blocks: &Self::Blocks, _id: u32) -> Result<(), Fault> {
        Ok(())
    }

    /// Moves all blocks by a substep, with enclosure, random impulses, linear drag and collisions.
    /// Groups stay together.
    ///
    /// # Errors
    ///
    /// If the motion of a block becomes invalid.
    fn advance(
        &mut self,
        blocks: &mut Self::Blocks,
        kicks: Option<(&Kicks, StepDraws<'_>)>,
        bonds: Option<&mut FreeBonds>,
        moving: Moving,
    ) -> Result<(), Fault>;

    /// Adds the seeds of a planar world as obstacles.
    fn place_seeds(&mut self, _blocks: &mut Self::Blocks, _centres: &[Vector3<Self::Real>]) {}

    /// Records that an anchored block was released.
    fn released(&mut self) {}

    /// Records that free blocks may have bonded and moved.
    fn joined(&mut self, _blocks: &mut Self::Blocks, _bonds: &FreeBonds) {}
}

/// World of rigid cubes moved by an integrator.
pub(crate) struct Stepper<I: Integrator> {
    tick: u64,
    /// Number of short steps per tick.
    substeps: u32,
    /// Number of short steps per long step.
    ratio: u32,
    /// Length of a short step \[tick\].
    dt: I::Real,
    blocks: I::Blocks,
    integrator: I,
    kicks: Option<(Kicks, Draws)>,
    faces: Option<Faces<I::Real>>,
    external_forces: Option<ExternalForces>,
    response: Response,
    /// `None` if free blocks do not bond.
    free_bonds: Option<FreeBonds>,
    /// Buffer of free blocks.
    free: Vec<u32>,
    /// Buffer of blocks near a face.
    nearby: Vec<u32>,
    /// Whether the motion of a block was set from outside and needs checking.
    unchecked: bool,
    /// Whether blocks have moved since the last neighbour search.
    stale: bool,
    /// Whether a face has no list of nearby blocks yet.
    blind: bool,
    cells: CellCentres,
    turns: bool,
    /// Whether blocks move only in a horizontal plane.
    is_planar: bool,
}

stochc_ir::state! {
    (<I: Integrator>) Stepper<I>;
    values: tick, unchecked, stale, blind;
    parts: blocks, integrator, faces, external_forces, free_bonds;
    same: substeps, ratio, dt, kicks, response, free, nearby, cells, turns, is_planar
}

impl<I: Integrator> Stepper<I> {
    /// Invalidates search results after a block was moved, released or anchored outside a step.
    fn disturb(&mut self) {
        self.stale = true;
        if let Some(faces) = &mut self.faces {
            faces.disturb();
        }
    }

    /// Begins a long step: finds blocks near faces and assigns short steps to them.
    fn split(&mut self) {
        self.refresh();
        let mut in_field = Vec::new();
        if let Some(faces) = &mut self.faces
            && faces.count() > 0
        {
            let fastest = self.integrator.distance(&self.blocks, None);
            for active in 0..faces.count() {
                let (centre, horizon) = (faces.centre(active), faces.horizon());
                let reach = horizon + fastest;
                (self.integrator).near(&self.blocks, centre, reach, &mut self.nearby);
                self.nearby.retain(|&id| {
                    let most = horizon + self.integrator.distance(&self.blocks, Some(id));
                    let square = (self.blocks.position(id) - centre).norm_squared();
                    self.blocks.is_free(id) && square < most * most
                });
                faces.set_nearby(active, &self.nearby);
                in_field.extend_from_slice(&self.nearby);
            }
        }
        in_field.sort_unstable();
        in_field.dedup();
        (self.integrator).begin_long_step(&mut self.blocks, &in_field);
        // The lists remain valid during the long step.
        self.blind = false;
    }

    /// Repeats the neighbour search if a block has moved.
    fn refresh(&mut self) {
        if !std::mem::take(&mut self.stale) {
            return;
        }
        let rebuilt = self.integrator.follow(&self.blocks);
        if let Some(faces) = &mut self.faces
            && self.ratio == 1
            && (rebuilt || self.blind)
        {
            self.blind = false;
            for active in 0..faces.count() {
                let (centre, horizon) = (faces.centre(active), faces.horizon());
                (self.integrator).near(&self.blocks, centre, horizon, &mut self.nearby);
                faces.set_nearby(active, &self.nearby);
            }
        }
    }

    /// Finds the blocks near faces, and all contacts.
    fn survey(&mut self, moving: Moving) {
        if self.ratio == 1 {
            self.refresh();
        }
        if let Some(faces) = &mut self.faces {
            faces.survey(self.tick, &mut self.blocks);
        }
        (self.integrator).find_contacts(&mut self.blocks, self.free_bonds.as_ref(), moving);
    }

    /// Applies external forces to each block.
    fn surround(&mut self, substep: u32, moving: Moving) -> Result<(), Fault> {
        let Some(external_forces) = &mut self.external_forces else {
            return Ok(());
        };
        let step = self.tick * u64::from(self.substeps) + u64::from(substep);
        external_forces.begin(self.tick, substep, step);
        let sinks = self.faces.as_mut().map(Faces::sinks).unwrap_or_default();
        self.change(moving, |external_forces, _, motion, span| {
            external_forces.act(motion, &sinks, span);
        })
    }

    /// Applies Brownian motion, then friction with the table. They never break bonds: groups absorb
    /// them at any load.
    fn shake(&mut self, moving: Moving) -> Result<(), Fault> {
        let external_forces = self.external_forces.as_ref();
        if !external_forces.is_some_and(|forces| forces.has_heat() || forces.has_table()) {
            return Ok(());
        }
        self.change(moving, |external_forces, id, motion, span| {
            external_forces.shake(id, motion);
            external_forces.rub(motion, span);
        })?;
        if let Some(bonds) = &self.free_bonds {
            bonds.stiffen(&mut self.blocks);
        }
        Ok(())
    }

    /// Applies `by` to the motion of each moving block, in ascending order.
    fn change(
        &mut self,
        moving: Moving,
        mut by: impl FnMut(&mut ExternalForces, u32, &mut Motion, f64),
    ) -> Result<(), Fault> {
        let Some(external_forces) = &mut self.external_forces else {
            return Ok(());
        };
        match moving {
            Moving::All => self.blocks.list_free(&mut self.free),
            Moving::Short => {
                self.free.clear();
                let short = self.integrator.short_steps().iter().copied();
                self.free
                    .extend(short.filter(|&id| self.blocks.is_free(id)));
            }
        }
        for &id in &self.free {
            let mut motion = self.blocks.motion(id);
            let spin = motion.spin;
            let span = self.integrator.span(&self.blocks, id);
            by(external_forces, id, &mut motion, span);
            // If blocks do not turn, only groups rotate.
            if !self.turns {
                motion.spin = spin;
            }
            if self.is_planar {
                in_plane(&mut motion.velocity, &mut motion.spin);
            }
            self.blocks.set_motion(id, motion.velocity, motion.spin);
            self.integrator.check(&self.blocks, id)?;
        }
        Ok(())
    }

    /// Applies the forces of faces to blocks within reach.
    fn pull(&mut self) -> Result<(), Fault> {
        let Some(faces) = &mut self.faces else {
            return Ok(());
        };
        let [linear, angular] =
            [self.response.linear, self.response.angular].map(I::Real::from_double);
        let mut pushes = Vec::new();
        faces.pull(&mut self.blocks, |id, push| pushes.push((id, push)));
        for (id, mut push) in pushes {
            if self.is_planar {
                in_plane(&mut push.linear, &mut push.angular);
            }
            let change = push.linear * (self.dt * linear);
            let velocity = self.blocks.velocity(id) + change;
            self.integrator.pushed(id, change);
            let mut spin = self.blocks.spin(id);
            if self.turns {
                spin += push.angular * (self.dt * angular);
            }
            self.blocks.set_velocity(id, velocity, spin);
            self.integrator.check(&self.blocks, id)?;
        }
        Ok(())
    }

    /// Applies forces between free blocks, and updates groups.
    fn settle(&mut self) {
        let Some(bonds) = &mut self.free_bonds else {
            return;
        };
        let dt = self.dt.double();
        self.blocks.list_free(&mut self.free);
        bonds.pull(&self.free, &mut self.blocks, dt, self.turns);
        bonds.settle(&mut self.blocks, dt);
    }

    fn advance(&mut self, substep: u32, moving: Moving) -> Result<(), Fault> {
        let kicks = self.kicks.as_mut().filter(|_| substep == 0);
        let kicks = kicks.map(|(kicks, draws)| (&*kicks, draws.step(self.tick)));
        (self.integrator).advance(&mut self.blocks, kicks, self.free_bonds.as_mut(), moving)?;
        self.stale = true;
        Ok(())
    }

    fn capture(&mut self, substep: u32, dockings: &mut Vec<Docking>) {
        if self.ratio == 1 {
            self.refresh();
        }
        let Some(faces) = &mut self.faces else {
            return;
        };
        let mut held = Vec::new();
        let bonds = self.free_bonds.as_ref();
        let is_bonded = |id, face| bonds.is_some_and(|bonds| bonds.groups.is_bonded(id, face));
        faces.capture(
            self.tick,
            substep + 1 == self.substeps,
            self.dt,
            &mut self.blocks,
            is_bonded,
            |block, docking| {
                held.push(block);
                dockings.push(docking);
            },
        );
        for block in held {
            if let (Some(bonds), Some(faces)) = (&mut self.free_bonds, &mut self.faces) {
                let hanging = bonds.leave(block.body, &mut self.blocks);
                hanging.into_iter().for_each(|body| faces.reject(body));
            }
            self.anchor(&block);
        }
    }

    fn anchor(&mut self, held: &Anchored<I::Real>) {
        (self.blocks).anchor(held.body, held.seat, held.orientation);
        self.disturb();
        self.blind = true;
    }

    /// Bonds free blocks that are close enough.
    fn join(&mut self, substep: u32) {
        let Some(bonds) = &mut self.free_bonds else {
            return;
        };
        if bonds.are_sampled() && substep + 1 < self.substeps {
            return;
        }
        self.blocks.list_free(&mut self.free);
        let joined = bonds.join(&self.free, &mut self.blocks, self.dt.double());
        self.integrator.joined(&mut self.blocks, bonds);
        if joined {
            self.disturb();
        }
    }
}

/// Removes the components of a linear and an angular vector that leave the plane of a planar world.
fn in_plane<R: Real>(linear: &mut Vector3<R>, angular: &mut Vector3<R>) {
    linear.z = R::zero();
    (angular.x, angular.y) = (R::zero(), R::zero());
}

impl<I: Integrator> SpatialWorld for Stepper<I> {
    fn with_blocks(
        scene: &Scene,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
        blocks: &[BodyState],
    ) -> Result<Stepper<I>, SceneError> {
        let parameters = WorldParameters::new(scene, plate)?;
        parameters.check(settings)?;
        let rates = I::rates(&parameters, settings);
        let substeps = rates[1];
        let external_forces = ExternalForces::new(&parameters, substeps, seed, run);
        let response = external_forces
            .as_ref()
            .map_or(Response::FREE, ExternalForces::response);
        let parameters = parameters.weakened(response.linear, 1.0 / f64::from(substeps));
        let (blocks, integrator) = I::new(&parameters, plate, settings, blocks)?;
        Ok(Stepper {
            tick: 0,
            substeps,
            ratio: substeps / rates[0],
            dt: I::Real::from_double(1.0 / f64::from(substeps)),
            blocks,
            integrator,
            kicks: (parameters.kicks).map(|kicks| (kicks, Draws::new(seed, run, Stream::Kick))),
            faces: parameters.bond.map(Faces::new),
            external_forces,
            response,
            free_bonds: (parameters.bond.as_ref())
                .and_then(|magnet| FreeBonds::new(magnet, response)),
            free: Vec::new(),
            nearby: Vec::new(),
            unchecked: true,
            stale: true,
            blind: true,
            cells: CellCentres::new(plate),
            turns: settings.reduction != Some(Reduction::Rotation),
            is_planar: parameters.is_planar,
        })
    }

    fn count(&self) -> u32 {
        self.blocks.count()
    }

    fn state(&self, id: u32) -> BodyState {
        self.blocks.state(id)
    }

    fn set_state(&mut self, id: u32, state: &BodyState) {
        if self.blocks.is_free(id) {
            self.blocks.set_state(id, state);
            self.unchecked = true;
            self.disturb();
        }
    }

    fn anchored(&self, id: u32) -> Option<Orientation> {
        self.blocks.anchored(id)
    }

    fn active(&self) -> Vec<(BlockFace, u32)> {
        self.faces.iter().flat_map(Faces::active).collect()
    }

    fn groups(&self) -> Vec<Vec<u32>> {
        let groups = self.free_bonds.as_ref().map(|bonds| bonds.groups.list());
        groups.unwrap_or_default()
    }

    fn free_bonds(&self) -> Vec<FreeBond> {
        let bonds = self
            .free_bonds
            .as_ref()
            .map(|bonds| bonds.groups.bonded_faces());
        bonds.unwrap_or_default()
    }

    fn in_reach(&self) -> Vec<(BlockFace, u32, u64)> {
        self.faces.iter().flat_map(Faces::in_reach).collect()
    }

    fn centre(&self, cell: Cell) -> Vector3<f64> {
        self.cells.centre(cell)
    }
}

impl<I: Integrator> World for Stepper<I> {
    fn tick(&self) -> u64 {
        self.tick
    }

    fn place_seeds(&mut self, cells: &[Cell]) {
        if self.is_planar {
            let centres: Vec<_> = (cells.iter())
                .map(|&cell| cast(self.cells.centre(cell)))
                .collect();
            self.integrator.place_seeds(&mut self.blocks, &centres);
        }
        if let Some(faces) = &mut self.faces {
            let at = |&cell: &Cell| (cell, cast(self.cells.centre(cell)));
            faces.place_seeds(cells.iter().map(at));
            (self.stale, self.blind) = (true, true);
        }
    }

    fn magnetize(&mut self, block_face: BlockFace) {
        let (centre, orientation) = match block_face.body {
            Body::Seed(cell) => (cast(self.cells.centre(cell)), Orientation::IDENTITY),
            Body::Free(id) => {
                let Some(orientation) = self.blocks.anchored(id) else {
                    return;
                };
                (self.blocks.position(id), orientation)
            }
        };
        if let Some(faces) = &mut self.faces
            && faces.magnetize(block_face, centre, orientation)
        {
            (self.stale, self.blind) = (true, true);
        }
    }

    fn switch_off(&mut self, block_face: BlockFace) {
        let Some(faces) = &mut self.faces else {
            return;
        };
        if let Some(ReleasedBlock { body: id, impulse }) = faces.switch_off(block_face) {
            self.blocks.release(id);
            if let Some(bonds) = &mut self.free_bonds {
                bonds.reject(id, cast(impulse));
            }
            self.integrator.released();
            self.disturb();
            self.blind = true;
            for face in Face::ALL {
                let body = Body::Free(id);
                self.switch_off(BlockFace { body, face });
            }
        }
    }

    fn plant(&mut self, block_face: BlockFace) -> Option<Docking> {
        self.magnetize(block_face);
        let id = (0..self.count())
            .rev()
            .find(|&id| self.blocks.is_free(id))?;
        let (held, docking) = self.faces.as_mut()?.plant(block_face, id, self.tick)?;
        self.anchor(&held);
        Some(docking)
    }

    fn entries(&self, block_face: BlockFace) -> u32 {
        self.faces
            .as_ref()
            .map_or(0, |faces| faces.entries(block_face))
    }

    fn largest_group(&self) -> u32 {
        let sizes = self.groups().into_iter().map(|group| group.len() as u32);
        sizes.max().unwrap_or(1)
    }

    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        if std::mem::take(&mut self.unchecked) {
            (0..self.count()).try_for_each(|id| self.integrator.check(&self.blocks, id))?;
        }
        for substep in 0..self.substeps {
            let begins = substep % self.ratio == 0;
            if begins && self.ratio > 1 {
                self.split();
            }
            let moving = if begins { Moving::All } else { Moving::Short };
            self.survey(moving);
            self.surround(substep, moving)?;
            self.pull()?;
            self.settle();
            self.shake(moving)?;
            self.advance(substep, moving)?;
            self.capture(substep, dockings);
            self.join(substep);
        }
        self.tick += 1;
        Ok(())
    }
}
