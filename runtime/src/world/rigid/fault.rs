//! Motions that make no sense, found in the substep that they appear in.
use super::bodies::Bodies;
use crate::world::Fault;
use crate::world::limits::Limits;
use crate::world::real::Real;

/// The first block whose motion makes no sense.
pub(super) fn find<R: Real>(bodies: &Bodies<R>, limits: &Limits) -> Option<Fault> {
    (0..bodies.count()).find_map(|i| check(bodies, limits, i).err())
}

/// # Errors
/// If the motion of block `i` makes no sense.
pub(super) fn check<R: Real>(bodies: &Bodies<R>, limits: &Limits, i: usize) -> Result<(), Fault> {
    match absurdity(bodies, limits, i) {
        Some(what) => Err(Fault {
            body: i as u32,
            what,
        }),
        None => Ok(()),
    }
}

/// What is wrong with a block, if something is.
fn absurdity<R: Real>(bodies: &Bodies<R>, limits: &Limits, i: usize) -> Option<String> {
    let speed = bodies.velocity(i).norm().double();
    let spin = bodies.spin[i].norm().double();
    let far = bodies.centre(i).norm().double();
    let length = bodies.rotation(i).coords.norm().double();
    limits.excess(speed, spin, far, length)
}
