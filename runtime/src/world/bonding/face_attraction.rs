//! Effect of a magnetized face on a nearby free block: pull, alignment and the docking window.
use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use stochc_control::Orientation;
use stochc_ir::Face;

use crate::world::parameters::{Attraction, Magnet, Passive, Pull, Suction};
use crate::world::real::{Real, normal};
use crate::world::rotation::matrix;
use crate::world::unit_cube::INVERSE_INERTIA;

/// Distance below which a pull has no direction \[block lengths\].
const COINCIDENT: f64 = 1e-6;

/// Velocity change that a unit force causes at a face's centre, by translation and by rotation. The
/// axis of rotation is half a block length away.
const FACE_YIELDS: f64 = 1.0 + 0.25 * INVERSE_INERTIA;

/// Velocity change that unit forces at all four corners cause at a corner. They turn the block
/// about the normal, at a distance of 1/sqrt(2) block lengths.
const CORNERS_YIELD: f64 = 4.0 * 0.5 * INVERSE_INERTIA;

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(crate) struct AttractingFace<R: Real> {
    pub centre: Vector3<R>,
    /// Outward normal.
    pub normal: Vector3<R>,
    /// Corners of the face, counterclockwise seen from outside.
    corners: [Vector3<R>; 4],
}

/// Face of a block, as seen from an attracting face.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(crate) struct Near<R: Real> {
    pub face: Face,
    pub centre: Vector3<R>,
    /// Distance between the centres of the two faces \[block lengths\].
    pub distance: R,
}

/// Change of velocity and spin per tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct VelocityChange<R: Real> {
    pub linear: Vector3<R>,
    pub angular: Vector3<R>,
}

impl<R: Real> AttractingFace<R> {
    /// Returns a face of an anchored block with this centre. `face` is in the structure's frame.
    pub fn new(centre: Vector3<R>, face: Face) -> AttractingFace<R> {
        AttractingFace::turned(centre, UnitQuaternion::identity(), face)
    }

    /// Returns a face of a block with any rotation. `face` is in the block's own frame.
    pub fn turned(
        centre: Vector3<R>,
        rotation: UnitQuaternion<R>,
        face: Face,
    ) -> AttractingFace<R> {
        let out = rotation * normal::<R>(face.normal());
        AttractingFace {
            centre: centre + out * R::from_double(0.5),
            normal: out,
            corners: corners(rotation, face).map(|corner| centre + corner),
        }
    }

    /// Returns the nearest face of a block if it is closer than `reach`.
    pub fn near(
        &self,
        position: Vector3<R>,
        rotation: UnitQuaternion<R>,
        reach: R,
    ) -> Option<Near<R>> {
        let face = AttractingFace::facing(position, rotation, self.centre);
        let near = self.at(position, rotation, face);
        let distance = near.distance;
        // Also rejects NaN.
        (distance < reach).then_some(near)
    }

    /// Returns a face of a block as seen from this face.
    pub fn at(&self, position: Vector3<R>, rotation: UnitQuaternion<R>, face: Face) -> Near<R> {
        let centre = position + rotation * (normal::<R>(face.normal()) * R::from_double(0.5));
        Near {
            face,
            centre,
            distance: (self.centre - centre).norm(),
        }
    }

    /// Returns the face of a block that points most towards a position.
    pub fn facing(position: Vector3<R>, rotation: UnitQuaternion<R>, to: Vector3<R>) -> Face {
        let own = rotation.inverse_transform_vector(&(to - position));
        let size = own.abs();
        let positive = |axis: usize| own[axis] >= R::zero();
        let pick = |axis, up, down| if positive(axis) { up } else { down };
        if size.x >= size.y && size.x >= size.z {
            pick(0, Face::East, Face::West)
        } else if size.y >= size.z {
            pick(1, Face::North, Face::South)
        } else {
            pick(2, Face::Up, Face::Down)
        }
    }

