//! The physical world of a program, in SI units.
//!
//! Each field of [`Scene`] is one term of the model. `None` is a term that does not exist: a
//! runtime must not compute it, not even with a zero.
mod bond;
pub mod describe;
pub mod groups;
mod medium;
pub mod quantity;
pub mod room;
mod scalar_error;
pub mod scalars;
pub mod schema;
mod substeps;
pub mod units;
pub mod warnings;

pub use bond::{Anchor, Bond, BondKind, Magnets, Measure, Pump, Reach};
pub use medium::{Agitation, BOLTZMANN, Drag, Flow, Fluid, Jets, Stir, Strength, Turbulence};
pub use substeps::{Substeps, takes_local_steps};

use serde::{Deserialize, Serialize};

use crate::Cell;
use crate::plate::Plate;

/// A world of free blocks around a seed plate, or without one.
///
/// The ground is the plane z = 0 through the plate's upper faces, with the centre of the plate at
/// the origin; blocks float above it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Its name in the program.
    pub name: String,
    /// The clock: kicks fall, messages travel and times are told once a tick \[s\].
    pub tick: f64,
    /// The cubes.
    pub block: Block,
    /// The blocks that float at the beginning.
    pub free: Free,
    /// What keeps them together.
    pub enclosure: Option<Enclosure>,
    /// What pulls them down \[m/s^2\]; a fluid with a density bears them up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<f64>,
    /// What they float in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fluid: Option<Fluid>,
    /// How it flows on the average.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow: Option<Flow>,
    /// What moves them by chance.
    pub agitation: Option<Agitation>,
    /// What slows them between collisions.
    pub drag: Option<Drag>,
    /// How two of them, or one and the ground, collide; absent: they pass through each other.
    pub contact: Option<Contact>,
    /// How a magnetized face captures.
    pub bond: Option<Bond>,
    /// What a message costs; absent: nothing, a message arrives in the tick it is sent in.
    pub messages: Option<Messages>,
}

impl Scene {
    /// Returns the mass of a block and of the fluid that it takes along \[kg\].
    pub fn inertial_mass(&self) -> f64 {
        let fluid = self.fluid.as_ref();
        self.block.mass + fluid.map_or(0.0, |fluid| fluid.taken_along(self.block.side))
    }

    /// Whether every number is one that it may be: the scene may have been read from a file.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn validate(&self) -> Result<(), String> {
        for scalar in scalars::scalars(self) {
            if let Some(value) = scalar.get(self) {
                scalar.check(value).map_err(|error| error.to_string())?;
            }
        }
        match &self.agitation {
            Some(Agitation::Kicks { speed }) if speed.0 > speed.1 => {
                Err("`agitation.speed.low` is more than the upper end".to_owned())
            }
            _ => Ok(()),
        }
    }
}

/// The one kind of block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// Edge of the cube \[m\].
    pub side: f64,
    /// Mass \[kg\], spread evenly.
    pub mass: f64,
    /// Faces that one block can magnetize at the same time, 1 to 5.
    pub faces: u8,
}

/// The blocks that float at the beginning, at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Free {
    /// How many.
    pub count: u32,
    /// Where.
    pub arrangement: Arrangement,
}

/// Where free blocks are at tick 0; the same in every run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// A cubic lattice that fills the enclosure.
    Uniform,
    /// Evenly on a level circle about the vertical axis, halfway up the enclosure, the first in the
    /// east.
    Ring {
        /// Of the circle through the blocks' centres \[m\].
        radius: f64,
    },
}

/// What keeps the free blocks together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Enclosure {
    /// A half ball on the ground: a flat, solid floor at z = 0, and an elastic shell.
    Hemisphere {
        /// Of the shell \[m\].
        radius: f64,
        /// Force per depth on the centre of a block that is outside the shell, inward \[N/m\].
        wall: f64,
    },
    /// A ball, cut off by the ground so that the cut just holds the plate, or that it just touches the
    /// ground where there is none; see [`Enclosure::centre_height`].
    Sphere {
        /// Of the shell \[m\].
        radius: f64,
        /// Force per depth on a block whose inscribed ball reaches through the shell, inward \[N/m\].
        wall: f64,
    },
}

