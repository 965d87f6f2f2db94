//! What a contact does.
use stochc_ir::scene::ContactLaw;

use crate::world::parameters::ContactParameters;
use crate::world::real::Real;
use crate::world::rigid::simd::{Lane, Quad};

/// Part of an overlap that is undone in a substep.
pub(super) const RECOVERY: f64 = 0.2;

/// Overlap that is left alone \[side\].
pub(super) const SLOP: f64 = 0.001;

/// Fastest recovery from an overlap \[side / tick\].
pub(super) const FASTEST: f64 = 0.1;

/// Changes of velocity below this part of the fastest approach are left alone.
pub(super) const PRECISION: f64 = 1e-4;

/// The law of all contacts.
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
    /// Per depth \[1 / tick^2\] and per speed \[1 / tick\], for a block of mass 1.
    Compliant {
        stiffness: R,
        damping: R,
    },
}

impl<R: Real> Law<R> {
    pub fn new(contact: &ContactParameters) -> Law<R> {
        Law {
            friction: R::of(contact.friction),
            kind: match contact.law {
                ContactLaw::Rigid { restitution } => LawKind::Rigid {
                    restitution: R::of(restitution),
                },
                ContactLaw::Compliant { stiffness, damping } => LawKind::Compliant {
                    stiffness: R::of(stiffness),
                    damping: R::of(damping),
                },
            },
        }
    }

    /// Of bodies that yield \[1 / tick^2\].
    pub fn stiffness(&self) -> Option<R> {
        match self.kind {
            LawKind::Rigid { .. } => None,
            LawKind::Compliant { stiffness, .. } => Some(stiffness),
        }
    }

    /// Of bodies that do not yield: how much of their approach they recede with.
    pub fn restitution(&self) -> Option<R> {
        match self.kind {
            LawKind::Rigid { restitution } => Some(restitution),
            LawKind::Compliant { .. } => None,
        }
    }
}

/// The spring and the damper of a step, as what an impulse x has to bring about: that the bodies part at the speed
/// `target - softness x`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring<W> {
    pub target: W,
    pub softness: W,
}

impl<W: Copy> Spring<W> {
    /// For bodies that overlap by `depth`, part at the speed `parting`, and whose speed a unit impulse changes by
    /// `yields`.
    ///
    /// With u' the speed after the step, x = h (k (d - h (s u' + b (u' - u))) - c (u + t (u' - u))). Velocities are half
    /// a step behind places. As long as a step resolves the spring, s = 0 and b = 1/12, which is of second order and
    /// takes no energy (the error of a period is of the fourth order, Fox and Goodwin 1949); where the spring turns
    /// by more than a radian in a step, s grows to 1, the implicit Euler method, which only takes. The damper
    /// is felt at the mean velocity, t = 1/2, and at most stops the bodies.
    pub fn new<R>(stiffness: R, damping: R, h: W, depth: W, parting: W, yields: W) -> Spring<W>
    where
        R: Lane<Quad = W>,
        W: Quad<R>,
    {
        let of = |value: f64| W::splat(R::of(value));
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
