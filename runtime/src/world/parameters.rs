//! The numbers of all terms of the physics, in block units.
use super::real::Real;
use crate::settings::{Model, Settings};
use stochc_ir::scene::room::Interior;
use stochc_ir::scene::{ContactLaw, Measure};

/// The terms in force; `None` is a term that does not exist.
#[derive(Clone, Debug)]
pub(crate) struct WorldParameters {
    /// Whether blocks may take steps of different lengths.
    pub local: bool,
    pub shell: Option<Shell>,
    pub kicks: Option<Kicks>,
    /// Rate of the linear drag \[1 / tick\].
    pub drag: Option<f64>,
    /// Acceleration of gravity less buoyancy, downward \[side / tick^2\].
    pub weight: Option<f64>,
    pub fluid: Option<Resistance>,
    pub flow: Option<MeanFlow>,
    pub eddies: Option<Eddies>,
    /// Of a degree of freedom, k T \[side^2 / tick^2\].
    pub thermal: Option<f64>,
    pub contact: Option<ContactParameters>,
    pub bond: Option<Magnet>,
}

/// An elastic shell about a point over the middle of the plate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shell {
    /// Farther from its centre, the centre of a block is pushed back \[side\].
    pub radius: f64,
    /// Of its centre \[side\].
    pub height: f64,
    /// Acceleration per depth \[1 / tick^2\].
    pub stiffness: f64,
}

impl Shell {
    /// What is within it.
    pub fn interior(&self) -> Interior {
        Interior {
            radius: self.radius,
            height: self.height,
        }
    }
}

/// What a fluid does to a block that moves through it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resistance {
    /// Rate of the viscous drag on velocity \[1 / tick\] and on spin; 0 without viscosity.
    pub viscous: (f64, f64),
    /// Deceleration over the square of the speed \[1 / side\], and of the spin \[1 / rad\]; 0 without density.
    pub wake: (f64, f64),
    /// Mass of fluid whose acceleration pushes a block: displaced and taken along; 0 without density.
    pub displaced: f64,
}

/// How a fluid flows on the average.
#[derive(Clone, Copy, Debug)]
pub(crate) enum MeanFlow {
    /// About the vertical axis.
    Vortex {
        /// Of the part that turns as a whole \[side\].
        radius: f64,
        /// Of that part \[rad / tick\].
        rate: f64,
    },
    /// From the shell towards its middle, in a level plane.
    Jets {
        count: u8,
        /// At a tube \[side / tick\].
        speed: f64,
        /// Of a tube \[side\].
        diameter: f64,
        /// Of the tubes' ends from the middle \[side\].
        distance: f64,
        /// Of the plane \[side\].
        height: f64,
    },
}

/// A random field of velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eddies {
    /// Rms in each level direction \[side / tick\].
    pub speed: f64,
    /// Vertical rms over that.
    pub vertical: f64,
    /// \[rad / side\]
    pub wavenumber: f64,
    /// Part of an eddy that is left after a tick.
    pub left: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Kicks {
    /// Least and most change of speed \[side / tick\].
    pub speed: (f64, f64),
}

#[derive(Clone, Debug)]
pub(crate) struct ContactParameters {
    /// In block units: stiffness \[1 / tick^2\] and damping \[1 / tick\] for a mass of 1.
    pub law: ContactLaw,
    pub friction: f64,
}

/// How a face captures.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Magnet {
    pub law: Attraction,
    pub measure: Measure,
    /// Anchoring distance \[side\].
    pub within: f64,
    /// Cosine of the greatest tilt at which a block is anchored.
    pub cos_tilt: f64,
    /// Anchoring is tested at the end of each tick only.
    pub sampled: bool,
    /// What a unit force moves a block at rest by in a step \[tick^2\]: the square of its length, less what drag takes.
    pub square_of_step: f64,
}

