//! What a magnetized face does to a free block near it: pull, alignment, and when it anchors.
use rapier3d::glamx::{Mat3, Quat, Vec3};
use stochc_compiler::Face;
use stochc_compiler::scene::Measure;

use super::convert::normal;
use super::terms::{Magnet, Pull};
use crate::orientation::Orientation;

/// Below this distance \[side\] a pull has no direction.
const COINCIDENT: f32 = 1e-6;

/// A magnetized face in space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// Of the face.
    pub centre: Vec3,
    /// Outward.
    pub normal: Vec3,
    /// Its corners, counterclockwise seen from outside.
    corners: [Vec3; 4],
}

/// The nearest face of a free block, seen from a magnetized one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub face: Face,
    /// Of the face.
    pub centre: Vec3,
    /// Between the centres of the two faces.
    pub distance: f32,
}

/// Change of velocity and of spin per tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Push {
    pub linear: Vec3,
    pub angular: Vec3,
}

impl Target {
    /// Of the structure's face `face` of the block whose centre is `centre`.
    pub fn new(centre: Vec3, face: Face) -> Target {
        let out = normal(face.normal());
        let corners = corners(Mat3::IDENTITY, face).map(|corner| centre + corner);
        Target {
            centre: centre + 0.5 * out,
            normal: out,
            corners,
        }
    }

    /// The nearest face of a block, if it is closer than `reach`.
    pub fn near(&self, position: Vec3, rotation: Quat, reach: f32) -> Option<Near> {
        let own = rotation.conjugate() * (self.centre - position);
        let size = own.abs();
        let face = if size.x >= size.y && size.x >= size.z {
            if own.x >= 0.0 { Face::East } else { Face::West }
        } else if size.y >= size.z {
            if own.y >= 0.0 {
                Face::North
            } else {
                Face::South
            }
        } else if own.z >= 0.0 {
            Face::Up
        } else {
            Face::Down
        };
        let centre = position + rotation * (0.5 * normal(face.normal()));
        let distance = (self.centre - centre).length();
        // Not a number must not pass either.
        (distance < reach).then_some(Near {
            face,
            centre,
            distance,
        })
    }

    /// What the magnet does to a block within its reach.
    pub fn push(&self, near: &Near, position: Vec3, rotation: Quat, magnet: &Magnet) -> Push {
        let mut push = Push {
            linear: Vec3::ZERO,
            angular: Vec3::ZERO,
        };
        let mut pull = |from: Vec3, to: Vec3, force: f32| {
            let way = to - from;
            let length = way.length();
            if length > COINCIDENT {
                let force = way * (force / length);
                push.linear += force;
                push.angular += INVERSE_INERTIA * (from - position).cross(force);
            }
        };
        pull(near.centre, self.centre, magnet.pull.force);
        if let Some(Pull { force, within }) = magnet.align
            && near.distance < within
        {
            let own = corners(Mat3::from_quat(rotation), near.face).map(|c| position + c);
            let turn = self.pairing(&own);
            for (i, &corner) in own.iter().enumerate() {
                pull(corner, self.counterpart(turn, i), force);
            }
        }
        push
    }

    /// The quarter turn that leaves the corners closest to their counterparts.
    fn pairing(&self, own: &[Vec3; 4]) -> usize {
        let misfit = |turn| -> f32 {
            own.iter()
                .enumerate()
                .map(|(i, &corner)| corner.distance_squared(self.counterpart(turn, i)))
                .sum()
        };
        (1..4).fold(0, |best, turn| {
            if misfit(turn) < misfit(best) {
                turn
            } else {
                best
            }
        })
    }

    /// Faces that touch see each other's corners in opposite order.
    fn counterpart(&self, turn: usize, own: usize) -> Vec3 {
        self.corners[(turn + 4 - own) % 4]
    }

    /// Whether a block within reach is close and straight enough to be anchored.
    pub fn anchors(&self, near: &Near, rotation: Quat, magnet: &Magnet) -> bool {
        let close = match magnet.measure {
            Measure::Centres => near.distance < magnet.within,
            Measure::Gap => {
                let offset = near.centre - self.centre;
                let gap = offset.dot(self.normal);
                gap.abs() < magnet.within && (offset - gap * self.normal).length() < 0.5
            }
        };
        close && (rotation * normal(near.face.normal())).dot(self.normal) < -magnet.cos_tilt
    }
}

/// Of a cube of side 1 and mass 1.
pub(super) const INVERSE_INERTIA: f32 = 6.0;

/// The corners of a face from the centre of its block, counterclockwise seen from outside.
fn corners(rotation: Mat3, face: Face) -> [Vec3; 4] {
    let out = normal(face.normal());
    let across = Vec3::new(out.z, out.x, out.y);
    let along = out.cross(across);
    [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
        .map(|(a, b)| rotation * (0.5 * (out + a * across + b * along)))
}

/// How a block that touches `parent_face` sits best: the quarter turn of [`Orientation::docked`]
/// whose rotation is closest to the block's own.
pub(super) fn best_turn(
    parent: Orientation,
    parent_face: Face,
    child_face: Face,
    rotation: Quat,
) -> (u8, Orientation) {
    let (x, y) = (rotation * Vec3::X, rotation * Vec3::Y);
    let likeness = |orientation: Orientation| {
        let axis = |own: Face| normal(orientation.to_structure(own).normal());
        x.dot(axis(Face::East)) + y.dot(axis(Face::North)) + x.cross(y).dot(axis(Face::Up))
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
