//! Several cubes as one rigid body.
use nalgebra::{Matrix3, Vector3};

use crate::world::blocks::Motion;
use crate::world::unit_cube::INVERSE_INERTIA;

/// The motion of a rigid body that has the momentum and the angular momentum of its cubes.
#[derive(Clone, Copy, Debug)]
pub(super) struct RigidMotion {
    pub middle: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub spin: Vector3<f64>,
}

impl RigidMotion {
    /// Of cubes of side 1 and mass 1; at least one.
    pub fn of(cubes: &[Motion]) -> RigidMotion {
        let (mut compound, turning) = RigidMotion::momenta(cubes);
        let middle = compound.middle;
        compound.spin = spin(turning, cubes.iter().map(|cube| cube.position - middle));
        compound
    }

    /// Their middle and its velocity, without a spin; and their angular momentum about it.
    pub fn momenta(cubes: &[Motion]) -> (RigidMotion, Vector3<f64>) {
        let count = cubes.len() as f64;
        let middle = cubes.iter().map(|cube| cube.position).sum::<Vector3<f64>>() / count;
        let velocity = cubes.iter().map(|cube| cube.velocity).sum::<Vector3<f64>>() / count;
        let turning = |cube: &Motion| {
            (cube.position - middle).cross(&cube.velocity) + cube.spin / INVERSE_INERTIA
        };
        let compound = RigidMotion {
            middle,
            velocity,
            spin: Vector3::zeros(),
        };
        (compound, cubes.iter().map(turning).sum())
    }

    /// The velocity and the spin of a cube of it.
    pub fn at(&self, position: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let velocity = self.velocity + self.spin.cross(&(position - self.middle));
        (velocity, self.spin)
    }
}

/// The spin of a body of cubes at these places from its middle that has an angular momentum.
pub(super) fn spin(
    turning: Vector3<f64>,
    arms: impl Iterator<Item = Vector3<f64>>,
) -> Vector3<f64> {
    let mut inertia = Matrix3::zeros();
    for arm in arms {
        let own = arm.norm_squared() + 1.0 / INVERSE_INERTIA;
        inertia += Matrix3::identity() * own - arm * arm.transpose();
    }
    // At least a sixth in every direction.
    (inertia.cholesky()).map_or(turning * INVERSE_INERTIA, |it| it.solve(&turning))
}

/// Kinetic energy \[side^2 / tick^2\] that goes when cubes take the motion of one rigid body.
pub(crate) fn lost(cubes: &[Motion]) -> f64 {
    let energy = |velocity: Vector3<f64>, spin: Vector3<f64>| {
        (velocity.norm_squared() + spin.norm_squared() / INVERSE_INERTIA) / 2.0
    };
    let compound = RigidMotion::of(cubes);
    let each = |cube: &Motion| {
        let (velocity, spin) = compound.at(cube.position);
        energy(cube.velocity, cube.spin) - energy(velocity, spin)
    };
    cubes.iter().map(each).sum()
}
