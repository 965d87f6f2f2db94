//! Who comes into reach of a magnetized face, who docks there, and which face holds whom.
use std::collections::BTreeMap;

use nalgebra::{UnitQuaternion, Vector3};

use super::target::{Near, Push, Target, best_turn};
use crate::orientation::Orientation;
use crate::world::real::{Real, normal};
use crate::world::terms::Magnet;
use crate::world::{Docking, Site};

/// From the centre of a block to its faces \[side\].
const INSIDE: f64 = 0.5;

/// The blocks, as magnetized faces see them.
pub(crate) trait Cloud<R: Real> {
    /// Where a block is, unless it is anchored.
    fn position(&self, id: u32) -> Option<Vector3<R>>;
    /// How it is turned.
    fn rotation(&mut self, id: u32) -> UnitQuaternion<R>;
}

/// All magnetized faces of a world, and what they hold.
#[derive(Clone, Debug)]
pub(crate) struct Faces<R: Real> {
    magnet: Magnet,
    /// The faces that are on and hold nothing, by site.
    active: Vec<Active<R>>,
    /// The faces that hold a block.
    holds: BTreeMap<Site, u32>,
    /// Who is in reach of what, by face and number.
    sightings: Vec<Sighting<R>>,
    /// Whether the sightings are those of the blocks' present places.
    seen: bool,
}

/// A face that is on and holds nothing.
#[derive(Clone, Debug)]
struct Active<R: Real> {
    site: Site,
    target: Target<R>,
    /// Times that a block came into reach.
    entries: u32,
    /// The blocks in reach by number, with the tick of their entry.
    inside: Vec<(u32, u64)>,
    /// The blocks that may be in reach, in rising order.
    nearby: Vec<u32>,
    /// Where a captured block will sit.
    seat: Vector3<R>,
    /// How the block sits whose face this is.
    parent: Orientation,
}

/// A free block in reach of an active face.
#[derive(Clone, Copy, Debug)]
struct Sighting<R: Real> {
    /// Index of the face.
    active: usize,
    body: u32,
    near: Near<R>,
}

/// A block that has just docked, and how it is held.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held<R: Real> {
    pub body: u32,
    /// Of its centre.
    pub seat: Vector3<R>,
    pub orientation: Orientation,
}

impl<R: Real> Active<R> {
    /// The face of a block at `centre` that sits in `parent`.
    fn new(site: Site, centre: Vector3<R>, parent: Orientation) -> Active<R> {
        let face = parent.to_structure(site.face);
        Active {
            site,
            target: Target::new(centre, face),
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
            holds: BTreeMap::new(),
            sightings: Vec::new(),
            seen: false,
        }
    }

    /// Switches a face on, unless it is or holds something; the block it belongs to is at `centre`.
    ///
    /// The index of the face, if it is new: see [`Faces::set_nearby`].
    pub fn magnetize(
        &mut self,
        site: Site,
        centre: Vector3<R>,
        parent: Orientation,
    ) -> Option<usize> {
        if self.holds.contains_key(&site) {
            return None;
        }
        let at = self
            .active
            .binary_search_by_key(&site, |on| on.site)
            .err()?;
        self.active.insert(at, Active::new(site, centre, parent));
        self.seen = false;
        Some(at)
    }

    /// Captures a block by hand on a face that is on; `None`: it is off, or holds something.
    pub fn plant(&mut self, site: Site, body: u32, tick: u64) -> Option<(Held<R>, Docking)> {
        let at = (self.active)
            .binary_search_by_key(&site, |on| on.site)
            .ok()?;
        let active = self.active.remove(at);
        let orientation = Orientation::IDENTITY;
        let (child_face, turn) = orientation.as_docked(active.parent, site.face)?;
        let docking = Docking {
            site,
            child: body,
            child_face,
            turn,
            entries: 1,
            entered: tick,
        };
        let seat = active.seat;
        self.holds.insert(site, body);
        self.seen = false;
        Some((
            Held {
                body,
                seat,
                orientation,
            },
            docking,
        ))
    }

    /// Switches a face off: what it held, if it held something.
    pub fn switch_off(&mut self, site: Site) -> Option<u32> {
        self.seen = false;
        if let Ok(at) = self.active.binary_search_by_key(&site, |on| on.site) {
            self.active.remove(at);
        }
        self.holds.remove(&site)
    }

    /// The blocks have been moved by something other than a step.
    pub fn disturb(&mut self) {
        self.seen = false;
    }

