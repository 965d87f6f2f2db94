//! List scheduling on mean waiting times: selects the cell that opens next.
//!
//! The most urgent eligible cell opens. Its predecessors must be present, a neighbour must have a
//! face available, and no open face may [jam with it](crate::space::crowding).
mod phase;
mod priorities;

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use stochc_grammar::{Cancellation, Cancelled};
use stochc_ir::{Cell, Face};

use crate::disassembly::Disassembly;
use crate::scaffold::{SitePart, SiteRoles};
use crate::space::corridor::Corridors;
use crate::space::crowding::Crowding;
use crate::space::sites::{NONE, Sites};
use crate::target::hardware::Hardware;
use crate::timing::makespan::{PlanEstimate, Samples};
use crate::timing::precedence::Waiting;
use crate::timing::rate_law::{CellState, Moment, RateLaw};
use crate::timing::schedule::Schedule;
use phase::SchedulePhase;
pub use priorities::Priorities;

/// Assumed waiting time before anything is known \[ticks\].
pub const WAIT: f32 = 650.0;

/// Constant data of all schedules.
pub struct SchedulingJob<'a> {
    /// Cells.
    pub sites: &'a Sites<'a>,
    /// Dependencies for access paths.
    pub corridors: &'a Corridors,
    /// Capabilities of blocks.
    pub hardware: Hardware,
    /// Waiting times of faces.
    pub waits: &'a RateLaw<'a>,
    /// Roles of sites, if there are scaffolds.
    pub roles: Option<&'a SiteRoles>,
    /// Mean time from the opening of each site to the end, along its longest chain of successors
    /// \[ticks\].
    tail: Vec<f32>,
}

impl<'a> SchedulingJob<'a> {
    /// Prepares the scheduling of a target.
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

