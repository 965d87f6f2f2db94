//! Rotations of blocks on the lattice.
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use stochc_control::Orientation;
use stochc_ir::Face;

/// Returns the matrix from block to structure axes.
pub fn matrix(orientation: Orientation) -> Matrix3<f64> {
    let column = |own| Vector3::from(orientation.to_structure(own).normal()).cast::<f64>();
    Matrix3::from_columns(&[column(Face::East), column(Face::North), column(Face::Up)])
}

/// Returns the rotation from block to structure axes.
pub fn quaternion(orientation: Orientation) -> UnitQuaternion<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix(orientation)))
}
