//! The two phases of a schedule with scaffolds.
use crate::scaffold::{SitePart, SiteRoles};

/// Progress of a schedule with scaffolds.
#[derive(Clone)]
pub struct SchedulePhase<'a> {
    pub roles: &'a SiteRoles,
    /// Time limit for sites that the hand-over does not need \[ticks\]. Such a site may open if
    /// half of its waiting time is over by then.
    pub(super) limit: f32,
    /// Number of temporary sites not yet present.
    pub missing: usize,
    /// Whether blocks may be handed over.
    pub is_second: bool,
    /// For each segment, whether it has been handed over.
    pub(super) is_done: Vec<bool>,
}

impl<'a> SchedulePhase<'a> {
    /// Returns the start of the first phase.
    pub fn first(roles: &'a SiteRoles, limit: f32) -> SchedulePhase<'a> {
        SchedulePhase {
            roles,
            limit,
            missing: roles.temporary(),
            is_second: false,
            is_done: vec![false; roles.segments().len()],
        }
    }

    /// Returns whether a captured site is attached to its final parent. Other sites can then be
    /// attached to it permanently.
    pub fn is_own(&self, site: u32) -> bool {
        match self.roles.part(site) {
            SitePart::Own => true,
            SitePart::Held(segment) => self.is_done[segment as usize],
            SitePart::Mast(_) => false,
        }
    }

    /// Returns whether a site belongs to a mast that does not hold blocks any more.
    pub(super) fn is_spent(&self, site: u32) -> bool {
        let SitePart::Mast(number) = self.roles.part(site) else {
            return false;
        };
        let mut segments = self.roles.segments().iter().zip(&self.is_done);
        segments.all(|(segment, is_done)| segment.mast != number || *is_done)
    }
}