/// What a face does to a block in its reach.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Attraction {
    /// A face that is on pulls.
    Switched { pull: Pull, align: Option<Pull> },
    /// Every face pulls every other one.
    Passive(Passive),
    /// A face that is open draws fluid, and pulls what closes it.
    Suction(Suction),
}

/// Magnets in every face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passive {
    /// Of two faces that touch \[side / tick^2\].
    pub hold: f64,
    /// Of two opposite dipoles then \[side\].
    pub depth: f64,
    /// Reach \[side\].
    pub within: f64,
    /// Change of velocity of a block that is rejected \[side / tick\].
    pub impulse: f64,
}

/// Faces with valves, and what drives the fluid, in block units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Suction {
    /// Pressure drop that the pump can make \[1 / tick^2\], as the acceleration of a block of which it
    /// acts on one face.
    pub head: f64,
    /// Hydraulic resistances \[1 / tick\].
    pub supply: f64,
    pub valve: f64,
    pub passage: f64,
    /// Closer than this, a block closes the face \[side\].
    pub seal: f64,
}

impl Magnet {
    /// Beyond this distance between the centres of two faces, nothing is felt, and no block is anchored \[side\].
    pub fn reach(&self) -> f64 {
        let felt = match self.law {
            Attraction::Switched { pull, align } => {
                pull.within.max(align.map_or(0.0, |align| align.within))
            }
            Attraction::Passive(passive) => passive.within,
            Attraction::Suction(suction) => suction.seal,
        };
        felt.max(self.anchoring())
    }

    /// A block that is closer has come into the reach of the pull, and is counted \[side\].
    pub fn field(&self) -> f64 {
        match self.law {
            Attraction::Switched { pull, .. } => pull.within,
            Attraction::Passive(passive) => passive.within,
            Attraction::Suction(_) => self.reach(),
        }
    }

    /// Returns how much of the way before the end of a step of length `dt` is tested for anchoring \[tick\].
    pub fn tested<R: Real>(&self, dt: R) -> R {
        if self.sampled { R::zero() } else { dt }
    }

    /// Beyond this distance between the centres of two faces, no block is anchored \[side\].
    pub fn anchoring(&self) -> f64 {
        match self.measure {
            Measure::Centres | Measure::Corners => self.within,
            Measure::Gap => self.within.hypot(0.5),
        }
    }
}

/// A force of constant magnitude.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull {
    /// Acceleration \[side / tick^2\].
    pub force: f64,
    /// Reach \[side\].
    pub within: f64,
}

impl WorldParameters {
    /// How many steps a tick blocks take away from magnetized faces and near them.
    pub fn rates(&self, settings: &Settings) -> [u32; 2] {
        let short = settings.substeps.max(1);
        let long = settings
            .away
            .filter(|_| self.local && settings.model == Model::Rigid);
        [long.unwrap_or(short), short]
    }

    /// Where a force leaves only this part of its effect in a step: what drag takes of kicks, rejections, walls and contacts is
    /// not there to move a block.
    ///
    /// `dt`: length of a step \[tick\].
    pub fn weakened(mut self, response: f64, dt: f64) -> WorldParameters {
        if let Some(magnet) = &mut self.bond {
            magnet.square_of_step = dt * dt * response;
            if let Attraction::Passive(Passive { impulse, .. }) = &mut magnet.law {
                *impulse *= response;
            }
        }
        if let Some(shell) = &mut self.shell {
            shell.stiffness *= response;
        }
        if let Some(weight) = &mut self.weight {
            *weight *= response;
        }
        // A velocity is the mean over a step, and drag begins with the kick.
        if let Some(Kicks { speed: (low, high) }) = &mut self.kicks {
            *low *= response;
            *high *= response;
        }
        if let Some(ContactParameters {
            law: ContactLaw::Compliant { stiffness, damping },
            ..
        }) = &mut self.contact
        {
            *stiffness *= response;
            *damping *= response;
        }
        self
    }
}
