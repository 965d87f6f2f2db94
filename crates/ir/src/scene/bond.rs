//! How free blocks are captured and held.
use serde::{Deserialize, Serialize};

/// How a structure captures a free block.
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
    /// Every face always attracts; a face is switched on to reject what it holds.
    Reject {
        /// The passive magnets in every face of every block.
        magnets: Magnets,
        /// When two blocks are bonded.
        anchor: Anchor,
        /// What a rejected block gets along the normal of the face \[N s\].
        impulse: f64,
    },
    /// A valve is opened to capture: the face draws fluid, and with it blocks.
    Suction {
        /// What drives the fluid, and what hinders it.
        pump: Pump,
        /// Between the centres of two faces: closer, a block feels the pressure drop of the face \[m\].
        seal: f64,
        /// When the block is anchored.
        anchor: Anchor,
    },
}

/// The kinds of [`Bond`].
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
    /// Its kind.
    pub const fn kind(&self) -> BondKind {
        match self {
            Bond::Attract { .. } => BondKind::Attract,
            Bond::Reject { .. } => BondKind::Reject,
            Bond::Suction { .. } => BondKind::Suction,
        }
    }

    /// The same, to be changed.
    pub(super) const fn anchor_mut(&mut self) -> &mut Anchor {
        match self {
            Bond::Attract { anchor, .. }
            | Bond::Reject { anchor, .. }
            | Bond::Suction { anchor, .. } => anchor,
        }
    }

    /// When a block is anchored.
    pub const fn anchor(&self) -> &Anchor {
        match self {
            Bond::Attract { anchor, .. }
            | Bond::Reject { anchor, .. }
            | Bond::Suction { anchor, .. } => anchor,
        }
    }
}

impl BondKind {
    /// Its word in a scene.
    pub const fn name(self) -> &'static str {
        match self {
            BondKind::Attract => "attract",
            BondKind::Reject => "reject",
            BondKind::Suction => "suction",
        }
    }
}

/// The passive magnets of a face, of a pattern that attracts every other face in each of the four
/// quarter turns: four pairs of dipoles, somewhat behind the faces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Magnets {
    /// Attraction of two faces that touch \[N\]; more tears them apart.
    pub hold: f64,
    /// Distance of two opposite dipoles when their faces touch \[m\].
    pub depth: f64,
    /// Between the centres of two faces: farther, they do not attract \[m\].
    pub within: f64,
}

/// A pump and the resistances on the way from a face to it; all flows are laminar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pump {
    /// Pressure drop that it can make \[Pa\].
    pub head: f64,
    /// Of the pump and the plate \[Pa s/m^3\].
    pub supply: f64,
    /// Of an open face \[Pa s/m^3\].
    pub valve: f64,
    /// From a block's chamber through a joint to that of its parent, or of the plate \[Pa s/m^3\].
    pub passage: f64,
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
    /// Tested at the end of each tick only, and not along the way of every step.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sampled: bool,
}

/// What the anchoring distance is measured between.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// The centres of the two faces.
    Centres,
    /// Along the normal of the magnetized face only, with the lateral offset under half a side.
    Gap,
    /// The corners of the two faces: the largest of four distances.
    Corners,
}
