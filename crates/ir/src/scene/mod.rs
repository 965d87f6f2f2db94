//! Physical world of a program, in SI units.
//!
//! Each field of [`Scene`] is one term of the model. `None` is a term that does not exist: a
//! runtime must not compute it, not even as zero.
mod bond;
pub mod bond_load;
pub mod describe;
pub mod dimensionless;
mod enclosure;
mod medium;
mod planar_area;
pub mod quantity;
pub mod room;
mod scalar_error;
pub mod scalars;
pub mod schema;
mod substeps;
mod suction;
pub mod units;
mod validation;
mod warning_kind;
pub mod warnings;
mod world;

pub use bond::{Anchor, Bond, BondKind, BondStrength, Magnets, Measure, Pump, Reach};
pub use enclosure::{Enclosure, Extent, Interior};
pub use medium::{Agitation, BOLTZMANN, Drag, Flow, Fluid, Jets, Stir, Strength, Turbulence};
pub use planar_area::{PlanarAccess, PlanarArea};
pub use substeps::{InvalidSubsteps, Substeps, takes_local_steps};
pub use suction::Suction;
pub use validation::InvalidScene;
pub use world::{
    Arrangement, Block, Contact, ContactLaw, Faults, Free, Messages, Mount, Planar, Scene,
};
