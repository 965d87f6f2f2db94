//! The two phases of a schedule with scaffolds.
use super::{ScheduleState, SiteState};
use crate::scaffold::{SitePart, SiteRoles};

/// Progress of a schedule with scaffolds.
#[derive(Clone)]
pub struct SchedulePhase<'a> {
    pub roles: &'a SiteRoles,
    /// Deadline for sites that are not needed \[ticks\].
    limit: f32,
    /// Number of temporary sites not yet present.
    pub missing: usize,
    /// Whether blocks may be handed over.
    pub is_second: bool,
    /// Whether each piece has been handed over.
    is_done: Vec<bool>,
}

impl<'a> SchedulePhase<'a> {
    /// Returns the start of the first phase.
    pub fn first(roles: &'a SiteRoles, limit: f32) -> SchedulePhase<'a> {
        SchedulePhase {
            roles,
            limit,
            missing: roles.temporary(),
            is_second: false,
            is_done: vec![false; roles.pieces().len()],
        }
    }

    /// Returns whether a standing site holds others in their final attachment.
    pub fn is_own(&self, site: u32) -> bool {
        match self.roles.part(site) {
            SitePart::Own => true,
            SitePart::Held(piece) => self.is_done[piece as usize],
            SitePart::Mast(_) => false,
        }
    }

    /// Returns whether a site belongs to a mast that no longer holds anything.
    fn is_spent(&self, site: u32) -> bool {
        let SitePart::Mast(number) = self.roles.part(site) else {
            return false;
        };
        let mut pieces = self.roles.pieces().iter().zip(&self.is_done);
        pieces.all(|(piece, is_done)| piece.mast != number || *is_done)
    }
}

impl ScheduleState<'_> {
    /// Returns whether a site may open when half of its waiting time is over at `half`. Nothing new
    /// opens between completion of the temporary blocks and their hand-over.
    pub(super) fn is_its_phase(&self, site: u32, half: f32) -> bool {
        match &self.phase {
            Some(phase) if !phase.is_second && phase.roles.part(site) == SitePart::Own => {
                phase.missing > 0 && half <= phase.limit
            }
            _ => true,
        }
    }

    /// Returns whether all temporary blocks are present.
    pub(super) fn may_hand_over(&self) -> bool {
        let phase = self.phase.as_ref();
        phase.is_some_and(|phase| !phase.is_second && phase.missing == 0)
    }

    /// Begins the hand-over.
    pub(super) fn begin_second_phase(&mut self) {
        let Some(phase) = &mut self.phase else { return };
        phase.is_second = true;
        self.schedule.first_phase = self.schedule.order.len();
        self.schedule.roots = phase.roles.roots();
        self.hand_over();
        for site in 0..self.state.len() as u32 {
            self.consider(site);
        }
    }

    /// Hands over the pieces whose final parents are present, and removes masts that no longer hold
    /// anything.
    pub(super) fn hand_over(&mut self) {
        let Some(phase) = &mut self.phase else { return };
        let mut new = Vec::new();
        while let Some((number, piece)) =
            phase.roles.pieces().iter().enumerate().find(|(i, piece)| {
                !phase.is_done[*i]
                    && self.state[piece.join as usize] == SiteState::Anchored
                    && phase.is_own(piece.join)
            })
        {
            phase.is_done[number] = true;
            new.extend(piece.sites.iter().map(|&(site, _)| site));
        }
        for site in 0..self.state.len() as u32 {
            if phase.is_spent(site) {
                self.state[site as usize] = SiteState::Gone;
            }
        }
        for site in new {
            for next in self.job.sites.adjacent(site) {
                self.consider(next);
            }
        }
    }
}