    /// Applies the forces of the face to a block. Each force has its own reach.
    ///
    /// A force of constant magnitude reverses when the block passes its target, perhaps many times
    /// per step. Near the target the force is therefore reduced, so that the block swings by one
    /// radian per step. The affected distance shrinks with the square of the step.
    ///
    /// `drop` is the pressure drop on a face that draws fluid, as acceleration of a block. It is 0
    /// for other faces.
    pub fn push(
        &self,
        near: &Near<R>,
        position: Vector3<R>,
        rotation: UnitQuaternion<R>,
        magnet: &Magnet,
        drop: R,
    ) -> VelocityChange<R> {
        let mut push = VelocityChange {
            linear: Vector3::zeros(),
            angular: Vector3::zeros(),
        };
        let square = R::from_double(magnet.square_of_step);
        // `yields` is the largest velocity change of the point of attack by a unit force.
        let mut pull = |from: Vector3<R>, to: Vector3<R>, yields: f64, force: &dyn Fn(R) -> R| {
            let displacement = to - from;
            let length = displacement.norm();
            if length > R::from_double(COINCIDENT) {
                let force = force(length);
                let force =
                    displacement * (force / length.max(force * R::from_double(yields) * square));
                push.linear += force;
                push.angular += (from - position).cross(&force) * R::from_double(INVERSE_INERTIA);
            }
        };
        let own = || corners(rotation, near.face).map(|corner| position + corner);
        match magnet.law {
            Attraction::Switched {
                pull: to_centre,
                align,
            } => {
                if near.distance < R::from_double(to_centre.within) {
                    let force = R::from_double(to_centre.force);
                    pull(near.centre, self.centre, FACE_YIELDS, &|_| force);
                }
                if let Some(Pull { force, within }) = align
                    && near.distance < R::from_double(within)
                {
                    let (own, force) = (own(), R::from_double(force));
                    let turn = self.pairing(&own);
                    for (i, &corner) in own.iter().enumerate() {
                        pull(corner, self.counterpart(turn, i), CORNERS_YIELD, &|_| force);
                    }
                }
            }
            Attraction::Passive(Passive {
                hold,
                depth,
                within,
                ..
            }) if near.distance < R::from_double(within) => {
                let half = |corner: Vector3<R>, centre: Vector3<R>| {
                    centre + (corner - centre) * R::from_double(0.5)
                };
                let (hold, depth) = (R::from_double(hold / 4.0), R::from_double(depth));
                let dipoles = |length: R| {
                    let closeness = depth / (depth + length);
                    let square = closeness * closeness;
                    hold * square * square
                };
                let own = own();
                let turn = self.pairing(&own);
                for (i, &corner) in own.iter().enumerate() {
                    let to = half(self.counterpart(turn, i), self.centre);
                    pull(half(corner, near.centre), to, CORNERS_YIELD, &dipoles);
                }
            }
            Attraction::Suction(Suction { seal, .. }) if near.distance < R::from_double(seal) => {
                let own = own();
                let turn = self.pairing(&own);
                pull(near.centre, self.centre, FACE_YIELDS, &|_| {
                    drop * R::from_double(0.5)
                });
                for (i, &corner) in own.iter().enumerate() {
                    pull(corner, self.counterpart(turn, i), CORNERS_YIELD, &|_| {
                        drop * R::from_double(0.125)
                    });
                }
            }
            Attraction::Passive(_) | Attraction::Suction(_) => {}
        }
        push
    }

    /// Returns the quarter turn that brings the corners closest to their counterparts.
    fn pairing(&self, own: &[Vector3<R>; 4]) -> usize {
        let misfit = |turn| {
            let squares = own
                .iter()
                .enumerate()
                .map(|(i, &corner)| (corner - self.counterpart(turn, i)).norm_squared());
            squares.fold(R::zero(), |sum, square| sum + square)
        };
        (1..4).fold(0, |best, turn| {
            if misfit(turn) < misfit(best) {
                turn
            } else {
                best
            }
        })
    }

    /// Returns the largest distance between a corner of this face and its counterpart among `own`
    /// \[block lengths\].
    pub fn corner_distance(&self, own: &[Vector3<R>; 4]) -> R {
        let turn = self.pairing(own);
        let distances = own.iter().enumerate();
        let distances = distances.map(|(i, &corner)| (corner - self.counterpart(turn, i)).norm());
        distances.fold(R::zero(), R::max)
    }

    /// Returns the corner of this face that meets corner `own` of the other face. Touching faces
    /// have their corners in opposite order.
    fn counterpart(&self, turn: usize, own: usize) -> Vector3<R> {
        self.corners[(turn + 4 - own) % 4]
    }
}

/// Returns the corners of a face relative to the block's centre, counterclockwise seen from
/// outside.
pub(super) fn corners<R: Real>(rotation: UnitQuaternion<R>, face: Face) -> [Vector3<R>; 4] {
    let out = normal::<R>(face.normal());
    let across = Vector3::new(out.z, out.x, out.y);
    let along = out.cross(&across);
    let half = R::from_double(0.5);
    [(half, half), (-half, half), (-half, -half), (half, -half)]
        .map(|(a, b)| rotation * (out * half + across * a + along * b))
}

/// Returns the best orientation of a block on `parent_face`: the quarter turn of
/// [`Orientation::docked`] closest to the block's rotation.
pub(crate) fn best_turn<R: Real>(
    parent: Orientation,
    parent_face: Face,
    child_face: Face,
    rotation: UnitQuaternion<R>,
) -> (u8, Orientation) {
    let own = rotation.to_rotation_matrix();
    let likeness = |orientation: Orientation| {
        let axes = matrix(orientation).map(R::from_double);
        own.matrix().dot(&axes)
    };
    let turned = |turn| Orientation::docked(parent, parent_face, child_face, turn);
    let best = (1..4).fold(0, |best, turn| {
        if likeness(turned(turn)) > likeness(turned(best)) {
            turn
        } else {
            best
        }
    });
    (best, turned(best))
}
