//! Mean waiting times of faces, for planning.
use std::borrow::Cow;
use std::cell::RefCell;

use rustc_hash::FxHashMap;
use stochc_estimate::{
    Neighbourhood, Parameters, Rates, Rivals, Surroundings, Wait, around, offsets, rivals,
};
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, Face};

use crate::space::grid::shifted;

/// State of a cell when a nearby face opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellState {
    /// Empty cell.
    Empty,
    /// Empty cell in front of an open face. The face captures in this direction.
    Awaited(Face),
    /// Cell with a block.
    Full,
}

/// Conditions that a waiting time depends on, other than the surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Fraction of the initial free blocks that are still free.
    pub free: f64,
    /// Whether the run has just begun.
    pub is_first: bool,
}

/// Rate model of a scene, calibrated if possible.
#[derive(Debug)]
pub struct RateLaw<'a> {
    rates: Option<Cow<'a, Rates>>,
    /// Whether blocks are known to pass gaps.
    has_passable_gaps: bool,
    /// Cache of surroundings, by layer, direction and occupied cells in sight.
    seen: RefCell<FxHashMap<(i32, Face, Neighbourhood), Surroundings>>,
    /// Cache of mean waiting times \[docking times\]. The key is the logarithm of captures per
    /// docking time, in units of 1 / [`STEPS`].
    scaled: RefCell<FxHashMap<i32, f64>>,
}

/// Mean waiting time in a pit, and in a gap unless gaps are known to be passable \[ticks\]. Blocks
/// jam there, and the rate model does not cover jams. In another scene, closing a straight beam
/// took at least 8,800 ticks, and a pit 10,000.
const JAM: f64 = 15_000.0;

/// Layer above which all layers are equivalent.
const HIGHEST: i32 = 30;

/// Steps per unit of the logarithm of captures per docking time.
const STEPS: f64 = 100.0;

