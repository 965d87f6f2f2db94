//! Free flight: all effects on a block that do not depend on other blocks. These are wall, random
//! impulses, drag and motion.
use super::bodies::{Bodies, add};
use super::simd::{LANES, Lane, Wide, square};
use crate::counter_rng::{StepDraws, WORDS};
use crate::world::blocks::Blocks;
use crate::world::motion_limits::MotionLimits;
use crate::world::parameters::{self, Kicks};
use crate::world::wall_force::{WallForce, WallShape};

/// Number of SIMD groups between two checks of speeds and distances.
const CHECKED: usize = 8;

#[derive(Clone, Copy, Debug)]
pub(super) struct FreeFlight<R: Lane> {
    pub wall: Option<WallForce<R>>,
    /// Factors on the velocity in a long and in a short step.
    pub drag: Option<[R; 2]>,
    /// Length of a short step \[tick\].
    short: R,
    limits: MotionLimits,
    /// Whether blocks move only in a horizontal plane.
    is_planar: bool,
}

impl<R: Lane> FreeFlight<R> {
    pub fn new(
        wall: Option<parameters::Wall>,
        drag: Option<f64>,
        limits: MotionLimits,
        is_planar: bool,
        [long, short]: [f64; 2],
    ) -> FreeFlight<R> {
        FreeFlight {
            wall: wall.as_ref().map(WallForce::new),
            drag: drag.map(|rate| [long, short].map(|dt| R::from_double(libm::exp(-rate * dt)))),
            short: R::from_double(short),
            limits,
            is_planar,
        }
    }

    /// Changes all velocities, then moves all blocks. Returns whether all motions are valid.
    ///
    /// `kicks` are the random impulses of this substep, if it has any.
    pub fn fly(
        &self,
        bodies: &mut Bodies<R>,
        kicks: Option<(&Kicks, StepDraws<'_>)>,
        draws: &mut Vec<u8>,
    ) -> bool {
        let kicks = kicks.map(|(kicks, step)| {
            step.fill(bodies.groups().len() * LANES, draws);
            Kick::new(kicks)
        });
        match (kicks.is_some(), self.drag.is_some(), self.is_planar) {
            (true, true, false) => self.inside::<true, true, 3>(bodies, draws, kicks),
            (true, false, false) => self.inside::<true, false, 3>(bodies, draws, kicks),
            (false, true, false) => self.inside::<false, true, 3>(bodies, draws, kicks),
            (false, false, false) => self.inside::<false, false, 3>(bodies, draws, kicks),
            (true, true, true) => self.inside::<true, true, 2>(bodies, draws, kicks),
            (true, false, true) => self.inside::<true, false, 2>(bodies, draws, kicks),
            (false, true, true) => self.inside::<false, true, 2>(bodies, draws, kicks),
            (false, false, true) => self.inside::<false, false, 2>(bodies, draws, kicks),
        }
    }

    /// Processes all blocks with the walls of the scene, in 2 or 3 dimensions.
    fn inside<const KICKS: bool, const DRAG: bool, const DIMENSIONS: usize>(
        &self,
        bodies: &mut Bodies<R>,
        draws: &[u8],
        kicks: Option<Kick<R>>,
    ) -> bool {
        let Some(WallForce { shape, stiffness }) = self.wall else {
            return self.pass::<KICKS, DRAG, DIMENSIONS, _>(bodies, draws, kicks, NoWall);
        };
        match shape {
            WallShape::Ball { radius, height } => {
                let wall = Ball {
                    radius,
                    height,
                    stiffness,
                };
                self.pass::<KICKS, DRAG, DIMENSIONS, _>(bodies, draws, kicks, wall)
            }
            WallShape::Box { half, low, high } => {
                let wall = Planes {
                    limits: [(-half[0], half[0]), (-half[1], half[1]), (low, high)],
                    stiffness,
                };
                self.pass::<KICKS, DRAG, DIMENSIONS, _>(bodies, draws, kicks, wall)
            }
            WallShape::Cylinder { radius, low, high } => {
                let wall = Tube {
                    radius,
                    limits: (low, high),
                    stiffness,
                };
                self.pass::<KICKS, DRAG, DIMENSIONS, _>(bodies, draws, kicks, wall)
            }
        }
    }

    /// Moves the free blocks among `ids` by a short step, without random impulses.
    pub fn fly_short(&self, bodies: &mut Bodies<R>, ids: &[u32]) {
        for &id in ids {
            if !bodies.is_free(id) {
                continue;
            }
            let (position, mut velocity) = (bodies.position(id), bodies.velocity(id));
            if let Some(wall) = self.wall {
                velocity += wall.push(position) * bodies.span(id);
            }
            if let Some([_, drag]) = self.drag {
                velocity *= drag;
            }
            bodies.shift(id, velocity * self.short);
            bodies.set_moved(id, velocity);
        }
    }

    /// Processes all blocks in one pass. Absent terms are compiled out.
    fn pass<const KICKS: bool, const DRAG: bool, const DIMENSIONS: usize, W: WideWall<R>>(
        &self,
        bodies: &mut Bodies<R>,
        draws: &[u8],
        kicks: Option<Kick<R>>,
        wall: W,
    ) -> bool {
        let kick = kicks.unwrap_or(Kick::none());
        let [long, short] = self.drag.unwrap_or([R::one(); 2]).map(R::Wide::splat);
        let longer = R::Wide::splat(self.short * R::from_double(1.5));
        // Squares of speeds and distances relative to their limits. They are below one in valid
        // motion.
        let (speeds, ways) = (
            R::from_double(1.0 / (self.limits.speed * self.limits.speed)),
            R::from_double(1.0 / (self.limits.far * self.limits.far)),
        );
        let mut are_valid = true;
        let (words, _) = draws.as_chunks::<4>();
        let (words, _) = words.as_chunks::<{ WORDS as usize * LANES }>();
        let (speeds, ways) = (R::Wide::splat(speeds), R::Wide::splat(ways));
        let half = R::Wide::splat(R::from_double(0.5));
        let load = R::Wide::load;
        for (number, groups) in bodies.groups_mut().chunks_mut(CHECKED).enumerate() {
            let mut excess = R::Wide::splat(R::zero());
            for (nth, group) in groups.iter_mut().enumerate() {
                let mut x = group.position.each_ref().map(load);
                let mut rounded = group.rounded.each_ref().map(load);
                let mut v = group.velocity.each_ref().map(load);
                let mobility = load(&group.mobility);
                let dt = load(&group.step);
                if W::IS_WALL {
                    let span = (dt + load(&group.last)) * half;
                    let (way, pull) = wall.pull(&x);
                    let by = pull * span * mobility;
                    for axis in 0..DIMENSIONS {
                        v[axis] -= way[axis] * by;
                    }
                }
                if KICKS {
                    let kick = kick.draw::<DIMENSIONS>(&words[number * CHECKED + nth]);
                    for axis in 0..DIMENSIONS {
                        v[axis] += kick[axis] * mobility;
                    }
                }
                let drag = if DRAG {
                    dt.above(longer).choose(long, short)
                } else {
                    dt
                };
                for axis in 0..DIMENSIONS {
                    if DRAG {
                        v[axis] *= drag;
                    }
                    (x[axis], rounded[axis]) = add(x[axis], v[axis] * dt, rounded[axis]);
                }
                excess += square(v) * speeds + square(x) * ways;
                group.position = x.map(Wide::store);
                group.rounded = rounded.map(Wide::store);
                group.velocity = v.map(Wide::store);
            }
            // Comparisons with NaN are false.
            are_valid &= excess.store().iter().all(|&excess| excess < R::one());
        }
        are_valid
    }
}

/// SIMD form of [`WallForce::pull`].
trait WideWall<R: Lane>: Copy {
    const IS_WALL: bool = true;

