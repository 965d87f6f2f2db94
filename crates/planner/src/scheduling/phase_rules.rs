//! Rules of the two phases of a schedule with scaffolds.
use super::state::{ScheduleState, SiteState};
use crate::scaffold::SitePart;

impl ScheduleState<'_> {
    /// Returns whether a site may open in the current phase. In the first phase, a site without
    /// hand-over may open only while temporary blocks are missing. `half` is the time when half of
    /// its waiting time is over. This time must not exceed the limit.
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

    /// Hands over the segments whose final parents are present. Removes masts that do not hold
    /// blocks any more.
    pub(super) fn hand_over(&mut self) {
        let Some(phase) = &mut self.phase else { return };
        let mut new = Vec::new();
        while let Some((number, segment)) =
            phase
                .roles
                .segments()
                .iter()
                .enumerate()
                .find(|(i, segment)| {
                    !phase.is_done[*i]
                        && self.state[segment.join as usize] == SiteState::Anchored
                        && phase.is_own(segment.join)
                })
        {
            phase.is_done[number] = true;
            new.extend(segment.sites.iter().map(|&(site, _)| site));
        }
        for site in 0..self.state.len() as u32 {
            if phase.is_spent(site) {
                self.state[site as usize] = SiteState::Released;
            }
        }
        for site in new {
            for next in self.job.sites.adjacent(site) {
                self.consider(next);
            }
        }
    }
}
