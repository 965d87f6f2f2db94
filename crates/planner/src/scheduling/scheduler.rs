//! Runs a scheduling job: opens faces in the order of their priorities.
use super::job::SchedulingJob;
use super::phase::SchedulePhase;
use super::priorities::Priorities;
use super::state::{ScheduleState, SiteState};
use crate::scaffold::{SitePart, SiteRoles};
use crate::timing::schedule::Schedule;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use stochc_grammar::{Cancellation, Cancelled};

impl SchedulingJob<'_> {
    /// Returns a schedule that opens urgent cells early.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] if scheduling is cancelled.
    pub fn schedule(
        &self,
        priorities: &Priorities,
        cancellation: Cancellation<'_>,
    ) -> Result<Schedule, Cancelled> {
        let schedule = self.within(priorities, f32::INFINITY, cancellation)?;
        Ok(schedule.expect("a complete order is known"))
    }

    /// Returns a schedule. Returns `None` if there is none, which can happen with scaffolds.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] if scheduling is cancelled.
    pub fn any(
        &self,
        priorities: &Priorities,
        cancellation: Cancellation<'_>,
    ) -> Result<Option<Schedule>, Cancelled> {
        match self.roles {
            Some(roles) => self.scaffolded(roles, priorities, cancellation),
            None => self.schedule(priorities, cancellation).map(Some),
        }
    }

    /// Returns a schedule with scaffolds, or `None` if access paths allow none.
    ///
    /// A site that the hand-over does not need may open before the hand-over. Half of its waiting
    /// time must then be over when the hand-over begins.
    fn scaffolded(
        &self,
        roles: &SiteRoles,
        priorities: &Priorities,
        cancellation: Cancellation<'_>,
    ) -> Result<Option<Schedule>, Cancelled> {
        let Some(first) = self.within(priorities, f32::INFINITY, cancellation)? else {
            return Ok(None);
        };
        let needed = (0..self.sites.len() as u32).filter(|&site| roles.part(site) != SitePart::Own);
        let ends = needed.map(|site| first.end[site as usize]);
        let last = ends.fold(0.0, f32::max);
        Ok(self.within(priorities, last, cancellation)?.or(Some(first)))
    }

    /// Returns a schedule. The hand-over does not need every site. Such a site opens in the first
    /// phase only if half of its waiting time is over by `limit`.
    fn within(
        &self,
        priorities: &Priorities,
        limit: f32,
        cancellation: Cancellation<'_>,
    ) -> Result<Option<Schedule>, Cancelled> {
        let count = self.sites.len();
        let mut state = self.begin(priorities);
        state.phase = self.roles.map(|roles| SchedulePhase::first(roles, limit));
        for site in 0..count as u32 {
            state.consider(site);
        }
        state.open_ready(0.0);
        while let Some(Reverse((time, site))) = state.opened.pop() {
            cancellation.check()?;
            state.anchored(site);
            state.open_ready(f32::from_bits(time));
            if state.opened.is_empty() && state.may_hand_over() {
                state.begin_second_phase();
                state.open_ready(f32::from_bits(time));
            }
        }
        Ok((state.schedule.order.len() == count).then_some(state.schedule))
    }

    /// Returns the initial state, with existing blocks only.
    fn begin<'b>(&'b self, priorities: &'b Priorities) -> ScheduleState<'b> {
        let count = self.sites.len();
        let mut state = vec![SiteState::Absent; count];
        let mut schedule = Schedule::empty(count);
        for (site, direction) in self.sites.existing() {
            state[site as usize] = SiteState::Anchored;
            schedule.direction[site as usize] = direction;
            schedule.rank[site as usize] = schedule.order.len() as u32;
            schedule.order.push(site);
        }
        ScheduleState {
            job: self,
            priorities,
            missing: self.missing(),
            anchored: schedule.order.len() as u32,
            state,
            open_faces: vec![0; count],
            ready: BinaryHeap::new(),
            is_ready: vec![false; count],
            opened: BinaryHeap::new(),
            schedule,
            phase: None,
        }
    }
}
