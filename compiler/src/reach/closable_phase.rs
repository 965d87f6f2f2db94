//! What is known of a phase in which a capture can be closed in.
use std::borrow::Cow;

use rustc_hash::FxHashSet;

use super::EventId;
use super::descendants::DescendantIndex;
use super::reachable::Dismantled;
use crate::graph::DependencyGraph;

/// A phase in which something can be closed in.
pub struct ClosablePhase<'a> {
    /// Its events, each behind all it waits for.
    pub events: &'a [EventId],
    /// Which follow from which.
    pub descendants: &'a DescendantIndex,
    /// What no order reaches.
    pub never: FxHashSet<EventId>,
    /// What waits for what, with every choice made, if it can be by what some order reaches.
    pub straight: Cow<'a, DependencyGraph>,
    /// The rest, taken apart; `None`: there are releases in it, or it was given up.
    pub apart: Option<Dismantled>,
}

impl ClosablePhase<'_> {
    /// Whether one order reaches everything but what no order does.
    pub fn is_whole(&self) -> bool {
        self.apart.as_ref().is_some_and(|apart| apart.is_whole)
    }
}
