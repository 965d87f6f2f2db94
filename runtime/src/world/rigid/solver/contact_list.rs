//! Contacts as they are found, before anything is solved.
use std::ops::Range;

use nalgebra::Vector3;

use crate::world::real::Real;
use crate::world::rigid::narrow_phase::ManifoldPoint;

/// Two bodies that touch, or one and the ground.
#[derive(Clone, Debug)]
pub(super) struct TouchingBodies<R: Real> {
    pub bodies: [usize; 2],
    /// How long the force acts in this step \[tick\].
    pub span: R,
    /// Along the normal, and across it.
    pub frame: [Vector3<R>; 3],
    /// Among the points of all contacts.
    pub points: Range<usize>,
}

/// One point of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactPoint<R: Real> {
    /// How far the bodies overlap here.
    pub depth: R,
    /// From the centres of the two bodies.
    pub arms: [Vector3<R>; 2],
}

/// The contacts of a substep, and their points.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactList<R: Real> {
    pub list: Vec<TouchingBodies<R>>,
    pub points: Vec<ContactPoint<R>>,
}

impl<R: Real> ContactList<R> {
    pub fn clear(&mut self) {
        self.list.clear();
        self.points.clear();
    }

    /// Adds the contact of two bodies with these centres; `None`: something that never moves.
    pub fn add(
        &mut self,
        bodies: [usize; 2],
        centres: [Option<Vector3<R>>; 2],
        span: R,
        normal: Vector3<R>,
        points: &[ManifoldPoint<R>],
    ) {
        let across = if normal.x.abs() < R::of(0.7) {
            Vector3::x()
        } else {
            Vector3::y()
        };
        let one = normal.cross(&across).normalize();
        let from = self.points.len();
        self.points.extend(points.iter().map(|point| {
            ContactPoint {
                depth: point.depth,
                arms: centres.map(|centre| {
                    centre.map_or_else(Vector3::zeros, |centre| point.place - centre)
                }),
            }
        }));
        self.list.push(TouchingBodies {
            bodies,
            span,
            frame: [normal, one, normal.cross(&one)],
            points: from..self.points.len(),
        });
    }

    /// The points of a contact.
    pub fn points_of(&self, touch: &TouchingBodies<R>) -> &[ContactPoint<R>] {
        &self.points[touch.points.clone()]
    }
}
