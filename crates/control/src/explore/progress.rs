//! Events so far in a phase.
use std::collections::BTreeSet;

use stochc_ir::table::{Notification, RoleId};

use crate::Reporter;

/// Events so far in a phase.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct PhaseProgress {
    pub captures: BTreeSet<RoleId>,
    pub releases: BTreeSet<RoleId>,
    /// Sorted reports. Duplicates are included.
    pub reports: Vec<Reporter>,
}

impl PhaseProgress {
    pub fn has(&self, event: Notification) -> bool {
        match event {
            Notification::Anchored(role) => self.captures.contains(&role),
            Notification::Released(role) => self.releases.contains(&role),
        }
    }
}
