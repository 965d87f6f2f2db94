//! Parameters of all physical terms, in block units.
use super::real::Real;
use crate::settings::{Model, Settings};
use nalgebra::Vector3;
use stochc_ir::scene::{ContactLaw, Interior, Measure};

/// Physical terms of a scene. `None` is a term that the scene does not have.
#[derive(Clone, Debug)]
pub(crate) struct WorldParameters {
    /// Whether blocks may take steps of different lengths.
    pub local: bool,
    /// Whether blocks move only in the plane z = 1/2.
    pub is_planar: bool,
    /// Deceleration of a sliding block by the table of a planar world \[block lengths / tick^2\].
    pub table: Option<f64>,
    pub wall: Option<Wall>,
    pub kicks: Option<Kicks>,
    /// Rate of the linear drag \[1 / tick\].
    pub drag: Option<f64>,
    /// Steady acceleration of every free block, e.g. by gravity minus buoyancy \[block lengths /
    /// tick^2\].
    pub acceleration: Option<Vector3<f64>>,
    pub fluid: Option<Resistance>,
    pub flow: Option<MeanFlow>,
    pub eddies: Option<Eddies>,
    /// Thermal energy k T \[block lengths^2 / tick^2\].
    pub thermal: Option<f64>,
    pub contact: Option<ContactParameters>,
    pub bond: Option<Magnet>,
}

/// Elastic walls around the centre of the plate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wall {
    /// Region outside which blocks are pushed back.
    pub interior: Interior,
    /// Whether blocks collide with the ground, so that it needs no elastic wall.
    pub has_solid_ground: bool,
    /// Acceleration per depth \[1 / tick^2\].
    pub stiffness: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Resistance {
    /// Rate of the viscous drag on velocity \[1 / tick\] and on spin. 0 without viscosity.
    pub viscous: (f64, f64),
    /// Deceleration per square of the speed \[1 / block length\] and of the spin \[1 / rad\]. 0
    /// without density.
    pub wake: (f64, f64),
    /// Fluid mass whose acceleration pushes a block: displaced plus added mass. 0 without density.
    pub displaced: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum MeanFlow {
    /// Vortex about the vertical axis.
    Vortex {
        /// Radius of the core in rigid rotation \[block lengths\].
        radius: f64,
        /// Angular velocity of the core \[rad / tick\].
        rate: f64,
    },
    /// Jets from the wall towards its centre, in a horizontal plane.
    Jets {
        count: u8,
        /// Speed at the outlet \[block lengths / tick\].
        speed: f64,
        /// Diameter of the outlet \[block lengths\].
        diameter: f64,
        /// Distance of the outlets from the axis \[block lengths\]. Infinite in a box.
        distance: f64,
        /// Distances of the outlets' walls in the east and the north \[block lengths\]. Infinite
        /// if the walls are round.
        walls: [f64; 2],
        /// Height of the plane \[block lengths\].
        height: f64,
    },
}

/// A random velocity field.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eddies {
    /// Rms speed in each horizontal direction \[block lengths / tick\].
    pub speed: f64,
    /// Ratio of vertical to horizontal rms speed.
    pub vertical: f64,
    /// Wavenumber \[rad / block length\].
    pub wavenumber: f64,
    /// Fraction of an amplitude that remains after a tick.
    pub left: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Kicks {
    /// Smallest and largest change of speed by a random impulse \[block lengths / tick\].
    pub speed: (f64, f64),
}

#[derive(Clone, Debug)]
pub(crate) struct ContactParameters {
    /// Contact law in block units: stiffness \[1 / tick^2\] and damping \[1 / tick\] for a mass of
    /// 1.
    pub law: ContactLaw,
    pub friction: f64,
}

/// Capture mechanism of a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Magnet {
    pub law: Attraction,
    pub measure: Measure,
    /// Capture distance \[block lengths\].
    pub within: f64,
    /// Cosine of the largest tilt for a capture.
    pub cos_tilt: f64,
    /// Whether captures are tested only at the end of each tick.
    pub sampled: bool,
    /// Displacement of a block at rest by a unit force during one step \[tick^2\]: the square of
    /// the step, reduced by drag.
    pub square_of_step: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Attraction {
    /// A face pulls while it is on.
    Switched { pull: Pull, align: Option<Pull> },
    /// Every face always pulls every other face.
    Passive(Passive),
    /// An open face draws fluid and pulls the block that closes it.
    Suction(Suction),
}

/// Permanent magnets in every face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passive {
    /// Force between two touching faces, as the acceleration of a block \[block lengths / tick^2\].
    pub hold: f64,
    /// Distance of a magnetic dipole below the centre of a face \[block lengths\]. The dipole
    /// attracts like the magnet of the face.
    pub depth: f64,
    /// Largest distance of the attraction \[block lengths\].
    pub within: f64,
    /// Velocity change of a rejected block \[block lengths / tick\].
    pub impulse: f64,
}

