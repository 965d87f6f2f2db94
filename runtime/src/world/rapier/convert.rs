//! Conversions between nalgebra and the engine's mathematics.
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rapier3d::glamx::{Pose3, Quat, Vec3};

pub(super) fn vec3(v: Vector3<f32>) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}

pub(super) fn vector(v: Vec3) -> Vector3<f32> {
    Vector3::new(v.x, v.y, v.z)
}

fn quat(q: UnitQuaternion<f32>) -> Quat {
    Quat::from_xyzw(q.i, q.j, q.k, q.w)
}

/// Converts a quaternion without normalizing it, because the engine keeps its rotations normalized.
pub(super) fn unit_quaternion(q: Quat) -> UnitQuaternion<f32> {
    UnitQuaternion::new_unchecked(Quaternion::new(q.w, q.x, q.y, q.z))
}

pub(super) fn pose3(position: Vector3<f32>, rotation: UnitQuaternion<f32>) -> Pose3 {
    Pose3::from_parts(vec3(position), quat(rotation))
}
