//! Open faces: blocks within reach, captures, and the block that each face holds.
use std::collections::BTreeMap;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use stochc_control::Orientation;
use stochc_ir::{Cell, Face};

use super::face_attraction::{AttractingFace, Near, VelocityChange, best_turn};
use super::hydraulic_network::Pressures;
use super::open_faces::PlacedBlocks;
use super::swept_docking::FaceSweep;
use crate::world::blocks::Blocks;
use crate::world::external_forces::Sink;
use crate::world::parameters::{Attraction, Magnet};
use crate::world::real::{Real, cast, normal};
use crate::world::{BlockFace, Body, Docking};

/// Distance from the centre of a block to its faces \[block lengths\].
const INSIDE: f64 = 0.5;

/// All magnetized faces of a world and the blocks that they hold.
#[derive(Clone, Debug)]
pub(crate) struct Faces<R: Real> {
    magnet: Magnet,
    /// Open faces, sorted by site.
    active: Vec<Active<R>>,
    /// Faces that always attract, but have a block in front that they do not hold. They keep their
    /// entry counts, because the block may leave.
    covered: Vec<Active<R>>,
    holds: BTreeMap<BlockFace, u32>,
    /// Blocks within reach of open faces, by face and number.
    candidates: Vec<DockingCandidate<R>>,
    /// Whether the candidates match the current positions.
    seen: bool,
    /// Positions of all structure blocks, for faces that always attract.
    placed: PlacedBlocks<R>,
    /// Rejected blocks that are still within the docking window of a face.
    rejected: Vec<u32>,
    /// Pressures in the chambers of all blocks, for faces that draw fluid. `None` until they are
    /// computed.
    pressures: Option<Pressures>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct ReleasedBlock<R: Real> {
    pub body: u32,
    /// Velocity change by the rejection, applied in the next step.
    pub impulse: Vector3<R>,
}

/// Face that is on and has no attached block.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
struct Active<R: Real> {
    block_face: BlockFace,
    target: AttractingFace<R>,
    /// Number of entries of blocks into the face's reach.
    entries: u32,
    /// Blocks within reach in the order of their entry: number, and tick of entry.
    inside: Vec<(u32, u64)>,
    /// Blocks that may be within reach, in ascending order.
    nearby: Vec<u32>,
    /// Centre of the block that the face would capture.
    seat: Vector3<R>,
    /// Orientation of the block that owns the face.
    parent: Orientation,
}

/// Free block within reach of an open face.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
struct DockingCandidate<R: Real> {
    /// Index of the open face.
    active: usize,
    body: u32,
    near: Near<R>,
}

/// Block that has just been captured, with its position and orientation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anchored<R: Real> {
    pub body: u32,
    /// Position of the captured block's centre.
    pub seat: Vector3<R>,
    pub orientation: Orientation,
}

stochc_ir::state! {
    (<R: Real>) Faces<R>;
    values: active, covered, holds, candidates, seen, placed, rejected, pressures;
    parts: ;
    same: magnet
}

impl<R: Real> Active<R> {
    fn new(block_face: BlockFace, centre: Vector3<R>, parent: Orientation) -> Active<R> {
        let face = parent.to_structure(block_face.face);
        Active {
            block_face,
            target: AttractingFace::new(centre, face),
            entries: 0,
            inside: Vec::new(),
            nearby: Vec::new(),
            seat: centre + normal::<R>(face.normal()),
            parent,
        }
    }
}

impl<R: Real> Faces<R> {
    pub fn new(magnet: Magnet) -> Faces<R> {
        Faces {
            magnet,
            active: Vec::new(),
            covered: Vec::new(),
            holds: BTreeMap::new(),
            candidates: Vec::new(),
            seen: false,
            placed: PlacedBlocks::default(),
            rejected: Vec::new(),
            pressures: None,
        }
    }

    /// Adds blocks of the plate to the structure. If the faces of the scene always attract, the
    /// faces of these blocks attract from now on.
    pub fn place_seeds(&mut self, seeds: impl Iterator<Item = (Cell, Vector3<R>)>) {
        if let Attraction::Passive(_) = self.magnet.law {
            for (cell, centre) in seeds {
                self.placed
                    .insert(Body::Seed(cell), centre, Orientation::IDENTITY);
            }
            self.expose();
        }
    }

