//! Counter-based random numbers without state: a draw is a pure function of (seed, run, stream,
//! block, step).
//!
//! The key of ChaCha8 is (seed, run, stream) and its nonce is the step. The words of a block start
//! at `block * WORDS`, so one keystream serves all blocks of a tick in order. Any draw can be
//! repeated on any thread, whatever was drawn before.
mod ahead;
mod draws;

pub use ahead::DrawsAhead;
pub(crate) use draws::gaussians;
pub use draws::{Draws, StepDraws, Stream, WORDS, below, direction, schedules, unit};
