//! Attraction between two free blocks whose magnets are always on, and the condition for a bond.
use nalgebra::{UnitQuaternion, Vector3};
use stochc_control::Orientation;
use stochc_ir::Face;
use stochc_ir::scene::Measure;

use super::face_attraction::{AttractingFace, Near, VelocityChange, best_turn, corners};
use super::swept_docking::FaceSweep;
use crate::world::blocks::{Motion, Pose};
use crate::world::parameters::{Magnet, Passive};
use crate::world::real::normal;
use crate::world::rotation::quaternion;

/// Distance from the centre of a block to its faces \[block lengths\].
const INSIDE: f64 = 0.5;

/// Faces of two blocks that point at each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FacePair {
    /// Face of the first block.
    pub face: Face,
    /// Face of the second block.
    pub other: Face,
    target: AttractingFace<f64>,
    /// Face of the second block, as seen from the first.
    near: Near<f64>,
}

impl FacePair {
    /// Returns two faces: for each block, the face that points most towards the centre of the other
    /// block.
    pub fn new(first: &Pose, second: &Pose) -> FacePair {
        let face = AttractingFace::<f64>::facing(first.position, first.rotation, second.position);
        let target = AttractingFace::turned(first.position, first.rotation, face);
        let other = AttractingFace::<f64>::facing(second.position, second.rotation, first.position);
        FacePair {
            face,
            other,
            target,
            near: target.at(second.position, second.rotation, other),
        }
    }

    /// Returns the pull on each block, or `None` if they are out of reach.
    pub fn pushes(
        &self,
        magnet: &Magnet,
        first: &Pose,
        second: &Pose,
    ) -> Option<[VelocityChange<f64>; 2]> {
        let is_felt = self.near.distance < magnet.field();
        is_felt.then(|| {
            let back = AttractingFace::turned(second.position, second.rotation, self.other);
            let near = back.at(first.position, first.rotation, self.face);
            let (target, seen) = (&self.target, &self.near);
            [
                back.push(&near, first.position, first.rotation, magnet, 0.0),
                target.push(seen, second.position, second.rotation, magnet, 0.0),
            ]
        })
    }

    /// Returns whether the blocks come close and straight enough to bond during a step of length
    /// `dt`. `ends` contains their poses and motions at the end of the step.
    pub fn bonds(&self, magnet: &Magnet, ends: [(&Pose, &Motion); 2], dt: f64) -> bool {
        let [(first, _), (second, _)] = ends;
        let dt = magnet.tested(dt);
        let [from, start] = ends.map(|(pose, motion)| Pose {
            position: pose.position - motion.velocity * dt,
            rotation: UnitQuaternion::from_scaled_axis(motion.spin * -dt) * pose.rotation,
        });
        // In the moving frame of the first block.
        let start = start.carried(&from, first);
        let seen = (self.target).at(start.position, start.rotation, self.other);
        let sweep = FaceSweep {
            centre: [seen.centre, self.near.centre],
            normal: [
                (seen.centre - start.position) * 2.0,
                (self.near.centre - second.position) * 2.0,
            ],
            corners: (magnet.measure == Measure::Corners).then(|| {
                [&start, second]
                    .map(|pose| corners(pose.rotation, self.other).map(|arm| pose.position + arm))
            }),
        };
        sweep.docks(&self.target, magnet).is_some()
    }
}

