//! Masts that hold nothing, beside what grows sooner along a wall.
use rand::RngExt as _;
use rand::seq::IndexedRandom as _;
use rand_chacha::ChaCha8Rng;
use stochc_ir::{Cell, Face};

use super::places::supports;
use crate::Target;
use crate::scaffold::Scaffolding;

/// The places beside a cell to which a mast can reach.
pub fn places_beside(target: &Target, cell: Cell) -> impl Iterator<Item = Cell> {
    let beside = supports(target, cell).filter(|(_, way)| *way != Face::Up);
    beside.map(|(at, _)| at)
}

impl Scaffolding {
    /// Whether there is a mast at a place, and as high as that.
    fn reaches(&self, at: Cell) -> bool {
        let is_there =
            |((x, y), height): ((i32, i32), i32)| (x, y) == (at.x, at.y) && height >= at.z;
        self.masts().into_iter().any(is_there)
    }

    /// With a guide that reaches a place.
    fn guide(&mut self, at: Cell) {
        let foot = (at.x, at.y);
        self.guides.retain(|(known, _)| *known != foot);
        self.guides.push((foot, at.z));
    }

    /// With a mast beside each that has none and has a place for it: chance decides where.
    pub fn all_guided(mut self, target: &Target, rng: &mut ChaCha8Rng) -> Scaffolding {
        for ((x, y), height) in self.masts() {
            let places: Vec<Cell> = places_beside(target, Cell::new(x, y, height)).collect();
            if !places.iter().any(|&at| self.reaches(at))
                && let Some(&at) = places.choose(rng)
            {
                self.guide(at);
            }
        }
        self
    }

    /// With a guide more, beside a mast or a cell of the target: chance decides. `None`: there is no place for it.
    pub fn guided(&self, target: &Target, rng: &mut ChaCha8Rng) -> Option<Scaffolding> {
        const DRAWS: usize = 10;
        let masts = self.masts();
        (0..DRAWS).find_map(|_| {
            let beside = match masts.choose(rng) {
                Some(&((x, y), height)) if rng.random() => Cell::new(x, y, height),
                _ => *target.cells().choose(rng)?,
            };
            let places: Vec<Cell> = places_beside(target, beside).collect();
            let at = *places.choose(rng)?;
            (!self.reaches(at)).then(|| {
                let mut guided = self.clone();
                guided.guide(at);
                guided
            })
        })
    }

    /// With a guide less: chance decides. `None`: there is none.
    pub fn unguided(&self, rng: &mut ChaCha8Rng) -> Option<Scaffolding> {
        let mut other = self.clone();
        match other.guides.len() {
            0 => None,
            count => {
                other.guides.swap_remove(rng.random_range(0..count));
                Some(other)
            }
        }
    }
}
