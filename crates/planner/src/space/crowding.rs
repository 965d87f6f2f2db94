//! Faces that must not be open at the same time, because blocks jam between them.
//!
//! A block between two open faces is held by both and may jam. docs/validation/rates.md lists how
//! often this happens. Unless `has_passable_corners` is set, two faces across a corner around a
//! target cell count as jamming. Faces that share only a corner do not interfere.
use stochc_ir::Face;

use crate::space::sites::{NONE, Sites};

/// Rules against crowding: faces that must not be open at the same time.
#[derive(Clone, Copy, Debug)]
pub struct Crowding<'a> {
    pub sites: &'a Sites<'a>,
    /// Whether faces always attract. No face can then wait for another one.
    pub attracts_always: bool,
    /// Whether blocks are known to pass between two faces across a corner. No third face of the
    /// square may be open.
    pub has_passable_corners: bool,
}

impl Crowding<'_> {
    /// Returns whether a face may open while other faces are open. `open` returns the direction of
    /// a site's open face.
    pub fn may_open(&self, site: u32, direction: Face, open: impl Fn(u32) -> Option<Face>) -> bool {
        if self.attracts_always {
            return true;
        }
        let is_open = |near: &u32| *near != NONE && open(*near).is_some();
        let is_crowded = |[one, two, across]: [u32; 3]| {
            if self.has_passable_corners {
                [one, two, across]
                    .iter()
                    .filter(|near| is_open(near))
                    .count()
                    > 1
            } else {
                (one != NONE || two != NONE) && is_open(&across)
            }
        };
        !self.sites.squares(site).any(is_crowded)
            && !self.beside_on_plate(site, direction, &open).any(|_| true)
    }

    /// Returns the sites that must be captured before a face opens, possibly with duplicates.
    /// `before` returns the direction and capture time of a site that opens earlier.
    pub fn waits(
        &self,
        site: u32,
        direction: Face,
        before: impl Fn(u32) -> Option<(Face, f32)>,
    ) -> Vec<u32> {
        let mut waits = Vec::new();
        if self.attracts_always {
            return waits;
        }
        for square in self.sites.squares(site) {
            let [one, two, across] = square;
            let is_before = |near: u32| near != NONE && before(near).is_some();
            if self.has_passable_corners {
                // All except the last one to complete.
                let end = |near: &u32| before(*near).map_or(0.0, |(_, end)| end);
                let mut others: Vec<u32> =
                    square.into_iter().filter(|&near| is_before(near)).collect();
                others.sort_by(|a, b| end(a).total_cmp(&end(b)).then(a.cmp(b)));
                others.pop();
                waits.extend(others);
            } else if (one != NONE || two != NONE) && is_before(across) {
                waits.push(across);
            }
        }
        let direction_at = |near: u32| before(near).map(|(direction, _)| direction);
        waits.extend(self.beside_on_plate(site, direction, direction_at));
        waits
    }

    /// Returns the adjacent sites that are captured from the plate. Empty if this site is not
    /// captured from the plate.
    fn beside_on_plate(
        &self,
        site: u32,
        direction: Face,
        direction_at: impl Fn(u32) -> Option<Face>,
    ) -> impl Iterator<Item = u32> {
        let is_on_plate =
            |site: u32, direction: Face| direction == Face::Up && self.sites.is_on_seed(site);
        let adjacent = is_on_plate(site, direction).then(|| self.sites.adjacent(site));
        let beside = adjacent.into_iter().flatten();
        beside.filter(move |&near| {
            direction_at(near).is_some_and(|direction| is_on_plate(near, direction))
        })
    }
}
