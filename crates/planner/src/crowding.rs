//! Which faces are not open at the same time, because blocks jam between them.
//!
//! A block that comes between two faces is held by both. In simulations of the default scene it gets free again, but not always: of two faces of the plate side
//! by side one pair in 500 took more than 6000 ticks, of two side by side on towers and of two across a corner one in some thousands. Of three in a square of four
//! cells it is one in 200, of a whole square on the plate one in four. Elsewhere nobody has measured it as far as that, and two across a corner, around a cell of the
//! target, count as jamming. Faces that share no more than a corner do not hinder each other.
use stochc_ir::Face;

use crate::sites::{NONE, Sites};

/// What of faces near each other is never open together.
#[derive(Clone, Copy, Debug)]
pub struct Crowding<'a> {
    /// The cells.
    pub sites: &'a Sites<'a>,
    /// Whether faces attract all the time: nothing can wait then.
    pub attracts_always: bool,
    /// Whether blocks are known to pass between two faces across a corner, as long as no third one of the square is open.
    pub has_passable_corners: bool,
}

impl Crowding<'_> {
    /// Whether a face may open while others are: of a site whose face is, `open` says the way.
    pub fn may_open(&self, site: u32, way: Face, open: impl Fn(u32) -> Option<Face>) -> bool {
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
            && !self.beside_on_plate(site, way, &open).any(|_| true)
    }

    /// The sites that one waits for, some of them more than once, so that never more is open than may be: `before` says of those that open before their way, and
    /// when their blocks come.
    pub fn waits(
        &self,
        site: u32,
        way: Face,
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
                // All but the one that comes last.
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
        let way_of = |near: u32| before(near).map(|(way, _)| way);
        waits.extend(self.beside_on_plate(site, way, way_of));
        waits
    }

    /// The sites beside one that the plate captures, which it captures as well.
    fn beside_on_plate(
        &self,
        site: u32,
        way: Face,
        way_of: impl Fn(u32) -> Option<Face>,
    ) -> impl Iterator<Item = u32> {
        let is_on_plate = |site: u32, way: Face| way == Face::Up && self.sites.is_on_seed(site);
        let adjacent = is_on_plate(site, way).then(|| self.sites.adjacent(site));
        let beside = adjacent.into_iter().flatten();
        beside.filter(move |&near| way_of(near).is_some_and(|way| is_on_plate(near, way)))
    }
}
