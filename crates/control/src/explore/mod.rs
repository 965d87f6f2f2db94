//! Exploration of event tables in every order of events.
//!
//! [`explore`] runs the same state machine as a world ([`Structure`](crate::Structure)), but in
//! every order instead of by clock and chance. Any open face whose cell is empty may capture next.
//! Any message may make its next hop, however long others have been in transit. Each hop is a
//! transition, because the structure can change while a message is halfway. Contacts keep no order:
//! two messages between the same blocks may overtake each other. As in a run, the beginning of a
//! phase is one transition.
//!
//! This includes every order of a world, for any hop time, so properties proved here hold in all
//! worlds. Time is not explored: a phase that never ends here times out in a world.
//!
//! States are hashed by meaning: blocks by role, observations as sorted sets, messages in transit
//! as a multiset. `persistent` omits equivalent orders and proves that this is sound.
mod breadth_first;
mod checker;
mod context;
mod depth_first;
mod describe;
mod effects;
mod environment;
mod expected;
mod exploration;
mod faults;
mod fingerprint;
mod future;
mod persistent;
mod progress;
mod random_walk;
mod report;
mod roles;
mod runs;
mod state;
mod transition;

pub use expected::{ExpectedEvent, ProgramGoals};
pub use exploration::{CanReach, Exploration, ExplorationBounds};
pub use faults::Faults;
pub use random_walk::{Choose, DrawIndex};
pub use report::{ExceededBound, ExplorationReport, ExplorationVerdict, Property, Violation};
pub use runs::explore;
