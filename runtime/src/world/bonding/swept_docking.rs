//! Docking test over a whole step: a fast block may pass the docking window within it.
use nalgebra::{UnitQuaternion, Vector3};
use stochc_ir::scene::Measure;

use super::face_attraction::{AttractingFace, Near, corners};
use crate::world::parameters::Magnet;
use crate::world::real::Real;

/// Path of a block's face past a magnetized face: start and end of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceSweep<R: Real> {
    pub centre: [Vector3<R>; 2],
    pub normal: [Vector3<R>; 2],
    /// Corners of the face, if the docking window needs them.
    pub corners: Option<[[Vector3<R>; 4]; 2]>,
}

impl<R: Real> FaceSweep<R> {
    /// Returns the path of a face during a step of length `dt`. `position` and `rotation` of its
    /// block are at the end of the step.
    pub fn from_step(
        near: &Near<R>,
        position: Vector3<R>,
        rotation: UnitQuaternion<R>,
        [velocity, spin]: [Vector3<R>; 2],
        dt: R,
        magnet: &Magnet,
    ) -> FaceSweep<R> {
        let dt = magnet.tested(dt);
        let after = (near.centre - position) * R::from_double(2.0);
        let before = (after - (spin * dt).cross(&after)).normalize();
        let centre = position - velocity * dt + before * R::from_double(0.5);
        FaceSweep {
            centre: [centre, near.centre],
            normal: [before, after],
            corners: (magnet.measure == Measure::Corners).then(|| {
                let arms = corners(rotation, near.face);
                let earlier = |arm| position - velocity * dt + arm - (spin * dt).cross(&arm);
                [arms.map(earlier), arms.map(|arm| position + arm)]
            }),
        }
    }

    /// Returns the corners of the face at a fraction of the path.
    fn corners_at(&self, part: R) -> Option<[Vector3<R>; 4]> {
        let [from, to] = self.corners?;
        Some(std::array::from_fn(|i| from[i] + (to[i] - from[i]) * part))
    }

    /// Returns the distance between the face centres at the first docking position on the path.
    /// Returns `None` if there is none.
    pub fn docks(&self, target: &AttractingFace<R>, magnet: &Magnet) -> Option<R> {
        let within = R::from_double(magnet.within);
        let from = self.centre[0] - target.centre;
        let displacement = self.centre[1] - self.centre[0];
        let part = match magnet.measure {
            Measure::Centres | Measure::Corners => {
                nearest(from, displacement, [R::zero(), R::one()])
            }
            Measure::Gap => {
                let (gap, change) = (from.dot(&target.normal), displacement.dot(&target.normal));
                let parts = between(gap, change, within)?;
                let aside = |vector: Vector3<R>, along| vector - target.normal * along;
                nearest(aside(from, gap), aside(displacement, change), parts)
            }
        };
        let offset = from + displacement * part;
        let close = match magnet.measure {
            Measure::Centres => offset.norm() < within,
            Measure::Corners => target.corner_distance(&self.corners_at(part)?) < within,
            Measure::Gap => {
                let gap = offset.dot(&target.normal);
                (offset - target.normal * gap).norm() < R::from_double(0.5)
            }
        };
        let normal = self.normal[0] + (self.normal[1] - self.normal[0]) * part;
        let straight =
            normal.dot(&target.normal) < -R::from_double(magnet.cos_tilt) * normal.norm();
        (close && straight).then(|| offset.norm())
    }
}

/// Returns the fraction of a path at its point nearest to the origin, within an interval of
/// fractions.
fn nearest<R: Real>(from: Vector3<R>, displacement: Vector3<R>, [first, last]: [R; 2]) -> R {
    let length = displacement.norm_squared();
    if length > R::zero() {
        (-from.dot(&displacement) / length).clamp(first, last)
    } else {
        last
    }
}

/// Returns the part of a path where a quantity is below `most`, as the fractions at its ends. The
/// quantity starts at `from` and changes linearly by `change`.
fn between<R: Real>(from: R, change: R, most: R) -> Option<[R; 2]> {
    if change == R::zero() {
        return (from.abs() < most).then_some([R::zero(), R::one()]);
    }
    let [one, two] = [most, -most].map(|end| (end - from) / change);
    let (first, last) = (one.min(two).max(R::zero()), one.max(two).min(R::one()));
    (first < last).then_some([first, last])
}

#[cfg(test)]
mod tests {
    use stochc_ir::Face;

    use super::*;
    use crate::world::parameters::{Attraction, Pull};

    fn magnet(measure: Measure) -> Magnet {
        let pull = Pull {
            force: 0.0,
            within: 1.0,
        };
        Magnet {
            law: Attraction::Switched { pull, align: None },
            measure,
            within: 0.005,
            cos_tilt: 0.9,
            sampled: false,
            square_of_step: 0.0,
        }
    }

