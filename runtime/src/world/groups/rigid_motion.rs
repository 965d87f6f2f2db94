//! Rigid motion of several cubes.
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::world::blocks::{Motion, Pose};
use crate::world::external_forces::Response;
use crate::world::unit_cube::INVERSE_INERTIA;

/// Motion of a rigid body with the momentum and angular momentum of its cubes.
///
/// In a viscous fluid, velocities are means over a step. The instantaneous velocity was greater by
/// the factor 1 / φ; see [`Response`]. The effective inertia is therefore greater by the same
/// factor. Under strong drag, this inertia equals the friction that governs rotation and diffusion.
#[derive(Clone, Copy, Debug)]
pub(super) struct RigidMotion {
    pub middle: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub spin: Vector3<f64>,
}

impl RigidMotion {
    /// Returns the rigid motion of at least one cube of edge 1 and mass 1.
    pub fn new(cubes: &[Motion], response: Response) -> RigidMotion {
        let (mut compound, turning) = RigidMotion::momenta(cubes, response);
        let arms = (cubes.iter()).map(|cube| cube.position - compound.middle);
        compound.spin = spin(turning, arms, response);
        compound
    }

    /// Returns the motion of the common centre with spin 0, and the angular momentum about the
    /// centre.
    pub fn momenta(cubes: &[Motion], response: Response) -> (RigidMotion, Vector3<f64>) {
        let count = cubes.len() as f64;
        let middle = cubes.iter().map(|cube| cube.position).sum::<Vector3<f64>>() / count;
        let velocity = cubes.iter().map(|cube| cube.velocity).sum::<Vector3<f64>>() / count;
        let turning = |cube: &Motion| {
            (cube.position - middle).cross(&cube.velocity) / response.linear
                + cube.spin / (INVERSE_INERTIA * response.angular)
        };
        let compound = RigidMotion {
            middle,
            velocity,
            spin: Vector3::zeros(),
        };
        (compound, cubes.iter().map(turning).sum())
    }

    /// Returns the velocity and spin of the body's cube at a position.
    pub fn at(&self, position: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let velocity = self.velocity + self.spin.cross(&(position - self.middle));
        (velocity, self.spin)
    }
}

/// Returns the spin of a body with the angular momentum `turning`. `arms` are the positions of its
/// cubes relative to its centre.
pub(super) fn spin(
    turning: Vector3<f64>,
    arms: impl Iterator<Item = Vector3<f64>>,
    response: Response,
) -> Vector3<f64> {
    let own = 1.0 / (INVERSE_INERTIA * response.angular);
    let mut inertia = Matrix3::zeros();
    for arm in arms {
        let about = arm.norm_squared() / response.linear + own;
        inertia += Matrix3::identity() * about - arm * arm.transpose() / response.linear;
    }
    // The inertia is positive definite.
    (inertia.cholesky()).map_or(turning / own, |it| it.solve(&turning))
}

/// Returns the target poses of cubes, moved back by their common translation and rotation. Each of
/// `moves` is the start and target of a cube.
pub(super) fn without_drift(moves: &[[Pose; 2]]) -> impl Iterator<Item = Pose> {
    let motion = |[from, to]: &[Pose; 2]| Motion {
        position: from.position,
        velocity: to.position - from.position,
        spin: (to.rotation * from.rotation.inverse()).scaled_axis(),
    };
    let motions: Vec<Motion> = moves.iter().map(motion).collect();
    let whole = RigidMotion::new(&motions, Response::FREE);
    let from = Pose {
        position: whole.middle + whole.velocity,
        rotation: UnitQuaternion::identity(),
    };
    let to = Pose {
        position: whole.middle,
        rotation: UnitQuaternion::from_scaled_axis(-whole.spin),
    };
    moves.iter().map(move |[_, pose]| pose.carried(&from, &to))
}

/// Returns the kinetic energy that cubes lose when they take a common rigid motion \[block
/// lengths^2 / tick^2\].
pub(crate) fn lost(cubes: &[Motion]) -> f64 {
    let energy = |velocity: Vector3<f64>, spin: Vector3<f64>| {
        (velocity.norm_squared() + spin.norm_squared() / INVERSE_INERTIA) / 2.0
    };
    let compound = RigidMotion::new(cubes, Response::FREE);
    let each = |cube: &Motion| {
        let (velocity, spin) = compound.at(cube.position);
        energy(cube.velocity, cube.spin) - energy(velocity, spin)
    };
    cubes.iter().map(each).sum()
}