    /// Switches a face on, unless it is on or holds a block. The owner of the face is at `centre`.
    ///
    /// If the faces of the scene always attract, all faces of the owner attract from now on.
    /// Returns whether new faces are on. They need a call of [`Faces::set_nearby`].
    pub fn magnetize(
        &mut self,
        block_face: BlockFace,
        centre: Vector3<R>,
        parent: Orientation,
    ) -> bool {
        if let Attraction::Passive(_) = self.magnet.law {
            let is_new = self.placed.insert(block_face.body, centre, parent) && self.expose();
            self.restart_count(block_face);
            return is_new;
        }
        if self.holds.contains_key(&block_face) {
            return false;
        }
        let Err(at) = self
            .active
            .binary_search_by_key(&block_face, |on| on.block_face)
        else {
            return false;
        };
        self.active
            .insert(at, Active::new(block_face, centre, parent));
        self.change();
        true
    }

    /// Restarts the entry count of a face that always attracts, as if it had been switched on.
    fn restart_count(&mut self, block_face: BlockFace) {
        let mut faces = self.active.iter_mut().chain(&mut self.covered);
        if let Some(face) = faces.find(|face| face.block_face == block_face) {
            face.entries = 0;
            face.inside.clear();
            self.change();
        }
    }

    /// Clears the data that are derived from the sets of open and holding faces.
    fn change(&mut self) {
        self.seen = false;
        self.pressures = None;
    }

    /// Opens all faces that always attract and have a free cell in front. Returns whether any is
    /// new.
    fn expose(&mut self) -> bool {
        self.change();
        let mut old = std::mem::take(&mut self.active);
        let mut is_new = false;
        for (block_face, centre, parent) in self.placed.open_faces() {
            if self.holds.contains_key(&block_face) {
                continue;
            }
            // Both lists are sorted by site.
            if let Ok(at) = old.binary_search_by_key(&block_face, |on| on.block_face) {
                self.active.push(old.remove(at));
                continue;
            }
            is_new = true;
            let known = self
                .covered
                .iter()
                .position(|face| face.block_face == block_face);
            self.active.push(match known {
                Some(at) => self.covered.swap_remove(at),
                None => Active::new(block_face, centre, parent),
            });
        }
        self.covered.append(&mut old);
        let (covered, placed) = (&mut self.covered, &self.placed);
        covered.retain(|face| placed.has(face.block_face.body));
        is_new
    }

    /// Attaches a pre-attached block to an open face. Returns `None` if the face is off or holds a
    /// block.
    pub fn plant(
        &mut self,
        block_face: BlockFace,
        body: u32,
        tick: u64,
    ) -> Option<(Anchored<R>, Docking)> {
        let at = (self.active)
            .binary_search_by_key(&block_face, |on| on.block_face)
            .ok()?;
        let active = self.active.remove(at);
        let orientation = Orientation::IDENTITY;
        let (child_face, turn) = orientation.as_docked(active.parent, block_face.face)?;
        let docking = Docking {
            block_face,
            child: body,
            child_face,
            turn,
            entries: 1,
            entered: tick,
        };
        let seat = active.seat;
        let held = Anchored {
            body,
            seat,
            orientation,
        };
        self.hold(block_face, &held);
        Some((held, docking))
    }

    fn hold(&mut self, block_face: BlockFace, held: &Anchored<R>) {
        self.holds.insert(block_face, held.body);
        self.change();
        if let Attraction::Passive(_) = self.magnet.law {
            let body = Body::Free(held.body);
            self.placed.insert(body, held.seat, held.orientation);
            self.expose();
        }
    }

    /// Switches a face off and returns the block that it held. A face that always attracts stays on
    /// and rejects its block.
    pub fn switch_off(&mut self, block_face: BlockFace) -> Option<ReleasedBlock<R>> {
        self.change();
        let Attraction::Passive(passive) = self.magnet.law else {
            if let Ok(at) = self
                .active
                .binary_search_by_key(&block_face, |on| on.block_face)
            {
                self.active.remove(at);
            }
            return Some(ReleasedBlock {
                body: self.holds.remove(&block_face)?,
                impulse: Vector3::zeros(),
            });
        };
        let body = self.holds.remove(&block_face)?;
        self.placed.remove(Body::Free(body));
        let out = self.placed.outward(block_face);
        self.rejected.push(body);
        self.expose();
        Some(ReleasedBlock {
            body,
            impulse: out * R::from_double(passive.impulse),
        })
    }