    /// Adds scaffolds: the longest path through a mast and its pieces is the most urgent.
    pub fn with_roles(mut self, roles: &'a SiteRoles) -> SchedulingJob<'a> {
        for piece in roles.pieces() {
            // From the end of the piece to the mast, and down to the plate.
            let mut rest = 0.0;
            let mut site = piece.sites[0].0;
            while site != NONE {
                rest += WAIT;
                let tail = &mut self.tail[site as usize];
                *tail = match roles.part(site) {
                    SitePart::Mast(_) => tail.max(rest),
                    SitePart::Own | SitePart::Held(_) => rest,
                };
                site = roles
                    .way(site)
                    .map_or(NONE, |way| self.sites.next(site, way.opposite()));
            }
        }
        self.roles = Some(roles);
        self
    }

    /// Returns the rules for faces that must not be open together.
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
            let way = schedule.way[site as usize];
            let crowd = crowding.waits(site, way, |near| schedule.before(near, i as u32));
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

    /// Estimates the completion time of a schedule's program. It uses the mean waiting times of
    /// `check --cost`. The search's waiting times depend on the order of faces that open at the
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
    pub fn parent(&self, site: u32, way: Face) -> u32 {
        self.sites.next(site, way.opposite())
    }

    /// Returns whether a block may come to a site in a direction: along its corridor, from the
    /// plate or a site that `holds`.
    fn is_way(&self, site: u32, way: Face, holds: impl FnOnce(u32) -> bool) -> bool {
        let along = self.corridors.along[site as usize];
        if along.is_some_and(|axis| way != axis && way != axis.opposite()) {
            return false;
        }
        match self.parent(site, way) {
            NONE => way == Face::Up && self.sites.is_on_seed(site),
            parent => !self.sites.is_inert(parent) && holds(parent),
        }
    }

    /// Returns the price for comparing directions \[ticks\]: the waiting time, slightly less for
    /// straight continuation.
    fn price(&self, schedule: &Schedule, site: u32, way: Face, wait: f32) -> f32 {
        let parent = self.parent(site, way);
        let is_straight = parent == NONE || schedule.way[parent as usize] == way;
        if is_straight { 0.98 * wait } else { wait }
    }

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

    /// Returns a schedule if there is one. With scaffolds there may be none.
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
    /// Sites not needed for the hand-over open before it only if half of their waiting time is over
    /// by then.
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

    /// Returns a schedule that omits unneeded openings whose waiting time would be half over after
    /// `limit`.
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

    /// Returns for each site the number of others that it waits for, to keep access paths open.
    fn missing(&self) -> Vec<u32> {
        let mut missing = vec![0; self.sites.len()];
        for &site in self.corridors.waiting.iter().flatten() {
            missing[site as usize] += 1;
        }
        missing
    }

    /// Returns the initial state, with existing blocks only.
    fn begin<'b>(&'b self, priorities: &'b Priorities) -> ScheduleState<'b> {
        let count = self.sites.len();
        let mut state = vec![SiteState::Absent; count];
        let mut schedule = Schedule::empty(count);
        for (site, way) in self.sites.existing() {
            state[site as usize] = SiteState::Anchored;
            schedule.way[site as usize] = way;
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

#[derive(Clone, Copy, PartialEq, Eq)]
enum SiteState {
    Absent,
    Open,
    Anchored,
    /// Removed after it was present.
    Gone,
}

#[derive(Clone)]
struct ScheduleState<'a> {
    job: &'a SchedulingJob<'a>,
    priorities: &'a Priorities,
    /// For each site, the number of predecessors still missing.
    missing: Vec<u32>,
    state: Vec<SiteState>,
    /// Number of open faces of each site.
    open_faces: Vec<u8>,
    /// Eligible sites by urgency.
    ready: BinaryHeap<(u32, Reverse<u32>)>,
    is_ready: Vec<bool>,
    /// Open sites by capture time.
    opened: BinaryHeap<Reverse<(u32, u32)>>,
    schedule: Schedule,
    /// Number of anchored sites.
    anchored: u32,
    /// Phase of the schedule. `None` without scaffolds.
    phase: Option<SchedulePhase<'a>>,
}

impl ScheduleState<'_> {
    /// Queues a site if it may open.
    fn consider(&mut self, site: u32) {
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

    fn open_ready(&mut self, now: f32) {
        while let Some((_, Reverse(site))) = self.ready.pop() {
            // Sites that cannot open now are reconsidered when something nearby is anchored.
            self.is_ready[site as usize] = false;
            if let Some((way, mean)) = self.best_way(site, now)
                && self.is_its_phase(site, now + 0.5 * mean)
            {
                self.open(site, way, mean, now);
            }
        }
    }

    /// Returns the direction of a site's open face.
    fn open_way(&self, site: u32) -> Option<Face> {
        let here = site as usize;
        (self.state[here] == SiteState::Open).then(|| self.schedule.way[here])
    }

    /// Returns the direction with the lowest price from a parent with an available face, unless
    /// priorities select another.
    fn best_way(&self, site: u32, now: f32) -> Option<(Face, f32)> {
        let ways = self.ways(site, now).map(|(way, mean)| {
            let price = self.job.price(&self.schedule, site, way, mean);
            ((way, mean), price)
        });
        self.priorities.chosen(site, ways)
    }

    /// Returns the directions from parents with an available face, each with its mean waiting time
    /// \[ticks\].
    fn ways(&self, site: u32, now: f32) -> impl Iterator<Item = (Face, f32)> {
        let job = self.job;
        let cell = job.sites.cell(site);
        let stands = |near: Cell| match job.sites.at(near) {
            NONE => CellState::Empty,
            near => match self.state[near as usize] {
                SiteState::Absent | SiteState::Gone => CellState::Empty,
                SiteState::Open => CellState::Awaited(self.schedule.way[near as usize]),
                SiteState::Anchored => CellState::Full,
            },
        };
        let bound = f64::from(self.anchored) / f64::from(job.hardware.free.max(1));
        let moment = Moment {
            free: 1.0 - bound,
            is_first: now == 0.0 && job.sites.target.is_at_rest(),
        };
        let only = job.roles.and_then(|roles| roles.way(site));
        let is_own = move |parent: u32| match &self.phase {
            Some(phase) => only.is_some() || phase.is_own(parent),
            None => true,
        };
        let holds = move |parent: u32| {
            self.state[parent as usize] == SiteState::Anchored
                && is_own(parent)
                && self.open_faces[parent as usize] < job.hardware.faces
        };
        let is_way =
            move |way: &Face| only.is_none_or(|only| only == *way) && job.is_way(site, *way, holds);
        let crowding = job.crowding();
        let may_open = move |way: &Face| crowding.may_open(site, *way, |near| self.open_way(near));
        let ways = Face::ALL.into_iter().filter(is_way).filter(may_open);
        ways.map(move |way| (way, job.waits.mean(cell, way, moment, stands) as f32))
    }

    fn open(&mut self, site: u32, way: Face, mean: f32, now: f32) {
        let here = site as usize;
        self.state[here] = SiteState::Open;
        let parent = self.job.parent(site, way);
        if parent != NONE {
            self.open_faces[parent as usize] += 1;
        }
        self.schedule.add(site, way, now, mean);
        self.opened.push(Reverse(((now + mean).to_bits(), site)));
    }

    fn anchored(&mut self, site: u32) {
        self.state[site as usize] = SiteState::Anchored;
        self.anchored += 1;
        let job = self.job;
        if let Some(phase) = &mut self.phase {
            phase.missing -= usize::from(phase.roles.part(site) != SitePart::Own);
            if phase.is_second {
                self.hand_over();
            }
        }
        let parent = job.parent(site, self.schedule.way[site as usize]);
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
