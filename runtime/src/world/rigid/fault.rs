//! Motions that make no sense, found in the substep that they appear in.
use super::bodies::Bodies;
use super::lanes::Lane;
use crate::world::Fault;
use crate::world::limits::Limits;

/// The first block whose motion makes no sense.
pub(super) fn find<R: Lane>(bodies: &Bodies<R>, limits: &Limits) -> Option<Fault> {
    (0..bodies.count()).find_map(|i| check(bodies, limits, i).err())
}

/// # Errors
/// If the motion of block `i` makes no sense.
pub(super) fn check<R: Lane>(bodies: &Bodies<R>, limits: &Limits, i: usize) -> Result<(), Fault> {
    if is_well_within(bodies, limits, i) {
        return Ok(());
    }
    match absurdity(bodies, limits, i) {
        Some(what) => Err(Fault {
            body: i as u32,
            what,
        }),
        None => Ok(()),
    }
}

/// Whether a block is far from all limits: quicker to see than whether it is within them.
fn is_well_within<R: Lane>(bodies: &Bodies<R>, limits: &Limits, i: usize) -> bool {
    let below = |square: R, most: f64| square < R::of(0.99 * most * most);
    below(bodies.velocity(i).norm_squared(), limits.speed)
        && below(bodies.spin[i].norm_squared(), limits.spin)
        && below(bodies.centre(i).norm_squared(), limits.far)
        && below(bodies.rotation(i).coords.norm_squared(), 2.0)
}

/// What is wrong with a block, if something is.
fn absurdity<R: Lane>(bodies: &Bodies<R>, limits: &Limits, i: usize) -> Option<String> {
    let speed = bodies.velocity(i).norm().double();
    let spin = bodies.spin[i].norm().double();
    let far = bodies.centre(i).norm().double();
    let length = bodies.rotation(i).coords.norm().double();
    limits.excess(speed, spin, far, length)
}