    /// Returns vectors along the outward normals, and the inward accelerations per length of these
    /// vectors.
    fn pull(self, x: &[R::Wide; 3]) -> ([R::Wide; 3], R::Wide);
}

#[derive(Clone, Copy)]
struct NoWall;

impl<R: Lane> WideWall<R> for NoWall {
    const IS_WALL: bool = false;

    #[inline(always)]
    fn pull(self, x: &[R::Wide; 3]) -> ([R::Wide; 3], R::Wide) {
        (*x, R::Wide::splat(R::zero()))
    }
}

#[derive(Clone, Copy)]
struct Ball<R> {
    radius: R,
    height: R,
    stiffness: R,
}

impl<R: Lane> WideWall<R> for Ball<R> {
    #[inline(always)]
    fn pull(self, x: &[R::Wide; 3]) -> ([R::Wide; 3], R::Wide) {
        let way = [x[0], x[1], x[2] - R::Wide::splat(self.height)];
        let distance = square(way).sqrt();
        let zero = R::Wide::splat(R::zero());
        let depth = (distance - R::Wide::splat(self.radius)).maximum(zero);
        // Avoids a division by 0 at the centre, where the depth is 0 as well.
        let tiny = R::Wide::splat(R::from_double(1e-30));
        let pull = R::Wide::splat(self.stiffness) * depth / distance.maximum(tiny);
        (way, pull)
    }
}

/// Walls of a box.
#[derive(Clone, Copy)]
struct Planes<R> {
    /// Lower and upper limit of each coordinate.
    limits: [(R, R); 3],
    stiffness: R,
}

impl<R: Lane> WideWall<R> for Planes<R> {
    #[inline(always)]
    fn pull(self, x: &[R::Wide; 3]) -> ([R::Wide; 3], R::Wide) {
        let beyond = [0, 1, 2].map(|axis| outside::<R>(x[axis], self.limits[axis]));
        (beyond, R::Wide::splat(self.stiffness))
    }
}

/// Walls of a cylinder.
#[derive(Clone, Copy)]
struct Tube<R> {
    radius: R,
    /// Lower and upper limit of the height.
    limits: (R, R),
    stiffness: R,
}

impl<R: Lane> WideWall<R> for Tube<R> {
    #[inline(always)]
    fn pull(self, x: &[R::Wide; 3]) -> ([R::Wide; 3], R::Wide) {
        let across = (x[0] * x[0] + x[1] * x[1]).sqrt();
        let zero = R::Wide::splat(R::zero());
        let tiny = R::Wide::splat(R::from_double(1e-30));
        let depth = (across - R::Wide::splat(self.radius)).maximum(zero);
        let part = depth / across.maximum(tiny);
        let beyond = [x[0] * part, x[1] * part, outside::<R>(x[2], self.limits)];
        (beyond, R::Wide::splat(self.stiffness))
    }
}

/// Returns how far coordinates are above the upper limit, or below the lower one as negative
/// numbers.
#[inline(always)]
fn outside<R: Lane>(x: R::Wide, (low, high): (R, R)) -> R::Wide {
    let zero = R::Wide::splat(R::zero());
    (x - R::Wide::splat(high)).maximum(zero) - (R::Wide::splat(low) - x).maximum(zero)
}

/// Random impulses of speed `low + span u`, with u uniform in (0, 1), in isotropic directions.
#[derive(Clone, Copy, Debug)]
struct Kick<R> {
    low: R,
    span: R,
}

impl<R: Lane> Kick<R> {
    fn new(kicks: &Kicks) -> Kick<R> {
        let (low, high) = kicks.speed;
        Kick {
            low: R::from_double(low),
            span: R::from_double(high - low),
        }
    }

