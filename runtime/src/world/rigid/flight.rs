//! What all blocks do in every substep, wherever the others are: shell, kicks, drag, and moving on.
use super::bodies::{Bodies, LANES};
use super::fault::{FARTHEST, MOST_SPEED};
use crate::draw::{Step, WORDS};
use crate::world::real::Real;
use crate::world::terms::{Hemisphere, Kicks};

/// One component of [`LANES`] blocks.
type Lanes<R> = [R; LANES];

/// The terms that act on all blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight<R: Real> {
    pub shell: Option<Shell<R>>,
    /// Factor on the velocity in each substep.
    pub drag: Option<R>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Shell<R> {
    radius: R,
    /// Change of velocity per depth in a substep.
    pull: R,
}

impl<R: Real> Flight<R> {
    pub fn new(shell: Option<Hemisphere>, drag: Option<f64>, dt: f64) -> Flight<R> {
        Flight {
            shell: shell.map(|shell| Shell {
                radius: R::of(shell.radius),
                pull: R::of(shell.stiffness * dt),
            }),
            drag: drag.map(|rate| R::of(libm::exp(-rate * dt))),
        }
    }

    /// Changes all velocities, then moves all blocks; whether all motions still make sense.
    ///
    /// `kicks` are those of this substep, if it is one that has kicks.
    pub fn fly(
        &self,
        bodies: &mut Bodies<R>,
        kicks: Option<(&Kicks, Step<'_>)>,
        draws: &mut Vec<u8>,
    ) -> bool {
        let kicks = kicks.map(|(kicks, step)| {
            step.fill(bodies.count().next_multiple_of(LANES), draws);
            Kick::new(kicks)
        });
        if kicks.is_some() {
            self.shell_or_not::<true>(bodies, draws, kicks)
        } else {
            self.shell_or_not::<false>(bodies, draws, kicks)
        }
    }

    fn shell_or_not<const KICKS: bool>(
        &self,
        bodies: &mut Bodies<R>,
        draws: &[u8],
        kicks: Option<Kick<R>>,
    ) -> bool {
        if self.shell.is_some() {
            self.drag_or_not::<KICKS, true>(bodies, draws, kicks)
        } else {
            self.drag_or_not::<KICKS, false>(bodies, draws, kicks)
        }
    }

    fn drag_or_not<const KICKS: bool, const SHELL: bool>(
        &self,
        bodies: &mut Bodies<R>,
        draws: &[u8],
        kicks: Option<Kick<R>>,
    ) -> bool {
        if self.drag.is_some() {
            self.pass::<KICKS, SHELL, true>(bodies, draws, kicks)
        } else {
            self.pass::<KICKS, SHELL, false>(bodies, draws, kicks)
        }
    }

    /// One pass over all blocks; a term that is absent leaves no code behind.
    fn pass<const KICKS: bool, const SHELL: bool, const DRAG: bool>(
        &self,
        bodies: &mut Bodies<R>,
        draws: &[u8],
        kicks: Option<Kick<R>>,
    ) -> bool {
        let dt = bodies.dt;
        let kick = kicks.unwrap_or(Kick::NONE());
        let shell = self.shell.unwrap_or(Shell {
            radius: R::zero(),
            pull: R::zero(),
        });
        let drag = self.drag.unwrap_or(R::one());
        let most_speed = R::of(MOST_SPEED * MOST_SPEED);
        let farthest = R::of(FARTHEST * FARTHEST);
        let mut absurd = 0u32;
        let [px, py, pz] = bodies
            .position
            .each_mut()
            .map(|x| x.as_chunks_mut::<LANES>().0);
        let [vx, vy, vz] = bodies
            .velocity
            .each_mut()
            .map(|v| v.as_chunks_mut::<LANES>().0);
        let mobility = bodies.mobility.as_chunks::<LANES>().0;
        let (words, _) = draws.as_chunks::<4>();
        let (words, _) = words.as_chunks::<{ WORDS as usize * LANES }>();
        let groups = mobility.len();
        let (px, py, pz) = (&mut px[..groups], &mut py[..groups], &mut pz[..groups]);
        let (vx, vy, vz) = (&mut vx[..groups], &mut vy[..groups], &mut vz[..groups]);
        for group in 0..groups {
            let mut x = [px[group], py[group], pz[group]];
            let mut v = [vx[group], vy[group], vz[group]];
            if SHELL {
                shell.push(&x, &mut v, &mobility[group]);
            }
            if KICKS {
                kick.push(&words[group], &mut v, &mobility[group]);
            }
            for axis in 0..3 {
                for lane in 0..LANES {
                    if DRAG {
                        v[axis][lane] *= drag;
                    }
                    x[axis][lane] += v[axis][lane] * dt;
                }
            }
            for lane in 0..LANES {
                let square = |a: R, b: R, c: R| a * a + b * b + c * c;
                let speed = square(v[0][lane], v[1][lane], v[2][lane]);
                let far = square(x[0][lane], x[1][lane], x[2][lane]);
                // What is not a number is not below anything.
                absurd |= u32::from(!(speed < most_speed)) | u32::from(!(far < farthest));
            }
            [px[group], py[group], pz[group]] = x;
            [vx[group], vy[group], vz[group]] = v;
        }
        absurd == 0
    }
}

impl<R: Real> Shell<R> {
    /// A spring on the centre of whoever is outside.
    #[inline(always)]
    fn push(&self, x: &[Lanes<R>; 3], v: &mut [Lanes<R>; 3], mobility: &Lanes<R>) {
        for lane in 0..LANES {
            let square =
                x[0][lane] * x[0][lane] + x[1][lane] * x[1][lane] + x[2][lane] * x[2][lane];
            let distance = square.sqrt();
            let depth = distance - self.radius;
            let outside = if depth > R::zero() { depth } else { R::zero() };
            // Inside, the distance may be 0 and does not matter.
            let by = if depth > R::zero() {
                distance
            } else {
                R::one()
            };
            let factor = mobility[lane] * (self.pull * outside / by);
            v[0][lane] -= x[0][lane] * factor;
            v[1][lane] -= x[1][lane] * factor;
            v[2][lane] -= x[2][lane] * factor;
        }
    }
}

/// Kicks of speed `low + span u`, u evenly spread over (0, 1), in an isotropic direction.
#[derive(Clone, Copy, Debug)]
struct Kick<R> {
    low: R,
    span: R,
}

impl<R: Real> Kick<R> {
    fn new(kicks: &Kicks) -> Kick<R> {
        let (low, high) = kicks.speed;
        Kick {
            low: R::of(low),
            span: R::of(high - low),
        }
    }

