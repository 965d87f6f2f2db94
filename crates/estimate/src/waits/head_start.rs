//! Head starts: captures of blocks released near an open face, or one that opens soon.
use serde::{Deserialize, Serialize};
use stochc_ir::scene::Scene;
use stochc_ir::scene::dimensionless::kick;
use stochc_ir::{Cell, Face};

use crate::geometry::accessibility::RADIUS;

/// Head start of a block that is released near an open face and captured again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeadStart {
    /// Squared distance between the block's cell and the open cell \[block lengths^2\].
    pub squared_distance: u32,
    /// Distance between the block and the open cell along the face's normal \[block lengths\].
    /// Positive in front of the cell, negative on the other side.
    pub before: i32,
    /// Probability of the capture if no other block is faster.
    pub probability: f64,
    /// Mean time of the capture \[ticks\].
    pub ticks: f64,
    /// Whether the face opens shortly after the release. A block that is released in the open cell
    /// is then loose and must dock again.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub late: bool,
}

impl HeadStart {
    /// Returns the time of the capture \[ticks\] for a draw from the exponential distribution with
    /// mean 1. A block that is captured in its own cell always takes the same time.
    pub fn time(&self, draw: f64) -> f64 {
        if self.squared_distance == 0 && !self.late {
            self.ticks
        } else {
            self.ticks * draw
        }
    }
}

/// Default for a block that is released in the open cell shortly before the face opens. Measured in
/// 1360 releases in the default scene.
const LATE: HeadStart = HeadStart {
    squared_distance: 0,
    before: 0,
    probability: 0.60,
    ticks: 52.0,
    late: true,
};

/// Head starts of a scene.
#[derive(Clone, Copy, Debug)]
pub struct HeadStarts<'r> {
    known: &'r [HeadStart],
    /// Time until a released block leaves the reach of a face \[ticks\].
    leaves: f64,
}

/// Two head starts of a block at one face. One is for a face that is already open, the other for a
/// face that opens soon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReleaseNearby {
    /// Head start if the face is open when the block is released.
    at_once: HeadStart,
    /// Head start if the face opens shortly after the release.
    late: HeadStart,
    leaves: f64,
}

/// Default of [`HeadStarts::leaves`] in scenes without random impulses \[ticks\].
const LEAVES: f64 = 25.0;

impl<'r> HeadStarts<'r> {
    /// Returns the head starts of a scene with these calibrated values.
    ///
    /// Random impulses with rms j move a block from rest by j t^(3/2) / √3 in t ticks. T is the
    /// time when this distance equals the radius of the sphere of reach. After 2 T ticks, the block
    /// counts as any other free block. This was validated in the default scene and two others
    /// (docs/validation/rates.md).
    pub(crate) fn in_scene(scene: &Scene, known: &'r [HeadStart]) -> HeadStarts<'r> {
        let kick = kick(scene);
        let leaves = 2.0 * libm::cbrt(3.0 * (RADIUS / kick) * (RADIUS / kick));
        HeadStarts {
            known,
            leaves: if kick > 0.0 { leaves } else { LEAVES },
        }
    }

    /// Returns the head starts of a block that is released in the cell `from`, at the face open to
    /// `cell` in a direction. Returns `None` if there are none.
    pub fn nearby(&self, cell: Cell, direction: Face, from: Cell) -> Option<ReleaseNearby> {
        let (squared_distance, before) = relative(cell, direction, from)?;
        let at = |late: bool| {
            let key = (squared_distance, before, late);
            let mut known = self.known.iter();
            known
                .find(|it| (it.squared_distance, it.before, it.late) == key)
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

    /// Returns whether all head starts are over `since` ticks after the release.
    pub fn are_over(&self, since: f64) -> bool {
        since >= self.leaves
    }
}

impl ReleaseNearby {
    /// Returns the head start at a face that opens `since` ticks after the release. Returns `None`
    /// if all head starts are over by then.
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

/// Returns the squared distance of the cell `from` from the open cell, and its distance in front of
/// the face. Returns `None` on overflow.
pub fn relative(cell: Cell, direction: Face, from: Cell) -> Option<(u32, i32)> {
    let offset = [
        from.x.checked_sub(cell.x)?,
        from.y.checked_sub(cell.y)?,
        from.z.checked_sub(cell.z)?,
    ];
    let mut squares = 0_u32;
    for part in offset {
        squares = squares.checked_add(part.unsigned_abs().checked_pow(2)?)?;
    }
    let before = offset
        .iter()
        .zip(direction.normal())
        .map(|(a, b)| a * b)
        .sum();
    Some((squares, before))
}

#[cfg(test)]
mod tests {
    use stochc_ir::scene::Agitation;

    use super::*;
    use crate::waits::rates::Rates;

    #[test]
    fn fast_released_blocks_leave_sooner() {
        let rates = &Rates::shipped()[0];
        let cell = Cell::new(0, 0, 5);
        let leaves = |speed: f64| {
            let mut rates = rates.clone();
            let Some(Agitation::Kicks { speed: kicks }) = &mut rates.scene.agitation else {
                panic!("it has kicks");
            };
            *kicks = (kicks.0 * speed, kicks.1 * speed);
            let starts = rates.head_starts();
            let nearby = starts.nearby(cell, Face::Up, cell).expect("it is known");
            let probability = |since: u32| nearby.after(f64::from(since)).map(|it| it.probability);
            assert_eq!(probability(0), Some(nearby.at_once.probability));
            let late = (1..1000).map_while(probability).collect::<Vec<_>>();
            assert!(late[0] < nearby.late.probability && late.is_sorted_by(|a, b| a > b));
            assert!(starts.are_over(late.len() as f64 + 1.0));
            late.len()
        };
        let usual = leaves(1.0);
        // In physical runs, a third of the later captures still occur after 15 to 25 ticks, and
        // none after 50.
        assert!((20..40).contains(&usual), "{usual}");
        assert!(leaves(0.5) > usual * 3 / 2 && leaves(2.0) < usual * 3 / 4);
    }

    #[test]
    fn a_block_in_another_cell_has_no_head_start() {
        let rates = &Rates::shipped()[0];
        let (cell, beside) = (Cell::new(0, 0, 5), Cell::new(1, 0, 5));
        let starts = rates.head_starts();
        let nearby = starts.nearby(cell, Face::Up, beside).expect("it is known");
        let at = |since: f64| nearby.after(since).map(|it| it.probability);
        assert!(at(1.0) < at(0.0) && at(10.0) < at(1.0));
        assert_eq!(starts.nearby(cell, Face::Up, Cell::new(9, 0, 5)), None);
    }
}
