//! Scenes as plain values.
use serde::{Deserialize, Serialize};

use super::bond::Bond;
use super::enclosure::Enclosure;
use super::medium::{Agitation, Drag, Flow, Fluid};

/// World of free blocks around a seed plate, or without one.
///
/// The ground is the plane z = 0 through the plate's upper faces, with the centre of the plate at
/// the origin. Blocks float above it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Name in the program.
    pub name: String,
    /// Tick \[s\]: interval of random impulses and message hops, and unit of reported times.
    pub tick: f64,
    /// Blocks.
    pub block: Block,
    /// Free blocks at the start.
    pub free: Free,
    /// Planar world. `None` if blocks move in space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planar: Option<Planar>,
    /// Enclosure of the free blocks.
    pub enclosure: Option<Enclosure>,
    /// Position of the plate. `None` if the plate is on the floor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mount: Option<Mount>,
    /// Gravity \[m/s^2\]. A fluid with a density adds buoyancy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<f64>,
    /// Fluid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fluid: Option<Fluid>,
    /// Mean flow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow: Option<Flow>,
    /// Agitation.
    pub agitation: Option<Agitation>,
    /// Drag between collisions.
    pub drag: Option<Drag>,
    /// Contact between blocks and with the ground. `None` lets blocks pass through each other and
    /// through the ground.
    pub contact: Option<Contact>,
    /// Capture and bonding of free blocks. `None` captures no blocks.
    pub bond: Option<Bond>,
    /// Message parameters. If `None`, a message arrives in the tick of its sending.
    pub messages: Option<Messages>,
    /// Hardware faults. `None` if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub faults: Option<Faults>,
}

impl Scene {
    /// Returns the mass of a block including the added mass of fluid \[kg\].
    pub(crate) fn inertial_mass(&self) -> f64 {
        let fluid = self.fluid.as_ref();
        self.block.mass + fluid.map_or(0.0, |fluid| fluid.taken_along(self.block.side))
    }

    /// Returns whether bonds of the structure can break.
    pub fn has_breaking_bonds(&self) -> bool {
        (self.bond.as_ref()).is_some_and(|bond| bond.strength().is_some())
    }

    /// Returns the scene without hardware faults and with bonds that do not break. Both scenes have
    /// the same waiting times.
    #[must_use]
    pub fn without_failures(&self) -> Scene {
        let mut scene = self.clone();
        scene.faults = None;
        if let Some(strength) = scene.bond.as_mut().and_then(Bond::strength_mut) {
            *strength = None;
        }
        scene
    }

    /// Returns the direction of gravity in the frame of the structure, as a unit vector.
    pub fn gravity_direction(&self) -> [i32; 3] {
        match self.mount {
            None => [0, 0, -1],
            Some(Mount::Wall) => [0, -1, 0],
            Some(Mount::Roof) => [0, 0, 1],
        }
    }

    /// Returns the coefficient of friction with the table. `None` outside of planar worlds, and if
    /// the table has no friction.
    pub fn table_friction(&self) -> Option<f64> {
        self.planar.as_ref().and_then(|planar| planar.friction)
    }

    /// Returns the name of the first term that is not part of the rate law. Rates of such a scene
    /// need a held-out error. The uncalibrated estimate does not support such scenes.
    pub fn uncalibrated_term(&self) -> Option<&'static str> {
        let of_bond = match &self.bond {
            Some(Bond::Reject { .. }) => Some("bond by magnets that always attract"),
            Some(Bond::Suction { .. }) => Some("bond by suction"),
            _ => None,
        };
        if of_bond.is_some() {
            of_bond
        } else if self.planar.is_some() {
            Some("planar world")
        } else if self.fluid.is_some() || self.flow.is_some() {
            Some("fluid")
        } else if self.gravity.is_some() {
            Some("gravity")
        } else {
            None
        }
    }

    /// Returns the scene in a still medium without boundaries: without enclosure, agitation,
    /// gravity and flow. Viscous drag remains. Blocks have their inertial mass.
    pub fn in_still_medium(&self) -> Scene {
        let viscosity = self.fluid.as_ref().and_then(|fluid| fluid.viscosity);
        Scene {
            planar: None,
            mount: None,
            enclosure: None,
            agitation: None,
            gravity: None,
            flow: None,
            block: Block {
                mass: self.inertial_mass(),
                ..self.block.clone()
            },
            fluid: viscosity.map(|viscosity| Fluid {
                density: None,
                viscosity: Some(viscosity),
                added_mass: None,
            }),
            ..self.clone()
        }
    }
}

/// Position of a plate that is not on the floor. The frame of the structure, with its enclosure and
/// its flows, turns with the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mount {
    /// The plate is on a wall, and gravity points to the south of the structure.
    Wall,
    /// The plate is on the roof, and gravity points upward in the structure.
    Roof,
}

/// Planar world. Blocks slide on a table, which is the ground, level with the plate. They turn only
/// about the vertical axis. All blocks are in the layer z = 1, also those of the plate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Planar {
    /// Coefficient of Coulomb friction with the table. `None` if the table has no friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
}

impl Planar {
    /// Layer of the cells of all blocks.
    pub const LAYER: i32 = 1;

    /// Mean distance of the points of a square from its centre, for an edge of 1: (√2 + ln(1 +
    /// √2)) / 6. It is the lever arm of the friction that opposes turning.
    pub const ARM: f64 = 0.382_597_858_232_105_8;
}

/// Block properties. All blocks are equal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// Block length \[m\].
    pub side: f64,
    /// Mass \[kg\], uniformly distributed.
    pub mass: f64,
    /// Number of faces that one block can magnetize at the same time, 1 to 5.
    pub faces: u8,
}

/// Number and arrangement of the free blocks at the start. They start at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Free {
    /// Number of free blocks.
    pub count: u32,
    /// Arrangement of the free blocks at the start.
    pub arrangement: Arrangement,
}

/// Positions of the free blocks at tick 0, equal in all runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// Cubic lattice that fills the enclosure.
    Uniform,
    /// Horizontal circle about the vertical axis at half height of the enclosure, evenly spaced.
    /// The first block is in the east.
    Ring {
        /// Radius of the circle through the blocks' centres \[m\].
        radius: f64,
    },
}

/// Contacts of blocks with each other, the structure and the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Law of the normal force.
    #[serde(flatten)]
    pub law: ContactLaw,
    /// Coefficient of Coulomb friction.
    pub friction: f64,
}

/// Law of the normal force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ContactLaw {
    /// Bodies do not overlap, except for errors of the time step.
    Rigid {
        /// Coefficient of restitution. 0: inelastic, 1: elastic.
        restitution: f64,
    },
    /// Bodies with an overlap d repel by `stiffness d + damping d'`, never attract. The force acts
    /// at the deepest point.
    Compliant {
        /// Force per depth \[N/m\], more than 0.
        stiffness: f64,
        /// Force per rate of the depth \[N s/m\], at least 0.
        damping: f64,
    },
}

/// Timing and loss of messages.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Messages {
    /// Time of a hop between parent and child \[ticks\].
    pub hop: u32,
    /// Probability that a hop or its acknowledgement is lost. `None` if messages are never lost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss: Option<f64>,
}

/// Hardware faults. At least one field is given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Faults {
    /// Probability that a block is dead during the whole run. `None` if no block is dead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dead: Option<f64>,
    /// Probability that a capture fails because the latch does not hold. `None` if all latches
    /// hold.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latch: Option<f64>,
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
