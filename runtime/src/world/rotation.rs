//! How blocks on the lattice sit, as rotations of space.
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use stochc_ir::Face;
use stochc_protocol::Orientation;

/// The matrix whose columns are the structure's directions of the block's own x, y and z.
pub fn matrix(orientation: Orientation) -> Matrix3<f64> {
    let column = |own| Vector3::from(orientation.to_structure(own).normal()).cast::<f64>();
    Matrix3::from_columns(&[column(Face::East), column(Face::North), column(Face::Up)])
}

/// Own coordinates to the structure's.
pub fn quaternion(orientation: Orientation) -> UnitQuaternion<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix(orientation)))
}
