//! How long a face waits for its block.
use std::cell::RefCell;

use rustc_hash::FxHashMap;
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, Face};
use stochc_rates::{Parameters, Rates, Wait, around};

use crate::grid::shifted;
use crate::sites::{Window, across, place};

/// The mean times that faces wait.
pub trait Waits {
    /// The mean ticks from when a face opens until its block is anchored in `cell`, `way` from its parent, while the cells of
    /// `window` around it are full; the parent is one of them.
    fn mean(&self, cell: Cell, way: Face, window: Window) -> f64;
}

/// The law of rates, with what was measured of a scene if anything was.
#[derive(Debug)]
pub struct RateLaw {
    measured: Option<&'static Rates>,
    /// Means that have been asked for before, by layer.
    means: RefCell<FxHashMap<(i32, Face, Window), f64>>,
    /// Mean waits in docking times, by [`step`].
    scaled: RefCell<FxHashMap<i32, f64>>,
}

/// The mean wait in a pit and in a gap of one cell \[tick\]: free blocks jam there, of which the law knows nothing. A straight
/// beam took 8,800 and more to close, a pit 10,000.
const JAM: f64 = 15_000.0;

/// Layers above this one are alike.
const HIGHEST: i32 = 30;

/// Steps of a table over the logarithm of captures that come into reach in a docking time.
const STEPS: f64 = 100.0;

impl RateLaw {
    /// For a scene; where its rates have not been measured, typical ones rank plans, though they may be off by a factor.
    pub fn of(scene: &Scene) -> RateLaw {
        RateLaw::new(Rates::built_in(scene))
    }

    /// By rates of a scene; `None`: typical ones.
    pub fn new(measured: Option<&'static Rates>) -> RateLaw {
        RateLaw {
            measured,
            means: RefCell::default(),
            scaled: RefCell::default(),
        }
    }

    /// The mean of a wait, to half a percent.
    fn mean_of(&self, wait: Wait) -> f64 {
        let step = ((wait.rate * wait.docking).ln() * STEPS).round();
        let mut scaled = self.scaled.borrow_mut();
        let mean = scaled.entry(step as i32).or_insert_with(|| {
            let rate = (step / STEPS).exp();
            Wait { rate, docking: 1.0 }.mean()
        });
        *mean * wait.docking
    }

    fn found(&self, cell: Cell, way: Face, window: Window) -> f64 {
        let is_full = |near: Cell| {
            let steps = [near.x - cell.x, near.y - cell.y, near.z - cell.z];
            let [dx, dy, dz] = steps;
            steps.iter().all(|step| step.abs() <= 1) && window & 1 << place(dx, dy, dz) != 0
        };
        let is_wall = |face: &Face| {
            let next = shifted(cell, face.normal()[0], face.normal()[1], face.normal()[2]);
            next.z < 1 || is_full(next)
        };
        let sides = Face::ALL
            .iter()
            .filter(|&&face| face != way && face != way.opposite());
        if window & 1 << across(way) != 0 || sides.filter(|face| is_wall(face)).count() == 4 {
            return JAM;
        }
        self.mean_of(match self.measured {
            Some(rates) => rates.wait(&rates.surroundings(cell, way, is_full, |_| false)),
            None => Parameters::TYPICAL.wait(&around(cell, way, is_full, |_| false)),
        })
    }
}

impl Waits for RateLaw {
    fn mean(&self, cell: Cell, way: Face, window: Window) -> f64 {
        // The law asks for nothing but the layer of the cell.
        let cell = Cell::new(0, 0, cell.z.min(HIGHEST));
        let key = (cell.z, way, window);
        let known = self.means.borrow().get(&key).copied();
        known.unwrap_or_else(|| {
            let mean = self.found(cell, way, window);
            self.means.borrow_mut().insert(key, mean);
            mean
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_make_waits_longer_and_what_is_closed_in_jams() {
        let law = RateLaw::new(None);
        let mean = |way: Face, walls: &[Face]| {
            let parent = 1 << across(way.opposite());
            let window = walls
                .iter()
                .fold(parent, |bits, &face| bits | 1 << across(face));
            law.mean(Cell::new(4, 4, 5), way, window)
        };
        let sides = [Face::East, Face::West, Face::North, Face::South];
        let means: Vec<f64> = (1..=4)
            .map(|count| mean(Face::Up, &sides[..count]))
            .collect();
        assert!(means.is_sorted(), "{means:?}");
        assert_eq!(means[3], JAM);
        assert_eq!(mean(Face::Up, &[Face::Up]), JAM);
        // A tower's top, asked for twice, against the law itself.
        let open = mean(Face::Up, &[]);
        let tower = |near: Cell| near == Cell::new(4, 4, 4);
        let direct =
            Parameters::TYPICAL.wait(&around(Cell::new(4, 4, 5), Face::Up, tower, |_| false));
        assert!(
            (open / direct.mean() - 1.0).abs() < 0.01,
            "{open} {}",
            direct.mean()
        );
        assert_eq!(open, mean(Face::Up, &[]));
    }
}
