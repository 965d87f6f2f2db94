//! Data of a phase whose captures may be closed in.
use std::borrow::Cow;

use rustc_hash::FxHashSet;

use super::descendants::DescendantIndex;
use super::reachable::Dismantled;
use crate::dependencies::graph::DependencyGraph;
use crate::plan::EventId;

/// A phase with captures whose cells can be closed.
pub struct ClosablePhase<'a> {
    /// Events of the phase in topological order.
    pub events: &'a [EventId],
    /// Descendants of each event.
    pub descendants: &'a DescendantIndex,
    /// Captures that no order reaches.
    pub never: FxHashSet<EventId>,
    /// Dependencies with every choice made, by events that some order reaches if possible.
    pub straight: Cow<'a, DependencyGraph>,
    /// Order that allows removing all other blocks again. `None` if the phase has releases or the
    /// search was stopped.
    pub apart: Option<Dismantled>,
}

impl ClosablePhase<'_> {
    /// Returns whether one order reaches everything except the captures that no order reaches.
    pub fn is_whole(&self) -> bool {
        self.apart.as_ref().is_some_and(|apart| apart.is_whole)
    }
}
