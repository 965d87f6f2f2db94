//! Who comes into reach of a magnetized face, who docks there, and how it is let go.
use rapier3d::dynamics::RigidBodyType;
use rapier3d::glamx::{Pose3, Vec3};

use super::magnet::{Near, Target, best_turn};
use super::{Docking, INSIDE, RapierWorld, Site, convert};
use crate::orientation::Orientation;

/// A face that is on and holds nothing.
#[derive(Clone, Debug)]
pub(super) struct Active {
    pub site: Site,
    pub target: Target,
    /// Times that a block came into reach.
    pub entries: u32,
    /// The blocks in reach by number, with the tick of their entry.
    inside: Vec<(u32, u64)>,
    /// Where a captured block will sit.
    seat: Vec3,
    /// How the block sits whose face this is.
    parent: Orientation,
}

/// A free block in reach of an active face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    /// Index of the face.
    pub active: usize,
    pub body: u32,
    pub near: Near,
}

impl Active {
    /// The face of a block at `centre` that sits in `parent`.
    pub fn new(site: Site, centre: Vec3, parent: Orientation) -> Active {
        let face = parent.to_structure(site.face);
        Active {
            site,
            target: Target::new(centre, face),
            entries: 0,
            inside: Vec::new(),
            seat: centre + convert::normal(face.normal()),
            parent,
        }
    }
}

impl RapierWorld {
    /// Finds who is in reach of what, and counts entries as of `tick`.
    pub(super) fn survey(&mut self, tick: u64) {
        self.sightings.clear();
        let Some(magnet) = &self.terms.bond else {
            return;
        };
        let reach = magnet.pull.within;
        // The centre of a block's nearest face is half a side from the block's own.
        let far = (reach + INSIDE) * (reach + INSIDE) * 1.001;
        for (i, active) in self.active.iter_mut().enumerate() {
            let before = self.sightings.len();
            for (id, block) in self.blocks.iter().enumerate() {
                let near = block.position.distance_squared(active.target.centre) < far;
                if near
                    && block.anchored.is_none()
                    && let Some(near) = active.target.near(block.position, block.rotation, reach)
                {
                    let body = id as u32;
                    self.sightings.push(Sighting {
                        active: i,
                        body,
                        near,
                    });
                }
            }
            let seen = &self.sightings[before..];
            active
                .inside
                .retain(|&(id, _)| seen.iter().any(|s| s.body == id));
            for sighting in seen {
                if active.inside.iter().all(|&(id, _)| id != sighting.body) {
                    active.inside.push((sighting.body, tick));
                    active.entries += 1;
                }
            }
        }
    }

    /// Anchors the blocks that are close and straight enough: the closest first, then the lowest
    /// number, then the lowest site. A face takes one block, and a block one face.
    pub(super) fn capture(&mut self, dockings: &mut Vec<Docking>) {
        let Some(magnet) = self.terms.bond else {
            return;
        };
        let mut ready: Vec<Sighting> = self.sightings.clone();
        ready.retain(|sighting| {
            let rotation = self.blocks[sighting.body as usize].rotation;
            let target = &self.active[sighting.active].target;
            target.anchors(&sighting.near, rotation, &magnet)
        });
        ready.sort_by(|a, b| {
            let distance = a.near.distance.total_cmp(&b.near.distance);
            distance.then((a.body, a.active).cmp(&(b.body, b.active)))
        });
        let mut taken: Vec<Site> = Vec::new();
        for sighting in ready {
            let active = &self.active[sighting.active];
            let free = self.blocks[sighting.body as usize].anchored.is_none();
            if free && !taken.contains(&active.site) {
                taken.push(active.site);
                dockings.push(self.dock(&sighting));
            }
        }
        self.active.retain(|active| !taken.contains(&active.site));
    }

    /// Fixes a block on the lattice.
    fn dock(&mut self, sighting: &Sighting) -> Docking {
        let active = &self.active[sighting.active];
        let block = &mut self.blocks[sighting.body as usize];
        let (turn, orientation) = best_turn(
            active.parent,
            active.site.face,
            sighting.near.face,
            block.rotation,
        );
        let rotation = convert::rotation(orientation);
        block.position = active.seat;
        block.rotation = rotation;
        block.velocity = Vec3::ZERO;
        block.spin = Vec3::ZERO;
        block.anchored = Some(orientation);
        let body = &mut self.engine.bodies[self.handles[sighting.body as usize]];
        body.set_body_type(RigidBodyType::Fixed, false);
        body.set_position(Pose3::from_parts(active.seat, rotation), false);
        self.holds.insert(active.site, sighting.body);
        let entry = active.inside.iter().find(|&&(id, _)| id == sighting.body);
        Docking {
            site: active.site,
            child: sighting.body,
            child_face: sighting.near.face,
            turn,
            entries: active.entries,
            entered: entry.map_or(self.tick, |&(_, tick)| tick),
        }
    }

    /// Sets a block free, at rest.
    pub(super) fn release(&mut self, id: u32) {
        self.blocks[id as usize].anchored = None;
        let body = &mut self.engine.bodies[self.handles[id as usize]];
        body.set_body_type(RigidBodyType::Dynamic, false);
        body.set_linvel(Vec3::ZERO, false);
        body.set_angvel(Vec3::ZERO, false);
    }
}
