//! Several cubes as one rigid body.
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::world::blocks::{Motion, Pose};
use crate::world::external_forces::Response;
use crate::world::unit_cube::INVERSE_INERTIA;

/// The motion of a rigid body that has the momentum and the angular momentum of its cubes.
///
/// In a viscous fluid velocities are means over a step, and what has given a cube its velocity was greater by 1 / φ, the
/// [`Response`]: cubes count as so much heavier. Where drag takes nearly all of a velocity in a step, that is their friction, by
/// which the body turns and diffuses then.
#[derive(Clone, Copy, Debug)]
pub(super) struct RigidMotion {
    pub middle: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub spin: Vector3<f64>,
}

impl RigidMotion {
    /// Of cubes of side 1 and mass 1; at least one.
    pub fn new(cubes: &[Motion], response: Response) -> RigidMotion {
        let (mut compound, turning) = RigidMotion::momenta(cubes, response);
        let arms = (cubes.iter()).map(|cube| cube.position - compound.middle);
        compound.spin = spin(turning, arms, response);
        compound
    }

    /// Their middle and its velocity, without a spin; and their angular momentum about it.
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
    response: Response,
) -> Vector3<f64> {
    let own = 1.0 / (INVERSE_INERTIA * response.angular);
    let mut inertia = Matrix3::zeros();
    for arm in arms {
        let about = arm.norm_squared() / response.linear + own;
        inertia += Matrix3::identity() * about - arm * arm.transpose() / response.linear;
    }
    // More than nothing in every direction.
    (inertia.cholesky()).map_or(turning / own, |it| it.solve(&turning))
}

/// Where cubes come to that go from here to there, less what they would move and turn by on the whole.
pub(super) fn without_drift(ways: &[[Pose; 2]]) -> impl Iterator<Item = Pose> {
    let way = |[from, to]: &[Pose; 2]| Motion {
        position: from.position,
        velocity: to.position - from.position,
        spin: (to.rotation * from.rotation.inverse()).scaled_axis(),
    };
    let motions: Vec<Motion> = ways.iter().map(way).collect();
    let whole = RigidMotion::new(&motions, Response::FREE);
    let from = Pose {
        position: whole.middle + whole.velocity,
        rotation: UnitQuaternion::identity(),
    };
    let to = Pose {
        position: whole.middle,
        rotation: UnitQuaternion::from_scaled_axis(-whole.spin),
    };
    ways.iter().map(move |[_, pose]| pose.carried(&from, &to))
}

/// Kinetic energy \[side^2 / tick^2\] that goes when cubes take the motion of one rigid body.
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