    /// Rejects a block: no face can capture it until the block has left every docking window.
    pub fn reject(&mut self, body: u32) {
        self.rejected.push(body);
    }

    pub fn sinks(&mut self) -> Vec<Sink> {
        let Attraction::Suction(suction) = self.magnet.law else {
            return Vec::new();
        };
        self.solve();
        let sink = |active: &Active<R>| Sink {
            centre: cast(active.target.centre),
            normal: cast(active.target.normal),
            flow: self.drop(active.block_face) / suction.valve,
        };
        self.active.iter().map(sink).collect()
    }

    /// Updates the pressures if faces draw fluid and the structure has changed.
    fn solve(&mut self) {
        if let (Attraction::Suction(suction), None) = (self.magnet.law, &self.pressures) {
            let open = self.active.iter().map(|active| active.block_face);
            self.pressures = Some(Pressures::new(&suction, open, &self.holds));
        }
    }

    /// Returns the pressure drop at a face, as the acceleration of a block. Returns 0 if faces draw
    /// no fluid.
    fn drop(&self, block_face: BlockFace) -> f64 {
        let pressures = self.pressures.as_ref();
        pressures.map_or(0.0, |pressures| pressures.at(block_face.body))
    }

    /// Invalidates the candidates after blocks were moved outside a step.
    pub fn disturb(&mut self) {
        self.seen = false;
    }