    fn none() -> Kick<R> {
        Kick {
            low: R::zero(),
            span: R::zero(),
        }
    }

    /// Returns the impulses of many blocks, from the same words as `counter_rng::direction` and
    /// `counter_rng::unit`. In 2 dimensions, they are horizontal.
    #[inline(always)]
    fn draw<const DIMENSIONS: usize>(
        &self,
        drawn: &[[u8; 4]; WORDS as usize * LANES],
    ) -> [R::Wide; 3] {
        let all = R::Wide::splat;
        let unit = |word: usize| {
            let mut bits = [R::zero(); LANES];
            for (lane, bits) in bits.iter_mut().enumerate() {
                let word = u32::from_le_bytes(drawn[lane * WORDS as usize + word]);
                *bits = R::from_integer((word >> 8) as i32);
            }
            // Midpoints of 2^24 bins, the resolution of single precision.
            let bin = all(R::from_double(1.0 / 16_777_216.0));
            (R::Wide::load(&bits) + all(R::from_double(0.5))) * bin
        };
        let speed = all(self.low) + all(self.span) * unit(0);
        if DIMENSIONS == 2 {
            let (sin, cos) = sincos_turns::<R>(unit(2));
            return [speed * cos, speed * sin, all(R::zero())];
        }
        let z = all(R::from_double(2.0)) * unit(1) - all(R::one());
        let across = (all(R::one()) - z * z).sqrt() * speed;
        let (sin, cos) = sincos_turns::<R>(unit(2));
        [across * cos, across * sin, speed * z]
    }
}

/// Returns the sine and cosine of 2 pi `turns` for `turns` in [0, 1], within 4e-8 plus rounding.
///
/// Uses polynomials instead of library functions, to compute many values at once.
#[inline(always)]
fn sincos_turns<R: Lane>(turns: R::Wide) -> (R::Wide, R::Wide) {
    let all = |value: f64| R::Wide::splat(R::from_double(value));
    // Half of the angle from the opposite direction, in half turns: from -1/2 to 1/2.
    let a = turns - all(0.5);
    let s = a * a;
    let mut cos = all(COS[0]);
    let mut sin = all(SIN[0]);
    for k in 1..COS.len() {
        cos = cos * s + all(COS[k]);
        sin = sin * s + all(SIN[k]);
    }
    let sin = sin * a;
    // Double-angle formulas. The sign is for the opposite direction.
    (all(-2.0) * sin * cos, all(2.0) * sin * sin - all(1.0))
}

/// Taylor coefficients of cos(pi a) in a^2, highest first. Accurate within 7e-9 for |a| <= 1/2.
const COS: [f64; 7] = series(0);

/// Taylor coefficients of sin(pi a) / a in a^2, highest first.
const SIN: [f64; 7] = series(1);

const fn series(odd: u32) -> [f64; 7] {
    let pi = std::f64::consts::PI;
    let mut coefficients = [0.0; 7];
    let mut term = if odd == 1 { pi } else { 1.0 };
    let mut k = 0;
    while k < 7 {
        coefficients[6 - k as usize] = term;
        let n = 2 * k + odd;
        term *= -pi * pi / ((n + 1) as f64 * (n + 2) as f64);
        k += 1;
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomials_agree_with_sine_and_cosine() {
        for i in 0..=1000 {
            let turns = f64::from(i) / 1000.0;
            let (sin, cos) = sincos_turns::<f64>(Wide::splat(turns));
            let (sin, cos) = (sin.store()[3], cos.store()[3]);
            let exact = libm::sincos(std::f64::consts::TAU * turns);
            assert!((sin - exact.0).abs() < 4e-8, "{turns}: {sin} {exact:?}");
            assert!((cos - exact.1).abs() < 4e-8, "{turns}: {cos} {exact:?}");
        }
    }
}
