//! The physical world of a program, in SI units.
//!
//! Each field of [`Scene`] is one term of the model. `None` is a term that does not exist: a
//! runtime must not compute it, not even with a zero.
mod builtin;
pub mod describe;
pub mod groups;
mod read;
pub mod scalars;
mod spelling;
mod units;

pub use builtin::{BUILT_IN, DEFAULT, built_in};
pub(crate) use read::read;
pub(crate) use spelling::unit_meant;

use serde::{Deserialize, Serialize};

/// A world of free blocks around a seed plate.
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
    /// What moves them.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// A cubic lattice that fills the enclosure.
    Uniform,
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
}

/// What moves the free blocks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Agitation {
    /// Once a tick every free block gets an impulse through its centre of mass.
    Kicks {
        /// Range of the uniformly drawn change of speed \[m/s\]; its direction is isotropic.
        speed: (f64, f64),
    },
}

/// Linear drag on the velocity of the centre of mass: v' = -rate v.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drag {
    /// \[1/s\]
    pub rate: f64,
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
    /// attracts; the points of the patch share this in proportion to their depths.
    Compliant {
        /// Force per depth \[N/m\], more than 0.
        stiffness: f64,
        /// Force per speed at which the depth grows \[N s/m\], at least 0.
        damping: f64,
    },
}

/// How a magnetized face captures a free block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bond {
    /// A face is switched on to capture; distances are between the centres of two faces.
    Attract {
        /// Pulls the centre of the nearest face of every free block in reach.
        pull: Reach,
        /// Pulls each of that face's four corners to its counterpart.
        align: Option<Reach>,
        /// When the block is anchored.
        anchor: Anchor,
    },
}

/// A force of constant magnitude, within a distance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reach {
    /// \[N\]
    pub force: f64,
    /// Between the centres of the two faces \[m\].
    pub within: f64,
}

/// When a block is anchored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Anchor {
    /// What is measured.
    pub measure: Measure,
    /// Closer than this \[m\].
    pub within: f64,
    /// And the normals of the two faces less than this from opposite \[rad\].
    pub tilt: f64,
}

/// What the anchoring distance is measured between.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// The centres of the two faces.
    Centres,
    /// Along the normal of the magnetized face only, with the lateral offset under half a side.
    Gap,
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
