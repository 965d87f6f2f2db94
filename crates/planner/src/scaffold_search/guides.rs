//! Guide masts, which hold no segments. Blocks dock faster next to a wall.
use rand::RngExt as _;
use rand::seq::IndexedRandom as _;
use rand_chacha::ChaCha8Rng;
use stochc_ir::{Cell, Face};

use super::places::supports;
use crate::Target;
use crate::scaffold::Scaffolding;

/// Returns the positions next to a cell that a mast can reach.
pub fn places_beside(target: &Target, cell: Cell) -> impl Iterator<Item = Cell> {
    let beside = supports(target, cell).filter(|(_, direction)| *direction != Face::Up);
    beside.map(|(at, _)| at)
}

impl Scaffolding {
    /// Returns whether a mast reaches a position.
    fn reaches(&self, at: Cell) -> bool {
        let is_there =
            |((x, y), height): ((i32, i32), i32)| (x, y) == (at.x, at.y) && height >= at.z;
        self.masts().into_iter().any(is_there)
    }

    /// Adds a guide that reaches a position.
    fn guide(&mut self, at: Cell) {
        let foot = (at.x, at.y);
        self.guides.retain(|(known, _)| *known != foot);
        self.guides.push((foot, at.z));
    }

    /// Adds a guide at a random position next to each mast without one, if there is space.
    pub(crate) fn all_guided(mut self, target: &Target, rng: &mut ChaCha8Rng) -> Scaffolding {
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

    /// Adds a guide next to a random mast or cell of the target. Returns `None` if there is no
    /// space.
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

    /// Removes a random guide. Returns `None` if there is none.
    pub(crate) fn unguided(&self, rng: &mut ChaCha8Rng) -> Option<Scaffolding> {
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
