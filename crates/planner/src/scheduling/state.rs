//! State of a schedule in progress.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use stochc_ir::{Cell, Face};

use super::job::SchedulingJob;
use super::phase::SchedulePhase;
use super::priorities::Priorities;
use crate::scaffold::SitePart;
use crate::space::sites::NONE;
use crate::timing::rate_law::{CellState, Moment};
use crate::timing::schedule::Schedule;

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum SiteState {
    Absent,
    Open,
    Anchored,
    /// The block was captured and removed again.
    Released,
}

#[derive(Clone)]
pub(super) struct ScheduleState<'a> {
    pub(super) job: &'a SchedulingJob<'a>,
    pub(super) priorities: &'a Priorities,
    /// For each site, the number of sites that must be captured before it and are still missing.
    pub(super) missing: Vec<u32>,
    pub(super) state: Vec<SiteState>,
    /// Number of open faces of each site.
    pub(super) open_faces: Vec<u8>,
    /// Eligible sites by urgency.
    pub(super) ready: BinaryHeap<(u32, Reverse<u32>)>,
    pub(super) is_ready: Vec<bool>,
    /// Open sites as a queue, the earliest capture time first.
    pub(super) opened: BinaryHeap<Reverse<(u32, u32)>>,
    pub(super) schedule: Schedule,
    pub(super) anchored: u32,
    /// Phase of the schedule. `None` without scaffolds.
    pub(super) phase: Option<SchedulePhase<'a>>,
}

impl ScheduleState<'_> {
    /// Queues a site if it may open.
    pub(super) fn consider(&mut self, site: u32) {
        let here = site as usize;
        let is_next = self.state[here] == SiteState::Absent && self.missing[here] == 0;
        if !is_next || self.is_ready[here] {
            return;
        }
        let sites = self.job.sites;
        let is_held = sites.is_on_seed(site)
            || sites.adjacent(site).any(|next| {
                self.state[next as usize] == SiteState::Anchored && !sites.is_inert(next)
            });
        if is_held {
            self.is_ready[here] = true;
            let urgency = self.priorities.urgency(site, self.job.tail[here]);
            self.ready.push((urgency.to_bits(), Reverse(site)));
        }
    }

    pub(super) fn open_ready(&mut self, now: f32) {
        while let Some((_, Reverse(site))) = self.ready.pop() {
            // Sites that cannot open now are reconsidered when something nearby is anchored.
            self.is_ready[site as usize] = false;
            if let Some((direction, mean)) = self.best_direction(site, now)
                && self.is_its_phase(site, now + 0.5 * mean)
            {
                self.open(site, direction, mean, now);
            }
        }
    }

    /// Returns the direction of a site's open face. Returns `None` if the site is not open.
    fn open_direction(&self, site: u32) -> Option<Face> {
        let here = site as usize;
        (self.state[here] == SiteState::Open).then(|| self.schedule.direction[here])
    }

    /// Returns the direction with the lowest price, and the mean waiting time of a capture in this
    /// direction \[ticks\]. Priorities may select another direction. Returns `None` if no parent
    /// has an available face.
    fn best_direction(&self, site: u32, now: f32) -> Option<(Face, f32)> {
        let directions = self.directions(site, now).map(|(direction, mean)| {
            let price = self.job.price(&self.schedule, site, direction, mean);
            ((direction, mean), price)
        });
        self.priorities.chosen(site, directions)
    }

    /// Returns the directions from parents with an available face, each with its mean waiting time
    /// \[ticks\].
    pub(super) fn directions(&self, site: u32, now: f32) -> impl Iterator<Item = (Face, f32)> {
        let job = self.job;
        let cell = job.sites.cell(site);
        let stands = |near: Cell| match job.sites.at(near) {
            NONE => CellState::Empty,
            near => match self.state[near as usize] {
                SiteState::Absent | SiteState::Released => CellState::Empty,
                SiteState::Open => CellState::Awaited(self.schedule.direction[near as usize]),
                SiteState::Anchored => CellState::Full,
            },
        };
        let bound = f64::from(self.anchored) / f64::from(job.hardware.free.max(1));
        let moment = Moment {
            free: 1.0 - bound,
            is_first: now == 0.0 && job.sites.target.is_at_rest(),
        };
        let only = job.roles.and_then(|roles| roles.direction(site));
        let is_own = move |parent: u32| match &self.phase {
            Some(phase) => only.is_some() || phase.is_own(parent),
            None => true,
        };
        let holds = move |parent: u32| {
            self.state[parent as usize] == SiteState::Anchored
                && is_own(parent)
                && self.open_faces[parent as usize] < job.hardware.faces
        };
        let can_capture = move |direction: &Face| {
            only.is_none_or(|only| only == *direction) && job.can_capture(site, *direction, holds)
        };
        let crowding = job.crowding();
        let may_open = move |direction: &Face| {
            crowding.may_open(site, *direction, |near| self.open_direction(near))
        };
        let directions = Face::ALL.into_iter().filter(can_capture).filter(may_open);
        directions.map(move |direction| {
            (
                direction,
                job.waits.mean(cell, direction, moment, stands) as f32,
            )
        })
    }

    pub(super) fn open(&mut self, site: u32, direction: Face, mean: f32, now: f32) {
        let here = site as usize;
        self.state[here] = SiteState::Open;
        let parent = self.job.parent(site, direction);
        if parent != NONE {
            self.open_faces[parent as usize] += 1;
        }
        self.schedule.add(site, direction, now, mean);
        self.opened.push(Reverse(((now + mean).to_bits(), site)));
    }

    pub(super) fn anchored(&mut self, site: u32) {
        self.state[site as usize] = SiteState::Anchored;
        self.anchored += 1;
        let job = self.job;
        if let Some(phase) = &mut self.phase {
            phase.missing -= usize::from(phase.roles.part(site) != SitePart::Own);
            if phase.is_second {
                self.hand_over();
            }
        }
        let parent = job.parent(site, self.schedule.direction[site as usize]);
        if parent != NONE {
            self.open_faces[parent as usize] -= 1;
            for next in job.sites.adjacent(parent) {
                self.consider(next);
            }
        }
        for &waiting in &job.corridors.waiting[site as usize] {
            self.missing[waiting as usize] -= 1;
            self.consider(waiting);
        }
        for near in job.sites.near(site) {
            self.consider(near);
        }
    }
}