    /// The faces that are on and hold nothing, each with the entries into its reach so far.
    pub fn active(&self) -> impl Iterator<Item = (Site, u32)> + '_ {
        self.active
            .iter()
            .map(|active| (active.site, active.entries))
    }

    /// Who is in reach of which active face, with the tick of the entry.
    pub fn in_reach(&self) -> impl Iterator<Item = (Site, u32, u64)> + '_ {
        (self.active.iter()).flat_map(|active| {
            let site = active.site;
            let inside = active.inside.iter();
            inside.map(move |&(body, entered)| (site, body, entered))
        })
    }

    /// How many faces are on and hold nothing.
    pub fn count(&self) -> usize {
        self.active.len()
    }

    /// The centre of an active face.
    pub fn centre(&self, active: usize) -> Vector3<R> {
        self.active[active].target.centre
    }

    /// Farther from the centre of a face than this, a block's centre is not in its reach \[side\].
    pub fn horizon(&self) -> R {
        R::of((self.magnet.reach() + INSIDE) * 1.001)
    }

    /// Says which blocks may be in reach of an active face from now on, in rising order.
    pub fn set_nearby(&mut self, active: usize, nearby: impl IntoIterator<Item = u32>) {
        let list = &mut self.active[active].nearby;
        list.clear();
        list.extend(nearby);
    }

    /// Finds who is in reach of what, and counts entries as of `tick`.
    pub fn survey(&mut self, tick: u64, blocks: &mut impl Cloud<R>) {
        if self.seen {
            return;
        }
        self.seen = true;
        self.sightings.clear();
        let reach = R::of(self.magnet.reach());
        let far = self.horizon() * self.horizon();
        for (i, active) in self.active.iter_mut().enumerate() {
            let before = self.sightings.len();
            for &body in &active.nearby {
                if let Some(position) = blocks.position(body)
                    && (position - active.target.centre).norm_squared() < far
                    && let Some(near) = active.target.near(position, blocks.rotation(body), reach)
                {
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

    /// What the magnets do to the blocks in reach, in the order of faces and numbers.
    pub fn pull(&self, blocks: &mut impl Cloud<R>, mut push: impl FnMut(u32, Push<R>)) {
        for sighting in &self.sightings {
            let id = sighting.body;
            if let Some(position) = blocks.position(id) {
                let target = &self.active[sighting.active].target;
                let rotation = blocks.rotation(id);
                push(
                    id,
                    target.push(&sighting.near, position, rotation, &self.magnet, R::zero()),
                );
            }
        }
    }

    /// The blocks have moved: surveys them, and anchors those that are close and straight enough:
    /// the closest first, then the lowest number, then the lowest site. A face takes one block, and
    /// a block one face.
    pub fn capture(
        &mut self,
        tick: u64,
        blocks: &mut impl Cloud<R>,
        mut hold: impl FnMut(Held<R>, Docking),
    ) {
        self.seen = false;
        // Entries of this step are seen at its end, and docking may follow at once.
        self.survey(tick + 1, blocks);
        let mut ready: Vec<Sighting<R>> = Vec::new();
        for sighting in &self.sightings {
            let target = &self.active[sighting.active].target;
            let rotation = blocks.rotation(sighting.body);
            if target.anchors(&sighting.near, rotation, &self.magnet) {
                ready.push(*sighting);
            }
        }
        if ready.is_empty() {
            return;
        }
        self.seen = false;
        ready.sort_by(|a, b| {
            let key = |s: &Sighting<R>| (s.body, s.active);
            let distance = a
                .near
                .distance
                .double()
                .total_cmp(&b.near.distance.double());
            distance.then(key(a).cmp(&key(b)))
        });
        let mut taken: Vec<Site> = Vec::new();
        let mut anchored: Vec<u32> = Vec::new();
        for sighting in ready {
            let active = &self.active[sighting.active];
            if anchored.contains(&sighting.body) || taken.contains(&active.site) {
                continue;
            }
            taken.push(active.site);
            anchored.push(sighting.body);
            let (turn, orientation) = best_turn(
                active.parent,
                active.site.face,
                sighting.near.face,
                blocks.rotation(sighting.body),
            );
            let entry = active.inside.iter().find(|&&(id, _)| id == sighting.body);
            let docking = Docking {
                site: active.site,
                child: sighting.body,
                child_face: sighting.near.face,
                turn,
                entries: active.entries,
                entered: entry.map_or(tick, |&(_, entered)| entered),
            };
            let held = Held {
                body: sighting.body,
                seat: active.seat,
                orientation,
            };
            self.holds.insert(active.site, sighting.body);
            hold(held, docking);
        }
        self.active.retain(|active| !taken.contains(&active.site));
    }
}
