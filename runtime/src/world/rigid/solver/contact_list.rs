//! Contacts found by collision detection, before they are solved.
use std::ops::Range;

use nalgebra::Vector3;

use crate::world::real::Real;
use crate::world::rigid::narrow_phase::ManifoldPoint;

/// Contact of two bodies, or of one body with the ground.
#[derive(Clone, Debug)]
pub(super) struct TouchingBodies<R: Real> {
    pub bodies: [usize; 2],
    /// Time over which the force acts in this step \[tick\].
    pub span: R,
    /// Unit vectors along the normal and across it.
    pub frame: [Vector3<R>; 3],
    /// Range of the contact's points among the points of all contacts.
    pub points: Range<usize>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct ContactPoint<R: Real> {
    /// Depth of the overlap \[block lengths\].
    pub depth: R,
    /// Vectors from the centres of the two bodies to the point.
    pub arms: [Vector3<R>; 2],
}

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

    /// Adds the contact of two bodies with these centres. `None` is an immovable body.
    pub fn add(
        &mut self,
        bodies: [usize; 2],
        centres: [Option<Vector3<R>>; 2],
        span: R,
        normal: Vector3<R>,
        points: &[ManifoldPoint<R>],
    ) {
        let across = if normal.x.abs() < R::from_double(0.7) {
            Vector3::x()
        } else {
            Vector3::y()
        };
        let one = normal.cross(&across).normalize();
        let from = self.points.len();
        self.points.extend(points.iter().map(|point| ContactPoint {
            depth: point.depth,
            arms:
                centres.map(|centre| {
                    centre.map_or_else(Vector3::zeros, |centre| point.position - centre)
                }),
        }));
        self.list.push(TouchingBodies {
            bodies,
            span,
            frame: [normal, one, normal.cross(&one)],
            points: from..self.points.len(),
        });
    }

    pub fn points_of(&self, touch: &TouchingBodies<R>) -> &[ContactPoint<R>] {
        &self.points[touch.points.clone()]
    }
}