    /// Returns the open faces, each with its number of entries so far.
    pub fn active(&self) -> impl Iterator<Item = (BlockFace, u32)> + '_ {
        self.active
            .iter()
            .map(|active| (active.block_face, active.entries))
    }

    /// Returns the number of entries into the reach of a face since it was switched on. Returns 0
    /// if it is off or holds a block.
    pub fn entries(&self, block_face: BlockFace) -> u32 {
        let at = self
            .active
            .binary_search_by_key(&block_face, |on| on.block_face);
        let covered = || {
            self.covered
                .iter()
                .find(|face| face.block_face == block_face)
        };
        let face = at.ok().map(|at| &self.active[at]).or_else(covered);
        face.map_or(0, |face| face.entries)
    }

    /// Returns the blocks within reach of each open face, with the tick of entry.
    pub fn in_reach(&self) -> impl Iterator<Item = (BlockFace, u32, u64)> + '_ {
        (self.active.iter()).flat_map(|active| {
            let block_face = active.block_face;
            let inside = active.inside.iter();
            inside.map(move |&(body, entered)| (block_face, body, entered))
        })
    }

    /// Returns the number of open faces.
    pub fn count(&self) -> usize {
        self.active.len()
    }

    pub fn centre(&self, active: usize) -> Vector3<R> {
        self.active[active].target.centre
    }

    /// Returns the distance from a face's centre beyond which a block's centre is out of reach
    /// \[block lengths\].
    pub fn horizon(&self) -> R {
        R::from_double((self.magnet.reach() + INSIDE) * 1.001)
    }

    /// Sets the blocks that may be within reach of an open face, in ascending order.
    pub fn set_nearby(&mut self, active: usize, nearby: &[u32]) {
        self.active[active].nearby.clear();
        self.active[active].nearby.extend_from_slice(nearby);
    }

    /// Finds the blocks within reach of each face, and counts entries at `tick`.
    pub fn survey(&mut self, tick: u64, blocks: &mut impl Blocks<Real = R>) {
        if self.seen {
            return;
        }
        self.seen = true;
        self.candidates.clear();
        let [reach, field] = [self.magnet.reach(), self.magnet.field()].map(R::from_double);
        let far = self.horizon() * self.horizon();
        for (i, active) in self.active.iter_mut().enumerate() {
            let before = self.candidates.len();
            for &body in &active.nearby {
                let position = blocks.position(body);
                if blocks.is_free(body)
                    && (position - active.target.centre).norm_squared() < far
                    && let Some(near) = active.target.near(position, blocks.rotation(body), reach)
                {
                    self.candidates.push(DockingCandidate {
                        active: i,
                        body,
                        near,
                    });
                }
            }
            let seen = self.candidates[before..].iter();
            let seen = seen.filter(|s| s.near.distance < field);
            (active.inside).retain(|&(id, _)| seen.clone().any(|s| s.body == id));
            for candidate in seen {
                if active.inside.iter().all(|&(id, _)| id != candidate.body) {
                    active.inside.push((candidate.body, tick));
                    active.entries += 1;
                }
            }
        }
    }

    /// Calls `push` with the attraction of each face on each block within its reach. The order is
    /// by face, then by block number.
    pub fn pull(
        &mut self,
        blocks: &mut impl Blocks<Real = R>,
        mut push: impl FnMut(u32, VelocityChange<R>),
    ) {
        self.solve();
        for candidate in &self.candidates {
            let id = candidate.body;
            if blocks.is_free(id) {
                let Active {
                    target, block_face, ..
                } = &self.active[candidate.active];
                let (position, rotation) = (blocks.position(id), blocks.rotation(id));
                let (near, drop) = (&candidate.near, R::from_double(self.drop(*block_face)));
                push(
                    id,
                    target.push(near, position, rotation, &self.magnet, drop),
                );
            }
        }
    }

    /// Captures blocks that were close and straight enough during a step of length `dt`.
    ///
    /// The closest block is captured first. Blocks at equal distance are captured in the order of
    /// their numbers, then in the order of the faces' sites. A face captures one block, and a block
    /// is captured by one face. A face of a free block is skipped if `is_bonded` returns that it is
    /// bonded. If the scene samples captures, they happen only in the last step of a tick. `ends`
    /// states whether this is the last step.
    pub fn capture(
        &mut self,
        tick: u64,
        ends: bool,
        dt: R,
        blocks: &mut impl Blocks<Real = R>,
        is_bonded: impl Fn(u32, Face) -> bool,
        mut hold: impl FnMut(Anchored<R>, Docking),
    ) {
        self.seen = false;
        // Entries during this step count at its end, so that a capture can follow at once.
        self.survey(tick + 1, blocks);
        if self.magnet.sampled && !ends {
            return;
        }
        let mut ready: Vec<DockingCandidate<R>> = Vec::new();
        for &DockingCandidate { active, body, near } in &self.candidates {
            if is_bonded(body, near.face) {
                continue;
            }
            let motion = [blocks.velocity(body), blocks.spin(body)];
            let (position, rotation) = (blocks.position(body), blocks.rotation(body));
            let sweep = FaceSweep::from_step(&near, position, rotation, motion, dt, &self.magnet);
            if let Some(distance) = sweep.docks(&self.active[active].target, &self.magnet) {
                let near = Near { distance, ..near };
                ready.push(DockingCandidate { active, body, near });
            }
        }
        if !self.rejected.is_empty() {
            (self.rejected).retain(|&body| ready.iter().any(|s| s.body == body));
            ready.retain(|s| !self.rejected.contains(&s.body));
        }
        if ready.is_empty() {
            return;
        }
        self.seen = false;
        ready.sort_by(|a, b| {
            let key = |s: &DockingCandidate<R>| (s.body, s.active);
            let distance = a
                .near
                .distance
                .double()
                .total_cmp(&b.near.distance.double());
            distance.then(key(a).cmp(&key(b)))
        });
        let mut taken: Vec<BlockFace> = Vec::new();
        let mut anchored: Vec<u32> = Vec::new();
        let mut docked = Vec::new();
        for candidate in ready {
            let active = &self.active[candidate.active];
            if anchored.contains(&candidate.body) || taken.contains(&active.block_face) {
                continue;
            }
            taken.push(active.block_face);
            anchored.push(candidate.body);
            let (turn, orientation) = best_turn(
                active.parent,
                active.block_face.face,
                candidate.near.face,
                blocks.rotation(candidate.body),
            );
            let entry = active.inside.iter().find(|&&(id, _)| id == candidate.body);
            let docking = Docking {
                block_face: active.block_face,
                child: candidate.body,
                child_face: candidate.near.face,
                turn,
                // A block that was not within reach before its capture enters with the capture.
                entries: active.entries + u32::from(entry.is_none()),
                entered: entry.map_or(tick + 1, |&(_, entered)| entered),
            };
            let held = Anchored {
                body: candidate.body,
                seat: active.seat,
                orientation,
            };
            docked.push((held, docking));
        }
        self.active
            .retain(|active| !taken.contains(&active.block_face));
        for (held, docking) in docked {
            self.hold(docking.block_face, &held);
            hold(held, docking);
        }
    }
}
