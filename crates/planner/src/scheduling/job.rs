//! Schedules a target for given priorities.

use stochc_ir::Face;

use crate::disassembly::Disassembly;
use crate::scaffold::{SitePart, SiteRoles};
use crate::space::corridor::Corridors;
use crate::space::crowding::Crowding;
use crate::space::sites::{NONE, Sites};
use crate::target::hardware::Hardware;
use crate::timing::makespan::{PlanEstimate, Samples};
use crate::timing::precedence::Waiting;
use crate::timing::rate_law::RateLaw;
use crate::timing::schedule::Schedule;

/// Assumed waiting time of a site that is not scheduled yet \[ticks\].
pub const WAIT: f32 = 650.0;

/// Constant data of all schedules.
pub struct SchedulingJob<'a> {
    pub sites: &'a Sites<'a>,
    pub corridors: &'a Corridors,
    pub hardware: Hardware,
    pub waits: &'a RateLaw<'a>,
    /// Parts that sites belong to. `None` without scaffolds.
    pub roles: Option<&'a SiteRoles>,
    /// For each site, the mean time from its opening to the end of the longest chain of sites that
    /// depend on it \[ticks\].
    pub(super) tail: Vec<f32>,
}

impl<'a> SchedulingJob<'a> {
    /// Creates the scheduling job of a target.
    pub fn new(
        sites: &'a Sites<'a>,
        disassembly: &'a Disassembly,
        corridors: &'a Corridors,
        hardware: Hardware,
        waits: &'a RateLaw<'a>,
    ) -> SchedulingJob<'a> {
        let mut tail = vec![WAIT; sites.len()];
        for &site in disassembly.order.iter().rev() {
            let here = tail[site as usize];
            for &other in &corridors.waiting[site as usize] {
                tail[site as usize] = tail[site as usize].max(WAIT + tail[other as usize]);
            }
            // Provisionally, its parent is the neighbour that was built first.
            let held = sites
                .adjacent(site)
                .filter(|&next| !sites.is_inert(next))
                .min_by_key(|&next| disassembly.rank[next as usize]);
            let longest = here.max(tail[site as usize]);
            if let Some(parent) = held
                && !sites.is_on_seed(site)
                && disassembly.rank[parent as usize] < disassembly.rank[site as usize]
            {
                let parent = &mut tail[parent as usize];
                *parent = parent.max(WAIT + longest);
            }
        }
        SchedulingJob {
            sites,
            corridors,
            hardware,
            waits,
            roles: None,
            tail,
        }
    }

    /// Adds scaffolds to the job. Sites on the longest path through a mast and its segments become
    /// the most urgent.
    pub(crate) fn with_roles(mut self, roles: &'a SiteRoles) -> SchedulingJob<'a> {
        for segment in roles.segments() {
            // From the end of the segment to the mast, and down to the plate.
            let mut rest = 0.0;
            let mut site = segment.sites[0].0;
            while site != NONE {
                rest += WAIT;
                let tail = &mut self.tail[site as usize];
                *tail = match roles.part(site) {
                    SitePart::Mast(_) => tail.max(rest),
                    SitePart::Own | SitePart::Held(_) => rest,
                };
                site = roles.direction(site).map_or(NONE, |direction| {
                    self.sites.next(site, direction.opposite())
                });
            }
        }
        self.roles = Some(roles);
        self
    }

    pub fn crowding(&self) -> Crowding<'_> {
        Crowding {
            sites: self.sites,
            attracts_always: self.hardware.attracts_always,
            has_passable_corners: self.waits.has_passable_corners(),
        }
    }

    /// Returns all dependencies of a schedule.
    pub fn waiting(&self, schedule: &Schedule) -> Waiting {
        let mut before: Vec<Vec<u32>> = vec![Vec::new(); schedule.order.len()];
        let existing = self.sites.existing_count();
        for (i, &site) in schedule.order.iter().enumerate().skip(existing) {
            let rank = |site: u32| schedule.rank[site as usize];
            before[i].extend(schedule.held(self.sites, site));
            before[i].extend(schedule.turn(self.sites, self.hardware, site));
            let crowding = self.crowding();
            let direction = schedule.direction[site as usize];
            let crowd = crowding.waits(site, direction, |near| schedule.before(near, i as u32));
            before[i].extend(crowd.into_iter().map(rank));
            for &waiting in &self.corridors.waiting[site as usize] {
                before[rank(waiting) as usize].push(i as u32);
            }
        }
        let first = schedule.first_phase as u32;
        for (before, i) in before.iter_mut().zip(0..) {
            // A phase waits for the whole previous phase.
            before.retain(|&other| (other < first) == (i < first) && other >= existing as u32);
            before.sort_unstable();
            before.dedup();
        }
        Waiting { before }
    }

    /// Estimates the completion time of a schedule's program with the mean waiting times of `check
    /// --cost`.
    ///
    /// The search uses other waiting times, which depend on the order of faces that open at the
    /// same time.
    pub fn estimated(
        &self,
        samples: &Samples,
        schedule: &Schedule,
        waiting: &Waiting,
    ) -> PlanEstimate {
        let mut settled = schedule.clone();
        settled.set_means(self.sites, self.hardware, self.waits, waiting);
        samples.estimate(&settled, waiting, &mut Vec::new())
    }

    /// Returns the parent of a site in a direction, or [`NONE`] for a seed.
    pub fn parent(&self, site: u32, direction: Face) -> u32 {
        self.sites.next(site, direction.opposite())
    }

    /// Returns whether `site` can be captured in a direction. If the site is in a gap, the direction
    /// must be along its axis. The parent must be a seed, or a site that `holds` accepts.
    pub(super) fn can_capture(
        &self,
        site: u32,
        direction: Face,
        holds: impl FnOnce(u32) -> bool,
    ) -> bool {
        let along = self.corridors.along[site as usize];
        if along.is_some_and(|axis| direction != axis && direction != axis.opposite()) {
            return false;
        }
        match self.parent(site, direction) {
            NONE => direction == Face::Up && self.sites.is_on_seed(site),
            parent => !self.sites.is_inert(parent) && holds(parent),
        }
    }

    /// Returns the price of a direction \[ticks\]. This is the waiting time, reduced by 2 % if the
    /// chain continues straight.
    pub(super) fn price(&self, schedule: &Schedule, site: u32, direction: Face, wait: f32) -> f32 {
        let parent = self.parent(site, direction);
        let is_straight = parent == NONE || schedule.direction[parent as usize] == direction;
        if is_straight { 0.98 * wait } else { wait }
    }

    /// Returns, for each site, the number of other sites that must be captured before it to keep
    /// access paths open.
    pub(super) fn missing(&self) -> Vec<u32> {
        let mut missing = vec![0; self.sites.len()];
        for &site in self.corridors.waiting.iter().flatten() {
            missing[site as usize] += 1;
        }
        missing
    }
}
