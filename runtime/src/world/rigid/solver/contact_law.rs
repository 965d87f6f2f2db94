//! Laws of the contact force.
use stochc_ir::scene::ContactLaw;

use crate::world::parameters::ContactParameters;
use crate::world::real::Real;
use crate::world::rigid::simd::{Lane, Quad};

/// Fraction of an overlap that is corrected per substep.
pub(super) const RECOVERY: f64 = 0.2;

/// Depth of overlap that is tolerated \[block lengths\].
pub(super) const SLOP: f64 = 0.001;

/// Largest speed of overlap correction \[block lengths / tick\].
pub(super) const FASTEST: f64 = 0.1;

/// Relative tolerance of velocities, as a fraction of the fastest approach.
pub(super) const PRECISION: f64 = 1e-4;

/// Law of all contacts.
#[derive(Clone, Copy, Debug)]
pub struct Law<R> {
    pub friction: R,
    pub kind: LawKind<R>,
}

#[derive(Clone, Copy, Debug)]
pub enum LawKind<R> {
    Rigid {
        restitution: R,
    },
    /// Force per depth \[1 / tick^2\] and per speed \[1 / tick\], for a block of mass 1.
    Compliant {
        stiffness: R,
        damping: R,
    },
}

impl<R: Real> Law<R> {
    pub fn new(contact: &ContactParameters) -> Law<R> {
        Law {
            friction: R::from_double(contact.friction),
            kind: match contact.law {
                ContactLaw::Rigid { restitution } => LawKind::Rigid {
                    restitution: R::from_double(restitution),
                },
                ContactLaw::Compliant { stiffness, damping } => LawKind::Compliant {
                    stiffness: R::from_double(stiffness),
                    damping: R::from_double(damping),
                },
            },
        }
    }

    /// Returns the stiffness of compliant contacts \[1 / tick^2\].
    pub fn stiffness(&self) -> Option<R> {
        match self.kind {
            LawKind::Rigid { .. } => None,
            LawKind::Compliant { stiffness, .. } => Some(stiffness),
        }
    }

    pub fn restitution(&self) -> Option<R> {
        match self.kind {
            LawKind::Rigid { restitution } => Some(restitution),
            LawKind::Compliant { .. } => None,
        }
    }
}

/// Spring with a damper, as a condition on the impulse of a step.
///
/// After an impulse x, the separation speed of the bodies must be `target - softness * x`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring<W> {
    pub target: W,
    pub softness: W,
}

impl<W: Copy> Spring<W> {
    /// Returns the spring for an overlap `depth` and a separation speed `parting`. `yields` is the
    /// velocity change per unit impulse, and `h` is the length of the step.
    ///
    /// The impulse x satisfies x = h (k (d - h (s u' + b (u' - u))) - c (u + t (u' - u))). Here k
    /// is the stiffness, c the damping and d the overlap. The separation speed is u before the step
    /// and u' after it. Velocities lag positions by half a step.
    ///
    /// If a step resolves the spring, s = 0 and b = 1/12. The method is then of second order and
    /// does not dissipate. The error of a period is of fourth order. For more than a radian per
    /// step, s grows to 1, the implicit Euler method, which dissipates. The damper acts on the mean
    /// velocity, t = 1/2, and at most stops the bodies.
    ///
    /// # Source
    ///
    /// L. Fox and E. T. Goodwin (1949).
    pub fn new<R>(stiffness: R, damping: R, h: W, depth: W, parting: W, yields: W) -> Spring<W>
    where
        R: Lane<Quad = W>,
        W: Quad<R>,
    {
        let of = |value: f64| W::splat(R::from_double(value));
        let (k, c) = (W::splat(stiffness), W::splat(damping));
        let late = of(1.0) - of(1.0) / (h * h * k * yields).maximum(of(1.0));
        let curved = (of(1.0) - late) * of(1.0 / 12.0);
        let stopped = (of(1.0) - of(1.0) / (h * c * yields)).maximum(of(0.5));
        let firmness = h * h * k * (late + curved) + h * c * stopped;
        let softness = of(1.0) / firmness;
        let push = h * (k * (depth - late * h * parting) - c * parting);
        Spring {
            target: parting + push * softness,
            softness,
        }
    }
}
