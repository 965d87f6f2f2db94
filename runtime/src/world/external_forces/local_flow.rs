//! Flow of the fluid at a position.
use nalgebra::Vector3;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LocalFlow {
    pub(super) velocity: Vector3<f64>,
    /// Half of the vorticity: the spin of a small suspended body.
    pub(super) spin: Vector3<f64>,
    /// Acceleration of the fluid by pressure, without eddies and jets.
    pub(super) acceleration: Vector3<f64>,
}
