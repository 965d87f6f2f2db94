//! Capture and bonding of free blocks.
use serde::{Deserialize, Serialize};

/// Kind of bond between structure and blocks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bond {
    /// A face is switched on to capture. Distances are between the centres of two faces.
    Attract {
        /// Pull of the face on every free block within reach. The pull acts on the centre of the
        /// block's nearest face.
        pull: Reach,
        /// Pull on each corner of the block's nearest face, towards the matching corner of the open
        /// face.
        align: Option<Reach>,
        /// Condition of a capture.
        anchor: Anchor,
        /// Strength of a bond. `None` if bonds do not break.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        strength: Option<BondStrength>,
    },
    /// Every face always attracts. A face is switched on to reject its block.
    Reject {
        /// Permanent magnets in every face of every block.
        magnets: Magnets,
        /// Condition of a bond.
        anchor: Anchor,
        /// Impulse on a rejected block along the normal of the face \[N s\].
        impulse: f64,
    },
    /// A valve is opened to capture: the face draws fluid, and blocks with it.
    Suction {
        /// Pump and flow resistances.
        pump: Pump,
        /// Range of the pressure drop of the face: largest distance between the face centres \[m\].
        /// `None` for the default of [`Suction`](super::Suction).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        seal: Option<f64>,
        /// Condition of a capture. `None` for the default of [`Suction`](super::Suction).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        anchor: Option<Anchor>,
        /// Strength of a bond. `None` if bonds do not break.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        strength: Option<BondStrength>,
    },
}

/// Kind of a [`Bond`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BondKind {
    /// [`Bond::Attract`]
    #[default]
    Attract,
    /// [`Bond::Reject`]
    Reject,
    /// [`Bond::Suction`]
    Suction,
}

impl Bond {
    /// Returns the kind of the bond.
    pub const fn kind(&self) -> BondKind {
        match self {
            Bond::Attract { .. } => BondKind::Attract,
            Bond::Reject { .. } => BondKind::Reject,
            Bond::Suction { .. } => BondKind::Suction,
        }
    }

    pub(super) const fn anchor_mut(&mut self) -> Option<&mut Anchor> {
        match self {
            Bond::Attract { anchor, .. } | Bond::Reject { anchor, .. } => Some(anchor),
            Bond::Suction { anchor, .. } => anchor.as_mut(),
        }
    }

    /// Returns the condition of a capture. Returns `None` if the default applies.
    pub const fn anchor(&self) -> Option<&Anchor> {
        match self {
            Bond::Attract { anchor, .. } | Bond::Reject { anchor, .. } => Some(anchor),
            Bond::Suction { anchor, .. } => anchor.as_ref(),
        }
    }

    /// Returns the strength of a bond, to change it. Returns `None` for permanent magnets.
    pub const fn strength_mut(&mut self) -> Option<&mut Option<BondStrength>> {
        match self {
            Bond::Attract { strength, .. } | Bond::Suction { strength, .. } => Some(strength),
            Bond::Reject { .. } => None,
        }
    }

    /// Returns the strength of a bond of the structure. Returns `None` if these bonds do not break.
    pub const fn strength(&self) -> Option<&BondStrength> {
        match self {
            Bond::Attract { strength, .. } | Bond::Suction { strength, .. } => strength.as_ref(),
            Bond::Reject { .. } => None,
        }
    }
}

impl BondKind {
    /// Returns the keyword of the kind.
    pub const fn name(self) -> &'static str {
        match self {
            BondKind::Attract => "attract",
            BondKind::Reject => "reject",
            BondKind::Suction => "suction",
        }
    }
}

/// Permanent magnets of a face: four pairs of dipoles slightly below the surface. With this
/// pattern, any two faces attract each other in all four quarter turns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Magnets {
    /// Force between two touching faces \[N\]. A larger load separates the faces.
    pub hold: f64,
    /// Distance between opposite dipoles of two touching faces \[m\].
    pub depth: f64,
    /// Largest distance between face centres with attraction \[m\].
    pub within: f64,
}

/// Pump with its flow resistances, which do not depend on the flow. `None` for a default of
/// [`Suction`](super::Suction).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pump {
    /// Largest pressure of the pump \[Pa\].
    pub head: f64,
    /// Diameter of the opening in a face \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opening: Option<f64>,
    /// Resistance of pump and plate \[Pa s/m^3\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supply: Option<f64>,
    /// Resistance of an open face \[Pa s/m^3\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub valve: Option<f64>,
    /// Resistance of the joint between the chambers of a block and its parent, or the plate \[Pa
    /// s/m^3\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub passage: Option<f64>,
}

/// Largest loads of a bond of the structure. At least one field is given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BondStrength {
    /// Largest force \[N\]. `None` if no force breaks the bond.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// Largest torque \[N m\]. `None` if no torque breaks the bond.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque: Option<f64>,
}

/// Force of constant magnitude within a distance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reach {
    /// Magnitude of the force \[N\].
    pub force: f64,
    /// Range of the force: largest distance between the centres of the two faces \[m\].
    pub within: f64,
}

/// Condition of a capture: limits of distance and tilt.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Anchor {
    /// Kind of distance that [`within`](Anchor::within) limits.
    pub measure: Measure,
    /// Largest distance of a capture \[m\].
    pub within: f64,
    /// Largest angle between the normal of one face and the reversed normal of the other \[rad\].
    pub tilt: f64,
    /// Whether bonding is tested only at the end of each tick, instead of along the path of every
    /// step.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sampled: bool,
}

/// Kind of distance for the condition of a capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Between the centres of the two faces.
    Centres,
    /// Along the normal of the magnetized face, with a lateral offset below half a block length.
    Gap,
    /// Between the corners of the two faces: the largest of four distances.
    Corners,
}
