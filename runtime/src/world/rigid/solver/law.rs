//! What a contact does.
use stochc_ir::scene::ContactLaw;

use crate::world::real::Real;
use crate::world::terms::Contact;

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
pub(super) struct Law<R> {
    pub friction: R,
    pub kind: Kind<R>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Kind<R> {
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
    pub fn new(contact: &Contact) -> Law<R> {
        Law {
            friction: R::of(contact.friction),
            kind: match contact.law {
                ContactLaw::Rigid { restitution } => Kind::Rigid {
                    restitution: R::of(restitution),
                },
                ContactLaw::Compliant { stiffness, damping } => Kind::Compliant {
                    stiffness: R::of(stiffness),
                    damping: R::of(damping),
                },
            },
        }
    }

    /// Of bodies that do not yield: how much of their approach they recede with.
    pub fn restitution(&self) -> Option<R> {
        match self.kind {
            Kind::Rigid { restitution } => Some(restitution),
            Kind::Compliant { .. } => None,
        }
    }
}