/// Returns the pairs of blocks that may be within each other's reach, in ascending order. Uses a
/// sweep along x.
pub(crate) fn close(blocks: &[(u32, Vector3<f64>)], reach: f64) -> Vec<(usize, usize)> {
    let far = reach + 2.0 * INSIDE;
    let mut order: Vec<usize> = (0..blocks.len()).collect();
    order.sort_by(|&a, &b| blocks[a].1.x.total_cmp(&blocks[b].1.x));
    let mut pairs = Vec::new();
    for (rank, &a) in order.iter().enumerate() {
        let from = blocks[a].1;
        for &b in &order[rank + 1..] {
            let displacement = blocks[b].1 - from;
            if displacement.x > far {
                break;
            }
            if displacement.norm_squared() < far * far {
                pairs.push((a.min(b), a.max(b)));
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

/// Returns the work of separating two attracting faces: the integral of F (1 + d / depth)^-4
/// \[block lengths^2 / tick^2\].
pub(crate) fn energy(passive: &Passive) -> f64 {
    passive.hold * passive.depth / 3.0
}

/// Returns the pose of the second block straight on a face of the first, at the nearest quarter
/// turn.
pub(crate) fn seat(first: &Pose, face: Face, second: &Pose, other: Face) -> Pose {
    // In a frame with the axes of the first block.
    let relative = first.rotation.inverse() * second.rotation;
    let (_, orientation) = best_turn(Orientation::IDENTITY, face, other, relative);
    let out = normal::<f64>(face.normal());
    Pose {
        position: first.position + first.rotation * out,
        rotation: first.rotation * quaternion(orientation),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::parameters::Attraction;
    use crate::world::unit_cube::INVERSE_INERTIA;

    fn magnet() -> Magnet {
        Magnet {
            law: Attraction::Passive(Passive {
                hold: 0.8,
                depth: 0.2,
                within: 1.5,
                impulse: 0.0,
            }),
            measure: Measure::Centres,
            within: 0.05,
            cos_tilt: 0.96,
            sampled: false,
            square_of_step: 0.0,
        }
    }

    fn pose(x: f64, y: f64, z: f64, turn: Vector3<f64>) -> Pose {
        Pose {
            position: Vector3::new(x, y, z),
            rotation: UnitQuaternion::from_scaled_axis(turn),
        }
    }

    fn pushes(a: &Pose, b: &Pose) -> [VelocityChange<f64>; 2] {
        let pair = FacePair::new(a, b);
        pair.pushes(&magnet(), a, b).expect("within reach")
    }

    /// Returns whether two blocks form a bond while they rotate as one body about the origin.
    /// `spin` is the angle per step.
    fn turning(a: &Pose, b: &Pose, spin: Vector3<f64>) -> bool {
        let [first, second] = [a, b].map(|pose| Motion {
            position: pose.position,
            velocity: spin.cross(&pose.position),
            spin,
        });
        FacePair::new(a, b).bonds(&magnet(), [(a, &first), (b, &second)], 1.0)
    }

    fn rest(a: &Pose, b: &Pose) -> bool {
        turning(a, b, Vector3::zeros())
    }

    #[test]
    fn a_rotating_pair_has_the_distance_of_a_resting_one() {
        let a = pose(-0.5, 0.0, 0.0, Vector3::zeros());
        for gap in [0.04, 0.06] {
            let b = pose(0.5 + gap, 0.0, 0.0, Vector3::zeros());
            for spin in [Vector3::z(), Vector3::x(), Vector3::new(0.2, -0.4, 0.3)] {
                assert_eq!(turning(&a, &b, spin * 0.1), gap < 0.05, "{gap} {spin}");
            }
        }
    }

    #[test]
    fn aligned_faces_follow_the_force_law() {
        for gap in [0.0, 0.1, 0.5, 1.2] {
            let turn = Vector3::z() * std::f64::consts::FRAC_PI_2;
            let (a, b) = (
                pose(0.0, 0.0, 0.0, Vector3::zeros()),
                pose(1.0 + gap, 0.0, 0.0, turn),
            );
            let pair = FacePair::new(&a, &b);
            let force = if gap == 0.0 {
                0.0
            } else {
                0.8 / (1.0 + gap / 0.2).powi(4)
            };
            let [first, second] = pair.pushes(&magnet(), &a, &b).expect("within reach");
            assert!(
                (first.linear - Vector3::x() * force).norm() < 1e-12,
                "{gap}"
            );
            assert!(
                (second.linear + Vector3::x() * force).norm() < 1e-12,
                "{gap}"
            );
            assert!(first.angular.norm() + second.angular.norm() < 1e-12);
            assert_eq!(rest(&a, &b), gap < 0.05);
        }
    }

    #[test]
    fn the_work_of_separation_is_the_bond_energy() {
        let Attraction::Passive(passive) = magnet().law else {
            panic!("expected passive magnets");
        };
        let step = 1e-4;
        let work: f64 = (0..1_000_000)
            .map(|i| {
                step * passive.hold / (1.0 + (f64::from(i) + 0.5) * step / passive.depth).powi(4)
            })
            .sum();
        assert!((work / energy(&passive) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn a_pair_conserves_momentum_and_angular_momentum() {
        let a = pose(0.1, -0.2, 0.3, Vector3::new(0.2, -0.4, 0.1));
        let b = pose(1.2, 0.3, 0.1, Vector3::new(-0.3, 0.1, 0.7));
        let [first, second] = pushes(&a, &b);
        assert!(first.linear.norm() > 1e-3);
        assert!((first.linear + second.linear).norm() < 1e-12);
        let turning = |pose: &Pose, push: &VelocityChange<f64>| {
            pose.position.cross(&push.linear) + push.angular / INVERSE_INERTIA
        };
        assert!((turning(&a, &first) + turning(&b, &second)).norm() < 1e-12);
    }

    #[test]
    fn a_twisted_block_is_turned_to_the_nearest_quarter() {
        let (a, twist) = (pose(0.0, 0.0, 0.0, Vector3::zeros()), 0.2);
        for (angle, sense) in [(twist, -1.0), (std::f64::consts::FRAC_PI_2 - twist, 1.0)] {
            let b = pose(1.05, 0.0, 0.0, Vector3::x() * angle);
            let [_, second] = pushes(&a, &b);
            assert!(
                second.angular.x * sense > 1e-3,
                "{angle}: {}",
                second.angular
            );
        }
    }

    #[test]
    fn a_seat_is_face_to_face_and_near_the_block() {
        let a = pose(0.1, -0.2, 0.3, Vector3::new(0.2, -0.4, 0.1));
        // Straight in front of the north face, slightly displaced and twisted.
        let off = a.rotation * Vector3::new(0.01, 1.02, -0.01);
        let twist = UnitQuaternion::from_scaled_axis(Vector3::new(0.03, 1.6, 0.02));
        let b = Pose {
            position: a.position + off,
            rotation: a.rotation * twist,
        };
        let pair = FacePair::new(&a, &b);
        assert_eq!(pair.face, Face::North);
        let seat = seat(&a, pair.face, &b, pair.other);
        assert!((seat.position - b.position).norm() < 0.03);
        assert!(seat.rotation.angle_to(&b.rotation) < 0.06);
        assert!(rest(&a, &seat));
        assert!(pushes(&a, &seat)[0].linear.norm() < 1e-9);
    }

    #[test]
    fn the_sweep_finds_all_pairs() {
        let mut draws = crate::counter_rng::Draws::new(1, 2, crate::counter_rng::Stream::Shuffle);
        let mut step = draws.step(0);
        let blocks: Vec<(u32, Vector3<f64>)> = (0..200)
            .map(|i| {
                let [x, y, z, _] = step
                    .block(i)
                    .map(|word| crate::counter_rng::unit(word) * 8.0);
                (i, Vector3::new(x, y, z))
            })
            .collect();
        let all = (0..200).flat_map(|a| (a + 1..200).map(move |b| (a, b)));
        let near = |&(a, b): &(usize, usize)| (blocks[a].1 - blocks[b].1).norm() < 2.5;
        assert_eq!(close(&blocks, 1.5), all.filter(near).collect::<Vec<_>>());
    }
}
