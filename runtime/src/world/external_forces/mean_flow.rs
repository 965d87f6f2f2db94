//! Mean flow of a fluid.
use std::f64::consts::{LN_2, TAU};

use nalgebra::Vector3;

use super::local_flow::LocalFlow;
use crate::world::parameters::MeanFlow;

/// Length of the core of a round turbulent jet, in diameters of the outlet.
///
/// # Source
///
/// S. B. Pope, Turbulent Flows (2000), section 5.1.
const CORE: f64 = 6.2;
/// Half-width of a round turbulent jet, divided by the distance from its origin along its axis.
const SPREAD: f64 = 0.094;

pub(super) fn add(stream: &MeanFlow, position: Vector3<f64>, wind: &mut LocalFlow) {
    match *stream {
        MeanFlow::Vortex { radius, rate } => {
            let across = position.x.hypot(position.y);
            let turning = if across < radius {
                rate
            } else {
                rate * (radius / across) * (radius / across)
            };
            wind.velocity += Vector3::new(-position.y, position.x, 0.0) * turning;
            // Centripetal acceleration, provided by pressure.
            wind.acceleration -= Vector3::new(position.x, position.y, 0.0) * (turning * turning);
            if across < radius {
                wind.spin.z += rate;
            }
        }
        MeanFlow::Jets {
            count,
            speed,
            diameter,
            distance,
            walls,
            height,
        } => {
            for jet in 0..count {
                let angle = TAU * f64::from(jet) / f64::from(count);
                let (sin, cos) = libm::sincos(angle);
                let out = Vector3::new(cos, sin, 0.0);
                let distance = distance.min(walls[0] / cos.abs()).min(walls[1] / sin.abs());
                let from = out * distance + Vector3::z() * height;
                let displacement = position - from;
                let along = -displacement.dot(&out);
                if along <= 0.0 {
                    continue;
                }
                let aside = displacement + out * along;
                let half = (SPREAD * along).max(diameter / 2.0);
                let middle = speed * (CORE * diameter / along).min(1.0);
                let square = aside.norm_squared() / (half * half);
                let here = middle * libm::exp(-LN_2 * square);
                wind.velocity -= out * here;
                // Half of the curl of the velocity u(aside) along -out.
                let slope = -2.0 * LN_2 / (half * half) * here;
                wind.spin += aside.cross(&-out) * (slope / 2.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wind(stream: &MeanFlow, position: Vector3<f64>) -> LocalFlow {
        let mut wind = LocalFlow::default();
        add(stream, position, &mut wind);
        wind
    }

    /// Returns half of the curl of the velocity, by finite differences.
    fn spin(stream: &MeanFlow, position: Vector3<f64>) -> Vector3<f64> {
        let h = 1e-5;
        let slope = |axis: Vector3<f64>| {
            let (more, less) = (
                wind(stream, position + axis * h),
                wind(stream, position - axis * h),
            );
            (more.velocity - less.velocity) / (2.0 * h)
        };
        let (x, y, z) = (
            slope(Vector3::x()),
            slope(Vector3::y()),
            slope(Vector3::z()),
        );
        Vector3::new(y.z - z.y, z.x - x.z, x.y - y.x) / 2.0
    }

    const VORTEX: MeanFlow = MeanFlow::Vortex {
        radius: 2.0,
        rate: 0.1,
    };

    #[test]
    fn a_vortex_turns_as_a_whole_within_and_without_vorticity_outside() {
        let inside = wind(&VORTEX, Vector3::new(1.0, 0.0, 5.0));
        assert!((inside.velocity - Vector3::new(0.0, 0.1, 0.0)).norm() < 1e-12);
        let outside = wind(&VORTEX, Vector3::new(0.0, 4.0, 5.0));
        assert!((outside.velocity - Vector3::new(-0.1, 0.0, 0.0)).norm() < 1e-12);
        for position in [Vector3::new(0.3, 1.0, 0.0), Vector3::new(3.0, -1.0, 2.0)] {
            let computed = wind(&VORTEX, position);
            assert!(
                (computed.spin - spin(&VORTEX, position)).norm() < 1e-8,
                "{position}"
            );
            // In steady flow, the acceleration is (u . grad) u.
            let (h, u) = (1e-5, computed.velocity);
            let ahead = wind(&VORTEX, position + u * h).velocity;
            let behind = wind(&VORTEX, position - u * h).velocity;
            let slope = (ahead - behind) / (2.0 * h);
            assert!((computed.acceleration - slope).norm() < 1e-8, "{position}");
        }
    }

    #[test]
    fn a_jet_conserves_momentum_and_rotates_neighbours() {
        let jets = MeanFlow::Jets {
            count: 1,
            speed: 0.5,
            diameter: 0.2,
            distance: 6.0,
            walls: [f64::INFINITY; 2],
            height: 3.0,
        };
        // Momentum flow through a plane across the jet, as a sum over rings about the jet's axis.
        let momentum = |along: f64| {
            let ring = |aside: f64| {
                let position = Vector3::new(6.0 - along, aside, 3.0);
                let speed = wind(&jets, position).velocity.norm();
                TAU * aside * speed * speed * 1e-3
            };
            (0..4000)
                .map(|i| ring((f64::from(i) + 0.5) * 1e-3))
                .sum::<f64>()
        };
        let (near, far) = (momentum(2.0), momentum(5.0));
        assert!((near / far - 1.0).abs() < 1e-5, "{near} {far}");
        // Momentum flow out of the tube. The measured constants are accurate to a few percent.
        let tube = 0.5 * 0.5 * std::f64::consts::FRAC_PI_4 * 0.2 * 0.2;
        assert!((far / tube - 1.0).abs() < 0.1, "{far} {tube}");
        for position in [Vector3::new(2.0, 0.3, 3.1), Vector3::new(-1.0, -0.5, 2.6)] {
            // The gradient along the jet is neglected.
            let computed = wind(&jets, position).spin;
            let exact = spin(&jets, position);
            assert!(
                (computed - exact).norm() < 0.2 * exact.norm(),
                "{computed} {exact}"
            );
        }
    }
}
