//! Motions that make no sense, found in the substep that they appear in.
use super::bodies::Bodies;
use crate::world::Fault;
use crate::world::real::Real;

/// A faster block \[side / tick, rad / tick\] is a fault.
pub(super) const MOST_SPEED: f64 = 100.0;

/// A block farther from the plate \[side\] is a fault: single precision resolves its place no more.
pub(super) const FARTHEST: f64 = 1e5;

/// The first block whose motion makes no sense.
pub(super) fn find<R: Real>(bodies: &Bodies<R>) -> Option<Fault> {
    (0..bodies.count()).find_map(|i| check(bodies, i).err())
}

/// # Errors
/// If the motion of block `i` makes no sense.
pub(super) fn check<R: Real>(bodies: &Bodies<R>, i: usize) -> Result<(), Fault> {
    match absurdity(bodies, i) {
        Some(what) => Err(Fault {
            body: i as u32,
            what,
        }),
        None => Ok(()),
    }
}

/// What is wrong with a block, if something is.
fn absurdity<R: Real>(bodies: &Bodies<R>, i: usize) -> Option<String> {
    let speed = bodies.velocity(i).norm().double();
    let spin = bodies.spin[i].norm().double();
    let far = bodies.centre(i).norm().double();
    // What is not a number is not below anything.
    let sound = |value: f64, most: f64| value < most;
    if !sound(speed, MOST_SPEED) {
        Some(format!("its speed is {speed} sides per tick"))
    } else if !sound(spin, MOST_SPEED) {
        Some(format!("its spin is {spin} radians per tick"))
    } else if !sound(far, FARTHEST) {
        Some(format!("it is {far} sides from the plate"))
    } else if !bodies.rotation(i).coords.norm().is_finite() {
        Some("its orientation is not a number".to_owned())
    } else {
        None
    }
}