impl<'a> RateLaw<'a> {
    /// Returns the model of a scene: given rates, built-in rates or an uncalibrated estimate.
    /// Without any of these, returns typical rates, which can only rank plans.
    pub(crate) fn for_scene(scene: &Scene, known: &'a [Rates]) -> RateLaw<'a> {
        RateLaw {
            has_passable_gaps: Rates::pass_gaps(scene),
            ..RateLaw::new(Rates::known_or_guessed(known, scene))
        }
    }

    /// Returns the model of given rates, or of typical rates.
    pub fn new(rates: Option<Cow<'a, Rates>>) -> RateLaw<'a> {
        RateLaw {
            rates,
            has_passable_gaps: false,
            seen: RefCell::default(),
            scaled: RefCell::default(),
        }
    }

    /// Returns the rates of the scene, if calibrated or estimated.
    pub fn rates(&self) -> Option<&Rates> {
        self.rates.as_deref()
    }

    /// Returns whether blocks are known to pass gaps.
    pub fn has_passable_gaps(&self) -> bool {
        self.has_passable_gaps
    }

    /// Returns whether blocks are known to escape if two faces across a corner attract them. Equal
    /// to [`Self::has_passable_gaps`].
    pub(crate) fn has_passable_corners(&self) -> bool {
        self.has_passable_gaps
    }

    /// Returns the mean waiting time of a face open to `cell` in a direction.
    ///
    /// `state` is the state of surrounding cells. Half of the awaited cells are assumed to fill
    /// before the capture.
    pub fn mean(
        &self,
        cell: Cell,
        direction: Face,
        moment: Moment,
        state: impl Fn(Cell) -> CellState,
    ) -> f64 {
        let aside = || {
            Face::ALL
                .into_iter()
                .filter(|face| *face != direction && *face != direction.opposite())
        };
        let beside = |face: Face| {
            let [dx, dy, dz] = face.normal();
            shifted(cell, dx, dy, dz)
        };
        let is_ground = |face: &Face| beside(*face).z < 1;
        let is_block = |face: &Face| !is_ground(face) && state(beside(*face)) == CellState::Full;
        let walls = aside().filter(|face| is_ground(face) || is_block(face));
        let has_room = self.has_passable_gaps && !aside().any(|face| is_block(&face));
        if is_ground(&direction) || (is_block(&direction) && !has_room) || walls.count() == 4 {
            return JAM;
        }
        let mut full = Neighbourhood::on_ground(Cell::new(0, 0, cell.z.min(HIGHEST)));
        let mut awaited = Neighbourhood::EMPTY;
        for offset in offsets(direction) {
            let [dx, dy, dz] = offset;
            match state(shifted(cell, dx, dy, dz)) {
                CellState::Empty => {}
                CellState::Awaited(_) => awaited.block(offset),
                CellState::Full => full.block(offset),
            }
        }
        let open_direction = |near: Cell| match state(near) {
            CellState::Awaited(direction) => Some(direction),
            CellState::Empty | CellState::Full => None,
        };
        let without = self.wait(
            cell.z,
            direction,
            full,
            moment,
            rivals(cell, direction, open_direction),
        );
        if awaited == Neighbourhood::EMPTY {
            return self.mean_of(without);
        }
        let with = self.wait(
            cell.z,
            direction,
            full.and(awaited),
            moment,
            Rivals::default(),
        );
        self.mean_of(without.between(with))
    }

    fn wait(
        &self,
        layer: i32,
        direction: Face,
        near: Neighbourhood,
        moment: Moment,
        rivals: Rivals,
    ) -> Wait {
        // The model depends only on the layer of the cell.
        let cell = Cell::new(0, 0, layer.min(HIGHEST));
        let mut seen = self.seen.borrow_mut();
        let seen = seen
            .entry((cell.z, direction, near))
            .or_insert_with(|| match self.rates() {
                Some(rates) => rates.surroundings(cell, direction, near, |_| None),
                None => around(cell, direction, near, |_| None),
            });
        let surroundings = Surroundings {
            free: moment.free,
            cold: moment.is_first,
            rivals,
            ..*seen
        };
        match self.rates() {
            Some(rates) => rates.wait(&surroundings),
            None => Parameters::TYPICAL.wait(&surroundings),
        }
    }

    /// Returns the mean waiting time, with a relative error of at most half a percent.
    fn mean_of(&self, wait: Wait) -> f64 {
        let step = ((wait.rate * wait.docking).ln() * STEPS).round();
        let mut scaled = self.scaled.borrow_mut();
        let mean = scaled.entry(step as i32).or_insert_with(|| {
            let rate = (step / STEPS).exp();
            Wait { rate, docking: 1.0 }.mean()
        });
        *mean * wait.docking
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LATER: Moment = Moment {
        free: 0.8,
        is_first: false,
    };

    #[test]
    fn walls_lengthen_waits_and_closed_cells_jam() {
        let law = RateLaw::new(None);
        let cell = Cell::new(4, 4, 5);
        let mean = |direction: Face, walls: &[Face]| {
            let full: Vec<Cell> = std::iter::once(direction.opposite())
                .chain(walls.iter().copied())
                .map(|face| cell.across(face).unwrap())
                .collect();
            law.mean(cell, direction, LATER, |near| {
                if full.contains(&near) {
                    CellState::Full
                } else {
                    CellState::Empty
                }
            })
        };
        let sides = [Face::East, Face::West, Face::North, Face::South];
        let means: Vec<f64> = (1..=4)
            .map(|count| mean(Face::Up, &sides[..count]))
            .collect();
        assert!(means.is_sorted(), "{means:?}");
        assert_eq!(means[3], JAM);
        assert_eq!(mean(Face::Up, &[Face::Up]), JAM);
        assert_eq!(mean(Face::Up, &[]), mean(Face::Up, &[]));
    }

    /// Compares means with the rate model. Some of the cells in sight are awaited.
    #[test]
    fn means_agree_with_the_rate_model() {
        let law = RateLaw::new(None);
        let cell = Cell::new(4, 4, 5);
        for direction in Face::ALL {
            let parent = cell.across(direction.opposite()).unwrap();
            let is_full =
                |near: Cell| near == parent || (near.x + 2 * near.y + 3 * near.z) % 11 == 9;
            let is_awaited = |near: Cell| !is_full(near) && near != cell && near.x == near.z;
            let at = |with: bool| Surroundings {
                free: LATER.free,
                ..around(
                    cell,
                    direction,
                    Neighbourhood::new(cell, |near| is_full(near) || (with && is_awaited(near))),
                    |near| (!with && is_awaited(near)).then_some(direction),
                )
            };
            let [without, with] = [false, true].map(|with| Parameters::TYPICAL.wait(&at(with)));
            let direct = without.between(with);
            let mean = law.mean(cell, direction, LATER, |near| match () {
                () if is_full(near) => CellState::Full,
                () if is_awaited(near) => CellState::Awaited(direction),
                () => CellState::Empty,
            });
            assert!(
                (mean / direct.mean() - 1.0).abs() < 0.01,
                "{direction}: {mean} {}",
                direct.mean()
            );
        }
    }
}
