//! Event tables: the lowered program, as stored in every block.
//!
//! [`Tables`] are the only data from the compiler to the runtime. A *role* is a name of the
//! program. A block takes a role when it is captured and drops it when it is released. Another
//! block may take it later. A role has up to two [`Duty`]s per phase: one for a block that is
//! anchored at its start, one for a block captured during it. A duty is a list of [`Rule`]s. A rule
//! fires once, as soon as its duty has begun and all its conditions hold. It uses only what its
//! block can see: its own faces, and messages. The runtime needs no other program.
mod hardware;
mod in_scene;
mod invalid;
pub(crate) mod plate;
mod rule;
mod stored;
mod tables;

pub use crate::table::invalid::InvalidTables;
pub use crate::table::plate::Plate;
pub use rule::{Action, Condition, Notification, PhaseId, RoleId, Rule, Trigger};
pub use tables::{Duty, LooseDuty, PRE_ATTACHED, Phase, Recovery, Role, RuleRange, Tables};