    #[expect(non_snake_case, reason = "a constant, but for the generic type")]
    fn NONE() -> Kick<R> {
        Kick {
            low: R::zero(),
            span: R::zero(),
        }
    }

    /// The same words as `draw::direction` and `draw::unit` read, computed for many blocks at once.
    #[inline(always)]
    fn push(
        &self,
        drawn: &[[u8; 4]; WORDS as usize * LANES],
        v: &mut [Lanes<R>; 3],
        mobility: &Lanes<R>,
    ) {
        // Midpoints of 2^24 bins: what single precision can tell apart.
        let bin = R::of(1.0 / 16_777_216.0);
        let half = R::of(0.5);
        let two = R::of(2.0);
        let word = |lane: usize, word: usize| {
            (u32::from_le_bytes(drawn[lane * WORDS as usize + word]) >> 8) as i32
        };
        let mut kicked = [[R::zero(); LANES]; 3];
        for lane in 0..LANES {
            for (k, row) in kicked.iter_mut().enumerate() {
                row[lane] = (R::of_int(word(lane, k)) + half) * bin;
            }
        }
        for lane in 0..LANES {
            let speed = (self.low + self.span * kicked[0][lane]) * mobility[lane];
            let z = two * kicked[1][lane] - R::one();
            let across = (R::one() - z * z).sqrt() * speed;
            let (sin, cos) = sincos_turns(kicked[2][lane]);
            v[0][lane] += across * cos;
            v[1][lane] += across * sin;
            v[2][lane] += speed * z;
        }
    }
}

/// Sine and cosine of 2 pi `turns`, for `turns` in [0, 1], within 4e-9 but for rounding.
///
/// By polynomials instead of the library's functions, so that many are computed side by side.
#[inline(always)]
fn sincos_turns<R: Real>(turns: R) -> (R, R) {
    // In half turns from the opposite direction: -1 .. 1.
    let t = (turns - R::of(0.5)) * R::of(2.0);
    let size = t.abs();
    // A quarter turn off: sin(pi |t|) = cos(pi b), cos(pi |t|) = -sin(pi b).
    let b = size - R::of(0.5);
    let s = b * b;
    let mut cos = R::of(COS[0]);
    let mut sin = R::of(SIN[0]);
    for k in 1..COS.len() {
        cos = cos * s + R::of(COS[k]);
        sin = sin * s + R::of(SIN[k]);
    }
    // Opposite to half a turn: both change sign.
    let y = if t < R::zero() { -cos } else { cos };
    (-y, sin * b)
}

/// Taylor coefficients of cos(pi b) in b^2, highest first: within 1e-10 for |b| <= 1/2.
const COS: [f64; 7] = series(0);

/// The same of sin(pi b) / b.
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
    fn the_polynomials_are_sine_and_cosine() {
        for i in 0..=1000 {
            let turns = f64::from(i) / 1000.0;
            let (sin, cos) = sincos_turns(turns);
            let exact = libm::sincos(std::f64::consts::TAU * turns);
            assert!((sin - exact.0).abs() < 1e-8, "{turns}: {sin} {exact:?}");
            assert!((cos - exact.1).abs() < 1e-8, "{turns}: {cos} {exact:?}");
        }
    }
}
