//! Data of a phase whose cells may be closed before their captures.
use std::borrow::Cow;

use rustc_hash::FxHashSet;

use super::descendants::DescendantIndex;
use super::reachable::Dismantled;
use crate::dependencies::graph::DependencyGraph;
use crate::expanded::EventId;

/// A phase with captures whose cells can be closed.
pub struct ClosablePhase<'a> {
    /// Events of the phase in topological order.
    pub events: &'a [EventId],
    pub descendants: &'a DescendantIndex,
    /// Captures that cannot happen in any order.
    pub never: FxHashSet<EventId>,
    /// Dependencies without the edges that choices do not need. The choices prefer events that can
    /// happen.
    pub straight: Cow<'a, DependencyGraph>,
    /// Order for removing all blocks that can be built. `None` if the phase has releases or the
    /// search was stopped.
    pub apart: Option<Dismantled>,
}

impl ClosablePhase<'_> {
    /// Returns whether a single order contains all captures except [`never`](Self::never).
    pub fn is_whole(&self) -> bool {
        self.apart.as_ref().is_some_and(|apart| apart.is_whole)
    }
}