impl Enclosure {
    /// Of the shell \[m\].
    pub fn radius(&self) -> f64 {
        let (Enclosure::Hemisphere { radius, .. } | Enclosure::Sphere { radius, .. }) = *self;
        radius
    }

    /// From the shell's centre to where the centre of a block of this side is pushed back \[m\].
    pub fn reach(&self, side: f64) -> f64 {
        match *self {
            Enclosure::Hemisphere { radius, .. } => radius,
            Enclosure::Sphere { radius, .. } => radius - side / 2.0,
        }
    }

    /// Height of the shell's centre over the ground \[m\], around a plate of blocks of this side \[m\].
    pub fn centre_height(&self, plate: &Plate, side: f64) -> f64 {
        match *self {
            Enclosure::Hemisphere { .. } => 0.0,
            Enclosure::Sphere { radius, .. } => {
                let corner = f64::from(plate.width).hypot(f64::from(plate.depth)) / 2.0 * side;
                (radius * radius - corner * corner).max(0.0).sqrt()
            }
        }
    }

    /// Distance from the shell's centre to the farthest point of a block in `cell` \[m\], with blocks of this side \[m\].
    pub fn distance_to(&self, cell: Cell, plate: &Plate, side: f64) -> f64 {
        let middle = self.centre_height(plate, side) / side;
        let centre = |edge: u32| (f64::from(edge) - 1.0) / 2.0;
        let x = (f64::from(cell.x) - centre(plate.width)).abs() + 0.5;
        let y = (f64::from(cell.y) - centre(plate.depth)).abs() + 0.5;
        let (top, bottom) = (f64::from(cell.z), f64::from(cell.z) - 1.0);
        let z = (top - middle).abs().max((bottom - middle).abs());
        (x * x + y * y + z * z).sqrt() * side
    }
}

/// Collisions of blocks with each other, the structure and the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// What keeps them apart.
    #[serde(flatten)]
    pub law: ContactLaw,
    /// Coulomb's coefficient.
    pub friction: f64,
}

/// What keeps two blocks apart, or one and the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ContactLaw {
    /// They never overlap, but for what the time step lets through.
    Rigid {
        /// 0: inelastic, 1: elastic.
        restitution: f64,
    },
    /// A pair that overlaps by a depth d repels with `stiffness d + damping d'`, and never
    /// attracts; it does so at its deepest point.
    Compliant {
        /// Force per depth \[N/m\], more than 0.
        stiffness: f64,
        /// Force per speed at which the depth grows \[N s/m\], at least 0.
        damping: f64,
    },
}

/// What a message costs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Messages {
    /// Ticks that a message takes from a block to its parent or child.
    pub hop: u32,
    /// Probability that a hop is lost, and that its acknowledgement is; absent: none ever is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_in_json_names_the_fields_of_its_kind() {
        for (json, law) in [
            (
                r#"{"restitution":0.0,"friction":0.2}"#,
                ContactLaw::Rigid { restitution: 0.0 },
            ),
            (
                r#"{"stiffness":25.0,"damping":5.0,"friction":0.2}"#,
                ContactLaw::Compliant {
                    stiffness: 25.0,
                    damping: 5.0,
                },
            ),
        ] {
            let contact = Contact { law, friction: 0.2 };
            assert_eq!(serde_json::to_string(&contact).unwrap(), json);
            assert_eq!(serde_json::from_str::<Contact>(json).unwrap(), contact);
        }
        let neither = serde_json::from_str::<Contact>(r#"{"friction":0.2}"#);
        assert!(neither.is_err(), "{neither:?}");
    }
}
