//! Distributed control: every anchored block executes its own part of the event tables.
//!
//! A block sees only its own faces and its messages. Messages travel hop by hop along parents and
//! children. This module does not depend on how blocks move and runs in any
//! [`World`](crate::world::World).
//!
//! [`Structure`](stochc_control::Structure) is the state machine, without time and chance. The [`Controller`] drives it by the
//! clock of a world. [`stochc_control::explore`] drives the same machine through every order of
//! events.
//!
//! Times are boundaries between steps: tick t is the moment after t steps. A phase whose last
//! report arrives at tick t ends at t. Faces that the next phase switches on act from the next
//! step. All blocks learn at once that a phase begins; this broadcast is not counted as messages.
mod controller;
mod hardware;
mod network;
mod recorder;

pub use controller::Controller;
