//! The one place where nalgebra meets the engine's own mathematics.
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rapier3d::glamx::{Quat, Vec3};

use crate::orientation::Orientation;

pub(super) fn vec3(v: Vector3<f64>) -> Vec3 {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}

pub(super) fn vector(v: Vec3) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z).cast()
}

pub(super) fn quat(q: UnitQuaternion<f64>) -> Quat {
    Quat::from_xyzw(q.i as f32, q.j as f32, q.k as f32, q.w as f32)
}

pub(super) fn unit_quaternion(q: Quat) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(q.w, q.x, q.y, q.z).cast())
}

/// The rotation of a block that sits in `orientation`.
pub(super) fn rotation(orientation: Orientation) -> Quat {
    quat(orientation.quaternion())
}

/// The direction of a lattice normal.
pub(super) fn normal([x, y, z]: [i32; 3]) -> Vec3 {
    Vec3::new(x as f32, y as f32, z as f32)
}
