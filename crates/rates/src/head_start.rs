//! What blocks do that are let go near a face which is open, or opens soon.
use serde::{Deserialize, Serialize};
use stochc_ir::scene::Scene;
use stochc_ir::scene::groups::kick;
use stochc_ir::{Cell, Face};

use crate::accessibility::RADIUS;

/// What a block does that is released near an open face.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeadStart {
    /// The squared distance from its cell to the open one, in sides.
    pub squared_distance: u32,
    /// How far it was before the open face, beyond the open cell, in sides; behind it, this is negative.
    pub before: i32,
    /// The probability that it docks there, if no other does before.
    pub probability: f64,
    /// The mean time in which it does \[tick\].
    pub ticks: f64,
    /// Whether it is of a face that opens a moment after the block was let go, in its own cell: what has come loose has to dock anew.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub late: bool,
}

impl HeadStart {
    /// In how many ticks it docks, by a draw from the exponential distribution of mean 1: what is caught where it is takes always as long.
    pub fn time(&self, draw: f64) -> f64 {
        if self.squared_distance == 0 && !self.late {
            self.ticks
        } else {
            self.ticks * draw
        }
    }
}

/// What a block does that is let go in front of a face which opens a moment later, where the file does not say it: as 1360 releases in the
/// default scene had it.
const LATE: HeadStart = HeadStart {
    squared_distance: 0,
    before: 0,
    probability: 0.60,
    ticks: 52.0,
    late: true,
};

/// The head starts of a scene.
#[derive(Clone, Copy, Debug)]
pub struct HeadStarts<'r> {
    known: &'r [HeadStart],
    /// In how many ticks a block that was let go leaves the reach of a face.
    leaves: f64,
}

/// What a block may do at one open face, by when it was let go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReleaseNearby {
    /// At a face that is open when the block is let go.
    at_once: HeadStart,
    /// At one that opens a moment later.
    late: HeadStart,
    leaves: f64,
}

/// That many where there are no kicks \[tick\].
const LEAVES: f64 = 25.0;

impl<'r> HeadStarts<'r> {
    /// What released blocks do in a scene of which so much is known.
    ///
    /// Kicks of the rms j take a block that was at rest j t^(3/2) / √3 far in t ticks, and it is like any other in twice the time in which
    /// that is the radius of the sphere of reach: by runs with physics in the default scene, and in two others (docs/validation/rates.md).
    pub(crate) fn in_scene(scene: &Scene, known: &'r [HeadStart]) -> HeadStarts<'r> {
        let kick = kick(scene);
        let leaves = 2.0 * libm::cbrt(3.0 * (RADIUS / kick) * (RADIUS / kick));
        HeadStarts {
            known,
            leaves: if kick > 0.0 { leaves } else { LEAVES },
        }
    }

    /// Those of a block that is released in the cell `from`, at an open cell to which `way` leads; `None`: it is like any other block.
    pub fn of(&self, cell: Cell, way: Face, from: Cell) -> Option<ReleaseNearby> {
        let (squared_distance, before) = relative(cell, way, from)?;
        let at = |late: bool| {
            let place = (squared_distance, before, late);
            let mut known = self.known.iter();
            known
                .find(|it| (it.squared_distance, it.before, it.late) == place)
                .copied()
        };
        let at_once = at(false)?;
        let late = match squared_distance {
            0 => at(true).unwrap_or(LATE),
            _ => at_once,
        };
        Some(ReleaseNearby {
            at_once,
            late,
            leaves: self.leaves,
        })
    }

    /// Whether a block that was let go so many ticks ago is like any other, wherever that was.
    pub fn are_over(&self, since: f64) -> bool {
        since >= self.leaves
    }
}

impl ReleaseNearby {
    /// Of a face that is open when the block has been loose for so many ticks, and was not before.
    pub fn after(&self, since: f64) -> Option<HeadStart> {
        if since <= 0.0 {
            return Some(self.at_once);
        }
        let left = 1.0 - since / self.leaves;
        (left > 0.0).then_some(HeadStart {
            probability: self.late.probability * left,
            ..self.late
        })
    }
}

/// Where a cell is from an open one, to which `way` leads: the squared distance, and how far before the face; `None`: beyond all
/// numbers.
pub fn relative(cell: Cell, way: Face, from: Cell) -> Option<(u32, i32)> {
    let offset = [
        from.x.checked_sub(cell.x)?,
        from.y.checked_sub(cell.y)?,
        from.z.checked_sub(cell.z)?,
    ];
    let mut squares = 0_u32;
    for part in offset {
        squares = squares.checked_add(part.unsigned_abs().checked_pow(2)?)?;
    }
    let before = offset.iter().zip(way.normal()).map(|(a, b)| a * b).sum();
    Some((squares, before))
}

#[cfg(test)]
mod tests {
    use stochc_ir::scene::Agitation;

    use super::*;
    use crate::rates::Rates;

    #[test]
    fn blocks_that_are_let_go_leave_the_sooner_the_faster_they_are() {
        let rates = &Rates::shipped()[0];
        let cell = Cell::new(0, 0, 5);
        let leaves = |speed: f64| {
            let mut rates = rates.clone();
            let Some(Agitation::Kicks { speed: kicks }) = &mut rates.scene.agitation else {
                panic!("it has kicks");
            };
            *kicks = (kicks.0 * speed, kicks.1 * speed);
            let starts = rates.head_starts();
            let nearby = starts.of(cell, Face::Up, cell).expect("it is known");
            let probability = |since: u32| nearby.after(f64::from(since)).map(|it| it.probability);
            assert_eq!(probability(0), Some(nearby.at_once.probability));
            let late = (1..1000).map_while(probability).collect::<Vec<_>>();
            assert!(late[0] < nearby.late.probability && late.is_sorted_by(|a, b| a > b));
            assert!(starts.are_over(late.len() as f64 + 1.0));
            late.len()
        };
        let usual = leaves(1.0);
        // As runs with physics have it: a third of those that dock a tick later still do after 15 to 25, and none after 50.
        assert!((20..40).contains(&usual), "{usual}");
        assert!(leaves(0.5) > usual * 3 / 2 && leaves(2.0) < usual * 3 / 4);
    }

    #[test]
    fn a_block_in_another_cell_is_no_more_likely_at_a_face_that_waits() {
        let rates = &Rates::shipped()[0];
        let (cell, beside) = (Cell::new(0, 0, 5), Cell::new(1, 0, 5));
        let starts = rates.head_starts();
        let nearby = starts.of(cell, Face::Up, beside).expect("it is known");
        let at = |since: f64| nearby.after(since).map(|it| it.probability);
        assert!(at(1.0) < at(0.0) && at(10.0) < at(1.0));
        assert_eq!(starts.of(cell, Face::Up, Cell::new(9, 0, 5)), None);
    }
}