    /// Returns whether a block docks at an upward face at the origin during a step. `end` is the
    /// centre of the block's lower face at the end of the step.
    fn docks(measure: Measure, end: Vector3<f64>, velocity: Vector3<f64>, spin: f64) -> bool {
        docks_on(&magnet(measure), end, velocity, spin)
    }

    fn docks_on(magnet: &Magnet, end: Vector3<f64>, velocity: Vector3<f64>, spin: f64) -> bool {
        let target = AttractingFace::new(Vector3::z() * -0.5, Face::Up);
        let position = end + Vector3::z() * 0.5;
        let near = target.at(position, UnitQuaternion::identity(), Face::Down);
        let motion = [velocity, Vector3::x() * spin];
        let rotation = UnitQuaternion::identity();
        let sweep = FaceSweep::from_step(&near, position, rotation, motion, 1.0, magnet);
        sweep.docks(&target, magnet).is_some()
    }

    #[test]
    fn a_face_that_passes_the_window_docks() {
        for part in [0.0, 0.3, 0.7, 1.0] {
            for aside in [0.0, 0.004, 0.006] {
                let displacement = Vector3::new(0.0, 0.3, -0.1);
                let lateral = Vector3::x() * aside;
                let end = lateral + displacement * (1.0 - part);
                assert_eq!(
                    docks(Measure::Centres, end, displacement, 0.0),
                    aside < 0.005
                );
            }
        }
        // It does not come closer, or has already passed.
        let displacement = Vector3::z() * -0.1;
        assert!(!docks(
            Measure::Centres,
            Vector3::z() * 0.02,
            displacement,
            0.0
        ));
        assert!(!docks(
            Measure::Centres,
            Vector3::z() * -0.12,
            displacement,
            0.0
        ));
    }

    #[test]
    fn a_gap_is_tested_where_it_closes() {
        let displacement = Vector3::new(0.4, 0.0, -0.2);
        // Crosses the plane of the plate at a lateral distance of 0.3 and of 0.7.
        for (end, expected) in [(0.5, true), (0.9, false)] {
            let end = Vector3::new(end, 0.0, -0.1);
            assert_eq!(docks(Measure::Gap, end, displacement, 0.0), expected);
        }
    }

    #[test]
    fn tilt_is_tested_near_the_face() {
        // Straight at the end, but tilted by 0.6 radians at the start, when it is close.
        let (displacement, spin) = (Vector3::z() * 0.3, 0.6);
        let arm = Vector3::new(0.0, 0.5 * spin, 0.0);
        assert!(!docks(
            Measure::Centres,
            displacement + arm,
            displacement,
            spin
        ));
        assert!(docks(Measure::Centres, displacement, displacement, 0.0));
    }

    #[test]
    fn a_sampled_window_is_tested_where_the_step_ends() {
        let displacement = Vector3::new(0.0, 0.3, -0.1);
        let sampled = Magnet {
            sampled: true,
            ..magnet(Measure::Centres)
        };
        for (end, expected) in [(0.004, true), (0.006, false)] {
            let end = Vector3::x() * end;
            assert_eq!(docks_on(&sampled, end, displacement, 0.0), expected);
        }
        // The window is passed halfway through the step.
        assert!(!docks_on(&sampled, displacement * 0.5, displacement, 0.0));
    }

    #[test]
    fn corners_of_a_turned_face_are_farther_apart_than_its_centre() {
        let displacement = Vector3::z() * -0.001;
        assert!(docks(
            Measure::Corners,
            Vector3::x() * 0.004,
            displacement,
            0.0
        ));
        assert!(!docks(
            Measure::Corners,
            Vector3::x() * 0.006,
            displacement,
            0.0
        ));
        // A rotation about the normal by an angle t moves each corner by t / sqrt(2).
        let target = AttractingFace::new(Vector3::z() * -0.5, Face::Up);
        for (angle, expected) in [(0.006, true), (0.008, false)] {
            for quarter in 0..4 {
                let turn = f64::from(quarter) * std::f64::consts::FRAC_PI_2 + angle;
                let rotation = UnitQuaternion::from_scaled_axis(Vector3::z() * turn);
                let position = Vector3::z() * 0.5;
                let near = target.at(position, rotation, Face::Down);
                let magnet = magnet(Measure::Corners);
                let motion = [displacement, Vector3::zeros()];
                let sweep = FaceSweep::from_step(&near, position, rotation, motion, 1.0, &magnet);
                assert_eq!(sweep.docks(&target, &magnet).is_some(), expected);
            }
        }
    }
}
