//! What all blocks do in every substep, wherever the others are: shell, kicks, drag, and moving on.
use super::bodies::Bodies;
use super::fault::{FARTHEST, MOST_SPEED};
use super::neighbours::Neighbours;
use crate::draw::{Step, WORDS};
use crate::world::real::Real;
use crate::world::terms::{Hemisphere, Kicks};

/// Blocks that are computed side by side.
const LANES: usize = 8;

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

/// What a flight has come to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Landing {
    /// Some block's motion makes no sense any more.
    pub absurd: bool,
    /// Some block has moved so far that the list of neighbours is not to be trusted.
    pub stale: bool,
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

    /// Changes all velocities, then moves all blocks.
    ///
    /// `kicks` are those of this substep, if it is one that has kicks.
    pub fn fly(
        &self,
        bodies: &mut Bodies<R>,
        neighbours: Option<&Neighbours<R>>,
        kicks: Option<(&Kicks, Step<'_>)>,
        draws: &mut Vec<u8>,
    ) -> Landing {
        let kicks = kicks.map(|(kicks, step)| {
            step.fill(bodies.count().next_multiple_of(LANES), draws);
            Kick::new(kicks)
        });
        if kicks.is_some() {
            self.shell_or_not::<true>(bodies, neighbours, draws, kicks)
        } else {
            self.shell_or_not::<false>(bodies, neighbours, draws, kicks)
        }
    }

    fn shell_or_not<const KICKS: bool>(
        &self,
        bodies: &mut Bodies<R>,
        neighbours: Option<&Neighbours<R>>,
        draws: &[u8],
        kicks: Option<Kick<R>>,
    ) -> Landing {
        if self.shell.is_some() {
            self.drag_or_not::<KICKS, true>(bodies, neighbours, draws, kicks)
        } else {
            self.drag_or_not::<KICKS, false>(bodies, neighbours, draws, kicks)
        }
    }

    fn drag_or_not<const KICKS: bool, const SHELL: bool>(
        &self,
        bodies: &mut Bodies<R>,
        neighbours: Option<&Neighbours<R>>,
        draws: &[u8],
        kicks: Option<Kick<R>>,
    ) -> Landing {
        if self.drag.is_some() {
            self.pass::<KICKS, SHELL, true>(bodies, neighbours, draws, kicks)
        } else {
            self.pass::<KICKS, SHELL, false>(bodies, neighbours, draws, kicks)
        }
    }

    /// One pass over all blocks; a term that is absent leaves no code behind.
    fn pass<const KICKS: bool, const SHELL: bool, const DRAG: bool>(
        &self,
        bodies: &mut Bodies<R>,
        neighbours: Option<&Neighbours<R>>,
        draws: &[u8],
        kicks: Option<Kick<R>>,
    ) -> Landing {
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
        let [px, py, pz] = &mut bodies.position;
        let [vx, vy, vz] = &mut bodies.velocity;
        let words = WORDS as usize * 4 * LANES;
        let lanes = |n: usize| n.div_ceil(LANES);
        for group in 0..lanes(bodies.mobility.len()) {
            let from = group * LANES;
            let to = (from + LANES).min(bodies.mobility.len());
            let mut x = [load(px, from, to), load(py, from, to), load(pz, from, to)];
            let mut v = [load(vx, from, to), load(vy, from, to), load(vz, from, to)];
            let mobility = load(&bodies.mobility, from, to);
            if SHELL {
                shell.push(&x, &mut v, &mobility);
            }
            if KICKS {
                let drawn = &draws[group * words..][..words];
                kick.push(drawn, &mut v, &mobility);
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
            store(px, from, to, &x[0]);
            store(py, from, to, &x[1]);
            store(pz, from, to, &x[2]);
            store(vx, from, to, &v[0]);
            store(vy, from, to, &v[1]);
            store(vz, from, to, &v[2]);
        }
        Landing {
            absurd: absurd != 0,
            stale: neighbours.is_some_and(|list| list.is_stale(&bodies.position)),
        }
    }
}

#[inline(always)]
fn load<R: Real>(from: &[R], start: usize, end: usize) -> Lanes<R> {
    match from[start..end].first_chunk::<LANES>() {
        Some(full) => *full,
        None => {
            let mut lanes = [R::zero(); LANES];
            lanes[..end - start].copy_from_slice(&from[start..end]);
            lanes
        }
    }
}

#[inline(always)]
fn store<R: Real>(to: &mut [R], start: usize, end: usize, lanes: &Lanes<R>) {
    match to[start..end].first_chunk_mut::<LANES>() {
        Some(full) => *full = *lanes,
        None => to[start..end].copy_from_slice(&lanes[..end - start]),
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
    fn push(&self, drawn: &[u8], v: &mut [Lanes<R>; 3], mobility: &Lanes<R>) {
        // Midpoints of 2^24 bins: what single precision can tell apart.
        let bin = R::of(1.0 / 16_777_216.0);
        let half = R::of(0.5);
        let two = R::of(2.0);
        let word = |lane: usize, word: usize| {
            let at = (lane * WORDS as usize + word) * 4;
            let bytes = [drawn[at], drawn[at + 1], drawn[at + 2], drawn[at + 3]];
            (u32::from_le_bytes(bytes) >> 8) as i32
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
