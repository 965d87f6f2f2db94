//! Elastic walls that enclose the blocks.
use nalgebra::Vector3;
use stochc_ir::scene::Interior;

use super::parameters::Wall;
use super::real::Real;

/// Elastic walls in the precision of a world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallForce<R> {
    pub shape: WallShape<R>,
    /// Acceleration per depth \[1 / tick^2\].
    pub stiffness: R,
}

/// Region where walls exert no force, in the precision of a world. See [`Interior`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum WallShape<R> {
    Ball { radius: R, height: R },
    Box { half: [R; 2], low: R, high: R },
    Cylinder { radius: R, low: R, high: R },
}

impl<R: Real> WallForce<R> {
    pub fn new(wall: &Wall) -> WallForce<R> {
        let interior = if wall.has_solid_ground {
            wall.interior.on_solid_ground()
        } else {
            wall.interior
        };
        let to = R::from_double;
        WallForce {
            shape: match interior {
                Interior::Ball { radius, height } => WallShape::Ball {
                    radius: to(radius),
                    height: to(height),
                },
                Interior::Box { half, low, high } => WallShape::Box {
                    half: half.map(to),
                    low: to(low),
                    high: to(high),
                },
                Interior::Cylinder { radius, low, high } => WallShape::Cylinder {
                    radius: to(radius),
                    low: to(low),
                    high: to(high),
                },
            },
            stiffness: to(wall.stiffness),
        }
    }

    /// Returns the acceleration that the walls give a block at a position \[block lengths /
    /// tick^2\].
    pub fn push(&self, position: Vector3<R>) -> Vector3<R> {
        let pull = self.pull(position);
        pull.map_or_else(Vector3::zeros, |(way, pull)| way * -pull)
    }

    /// Returns a vector along the outward normal and the inward acceleration per length of this
    /// vector \[1 / tick^2\]. Returns `None` if no wall acts on the block.
    pub fn pull(&self, position: Vector3<R>) -> Option<(Vector3<R>, R)> {
        let beyond = match self.shape {
            WallShape::Ball { radius, height } => {
                let way = position - Vector3::z() * height;
                // Fast path without a square root: most blocks are far inside.
                if way.norm_squared() < R::from_double(0.99) * radius * radius {
                    return None;
                }
                let distance = way.norm();
                let depth = distance - radius;
                return (depth > R::zero()).then(|| (way, self.stiffness * depth / distance));
            }
            WallShape::Box { half, low, high } => Vector3::new(
                outside(position.x, -half[0], half[0]),
                outside(position.y, -half[1], half[1]),
                outside(position.z, low, high),
            ),
            WallShape::Cylinder { radius, low, high } => {
                let across = (position.x * position.x + position.y * position.y).sqrt();
                let part = if across > radius {
                    (across - radius) / across
                } else {
                    R::zero()
                };
                let z = outside(position.z, low, high);
                Vector3::new(position.x * part, position.y * part, z)
            }
        };
        (beyond != Vector3::zeros()).then_some((beyond, self.stiffness))
    }
}

/// Returns how far a coordinate is above `high`, or below `low` as a negative number.
fn outside<R: Real>(position: R, low: R, high: R) -> R {
    (position - high).max(R::zero()) - (low - position).max(R::zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The force is the gradient of the signed distance, times the depth and the stiffness.
    #[test]
    fn walls_push_along_the_gradient_of_the_signed_distance() {
        let (low, high) = (0.5, 4.0);
        let half = [2.0, 3.0];
        for interior in [
            Interior::Ball {
                radius: 3.0,
                height: 1.0,
            },
            Interior::Box { half, low, high },
            Interior::Cylinder {
                radius: 2.5,
                low,
                high,
            },
        ] {
            let wall = WallForce::<f64>::new(&Wall {
                interior,
                has_solid_ground: false,
                stiffness: 0.7,
            });
            for n in 0..4096 {
                let at = |digit: u32| f64::from(n >> (4 * digit) & 15) - 7.3;
                let position = Vector3::new(at(0), at(1), at(2));
                let distance = |position: Vector3<f64>| interior.distance(position.into());
                let depth = distance(position).max(0.0);
                let slope = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| {
                    let h = 1e-6;
                    (distance(position + axis * h) - distance(position - axis * h)) / (2.0 * h)
                });
                let expected = Vector3::from(slope) * (-0.7 * depth);
                let error = (wall.push(position) - expected).norm();
                assert!(error < 1e-5, "{interior:?} {position}: {error}");
            }
        }
    }
}