/// Faces with valves, and the pump, in block units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Suction {
    /// Largest pressure of the pump, as the acceleration of a block if this pressure acts on one
    /// face \[1 / tick^2\].
    pub head: f64,
    /// Hydraulic resistance between the pump and the plate \[1 / tick\].
    pub supply: f64,
    /// Hydraulic resistance of an open face's valve \[1 / tick\].
    pub valve: f64,
    /// Hydraulic resistance of the passage between a block and its holder \[1 / tick\].
    pub passage: f64,
    /// Distance below which a block closes the face \[block lengths\].
    pub seal: f64,
}

impl Magnet {
    /// Returns the largest distance between two face centres for any force or capture \[block
    /// lengths\].
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

    /// Returns the distance below which a block has entered the pull of a face \[block lengths\].
    pub fn field(&self) -> f64 {
        match self.law {
            Attraction::Switched { pull, .. } => pull.within,
            Attraction::Passive(passive) => passive.within,
            Attraction::Suction(_) => self.reach(),
        }
    }

    /// Returns how long before the end of a step the test for captures begins \[tick\]. This is the
    /// length `dt` of the step, or 0 if captures are tested only at its end.
    pub fn tested<R: Real>(&self, dt: R) -> R {
        if self.sampled { R::zero() } else { dt }
    }

    /// Returns the largest distance between two face centres for a capture \[block lengths\].
    pub fn anchoring(&self) -> f64 {
        match self.measure {
            Measure::Centres | Measure::Corners => self.within,
            Measure::Gap => self.within.hypot(0.5),
        }
    }
}

/// Force of constant magnitude.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull {
    /// Acceleration \[block lengths / tick^2\].
    pub force: f64,
    /// Largest distance of the force \[block lengths\].
    pub within: f64,
}

impl WorldParameters {
    /// Returns the number of steps per tick for blocks away from magnetized faces, then the number
    /// for blocks near them.
    pub fn rates(&self, settings: &Settings) -> [u32; 2] {
        let short = settings.substeps.max(1);
        let long = settings
            .away
            .filter(|_| self.local && settings.model == Model::Rigid);
        [long.unwrap_or(short), short]
    }

    /// Multiplies these terms by `response`: the steady acceleration, random impulses, rejections,
    /// the force of the wall, and forces of compliant contacts.
    ///
    /// `response` is the effect of a force over one step with drag, divided by its effect without
    /// drag. `dt` is the length of a step \[tick\].
    pub fn weakened(mut self, response: f64, dt: f64) -> WorldParameters {
        if let Some(magnet) = &mut self.bond {
            magnet.square_of_step = dt * dt * response;
            if let Attraction::Passive(Passive { impulse, .. }) = &mut magnet.law {
                *impulse *= response;
            }
        }
        if let Some(wall) = &mut self.wall {
            wall.stiffness *= response;
        }
        if let Some(acceleration) = &mut self.acceleration {
            *acceleration *= response;
        }
        // A velocity is the mean over a step, so drag reduces an impulse already in its first step.
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
