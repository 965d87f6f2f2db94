//! What a policy that sees every docking could reach at best, and what a program can at best.
//!
//! Waits are taken to be exponential here, with the means that the law of rates has for what stands and what is open. Nothing is
//! forgotten by closing a face then, so a policy decides by what stands alone: after each docking it opens any faces that the hardware
//! and the rule of corners allow. That is a Markov decision process over the sets of sites. A program decides beforehand, and closes no
//! face before its block has come: [`ExactTimes::best_fixed`] is a policy that at least keeps to that.
use rustc_hash::FxHashMap;
use stochc_ir::{Cell, Face};

use crate::free_space::{FreeSpace, WayIn};
use crate::rate_law::{CellState, Moment};
use crate::scheduling::SchedulingJob;
use crate::sites::{NONE, Sites};

/// Sites of a target whose best policy is looked for, at most.
pub const MOST_ADAPTIVE: usize = 10;

/// What stands, as bits, and what is open, as four bits for each site.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OpenState(u64);

/// Where the bits of what stands begin.
const FULL: u32 = 4 * MOST_ADAPTIVE as u32;

impl OpenState {
    /// Nothing is open.
    pub fn of(full: u32) -> OpenState {
        OpenState(u64::from(full) << FULL)
    }

    fn full(self) -> u32 {
        (self.0 >> FULL) as u32
    }

    fn has(self, site: u32) -> bool {
        self.full() >> site & 1 == 1
    }

    /// The way from the face that is open to a site.
    fn way(self, site: u32) -> Option<Face> {
        let number = (self.0 >> (4 * site) & 15) as usize;
        (number > 0).then(|| Face::ALL[number - 1])
    }

    /// With one more open face.
    pub fn with(self, site: u32, way: Face) -> OpenState {
        OpenState(self.0 | (way as u64 + 1) << (4 * site))
    }

    /// The block of an open face has come; nothing else changes.
    fn filled(self, site: u32) -> OpenState {
        OpenState(self.0 & !(15 << (4 * site)) | 1 << (FULL + site))
    }
}

/// Open sites, with the rates at which their blocks come \[1/tick\].
pub type OpenRates = Vec<(u32, f64)>;

/// Mean times by exponential waits, for a job of no more than [`MOST_ADAPTIVE`] sites, none of which stands before.
pub struct ExactTimes<'a> {
    job: &'a SchedulingJob<'a>,
    /// For each set that stands, how a block comes to each other site by a way two cells wide; `None`: ways may be narrow.
    ways_in: Option<Vec<Vec<Option<WayIn>>>>,
    /// `None`: these faces may not be open together.
    rates: FxHashMap<OpenState, Option<OpenRates>>,
}

impl<'a> ExactTimes<'a> {
    /// `keeps_ways`: whether what stands, with whatever may come first of what is open, must leave wide ways to all open faces.
    pub fn new(job: &'a SchedulingJob<'a>, keeps_ways: bool) -> ExactTimes<'a> {
        ExactTimes {
            job,
            ways_in: keeps_ways.then(|| ways_in(job)),
            rates: FxHashMap::default(),
        }
    }

    /// What the sites are of.
    pub fn job(&self) -> &'a SchedulingJob<'a> {
        self.job
    }

    /// The numbers of the sites.
    pub fn sites(&self) -> std::ops::Range<u32> {
        0..self.job.sites.len() as u32
    }

    /// All sites, as bits.
    pub fn all(&self) -> u32 {
        (1 << self.job.sites.len()) - 1
    }

    /// The ways into a site from what stands.
    pub fn ways(&self, full: u32, site: u32) -> Vec<Face> {
        let holds = |way: &Face| match self.job.parent(site, *way) {
            NONE => *way == Face::Up && self.job.sites.is_on_seed(site),
            parent => full >> parent & 1 == 1,
        };
        Face::ALL.into_iter().filter(holds).collect()
    }

    /// The rates of all open faces; `None`: they may not be open together.
    pub fn rates(&mut self, state: OpenState) -> Option<OpenRates> {
        if let Some(known) = self.rates.get(&state) {
            return known.clone();
        }
        let open: Vec<(u32, Face)> = self
            .sites()
            .filter_map(|site| Some((site, state.way(site)?)))
            .collect();
        let found = self.may_be_open(state, &open).then(|| {
            let rate = |&(site, way): &(u32, Face)| (site, 1.0 / self.mean(state, site, way));
            open.iter().map(rate).collect()
        });
        self.rates.insert(state, found.clone());
        found
    }

    fn may_be_open(&self, state: OpenState, open: &[(u32, Face)]) -> bool {
        let job = self.job;
        let siblings = |parent: u32| {
            open.iter()
                .filter(move |it| job.parent(it.0, it.1) == parent)
        };
        let crowding = job.crowding();
        let others = |site: u32| move |near: u32| state.way(near).filter(|_| near != site);
        let coming = open.iter().fold(state.full(), |bits, it| bits | 1 << it.0);
        open.iter().all(|&(site, way)| {
            let parent = job.parent(site, way);
            let has_face =
                parent == NONE || siblings(parent).count() <= usize::from(job.hardware.faces);
            let is_reached = self.ways_in.as_ref().is_none_or(|ways_in| {
                match ways_in[(coming & !(1 << site)) as usize][site as usize] {
                    Some(WayIn::Inside) => true,
                    Some(WayIn::Gap(axis)) => way == axis || way == axis.opposite(),
                    None => false,
                }
            });
            has_face && is_reached && crowding.may_open(site, way, others(site))
        })
    }

    fn mean(&self, state: OpenState, site: u32, way: Face) -> f64 {
        let SchedulingJob {
            sites,
            hardware,
            waits,
            ..
        } = *self.job;
        let stands = |near: Cell| match sites.at(near) {
            other if other == NONE || other == site => CellState::Empty,
            other if state.has(other) => CellState::Full,
            other => state
                .way(other)
                .map_or(CellState::Empty, CellState::Awaited),
        };
        let bound = f64::from(state.full().count_ones()) / f64::from(hardware.free.max(1));
        let moment = Moment {
            free: 1.0 - bound,
            is_first: state.full() == 0,
        };
        waits.mean(sites.cell(site), way, moment, stands)
    }

    /// The mean time from a state, if no face opens or closes before the next block comes: the `rest` is told which one that is.
    pub fn until_next(
        &mut self,
        state: OpenState,
        mut rest: impl FnMut(&mut Self, u32) -> f64,
    ) -> f64 {
        match self.rates(state) {
            Some(rates) if !rates.is_empty() => {
                let mut sum = 1.0;
                for &(site, rate) in &rates {
                    sum += rate * rest(self, site);
                }
                sum / rates.iter().map(|(_, rate)| rate).sum::<f64>()
            }
            _ => f64::INFINITY,
        }
    }

    /// The mean time of the best policy \[ticks\].
    pub fn best(&mut self) -> f64 {
        let mut known = vec![None; self.all() as usize + 1];
        self.best_from(0, &mut known)
    }

    fn best_from(&mut self, full: u32, known: &mut Vec<Option<f64>>) -> f64 {
        if full == self.all() {
            return 0.0;
        }
        if let Some(known) = known[full as usize] {
            return known;
        }
        let mut least = f64::INFINITY;
        // What is open, and the first site that is not decided.
        let mut choices = vec![(OpenState::of(full), 0)];
        while let Some((state, first)) = choices.pop() {
            let rest = |times: &mut Self, site: u32| times.best_from(full | 1 << site, known);
            least = least.min(self.until_next(state, rest));
            for site in (first..self.sites().end).filter(|site| full >> site & 1 == 0) {
                for way in self.ways(full, site) {
                    let state = state.with(site, way);
                    if self.rates(state).is_some() {
                        choices.push((state, site + 1));
                    }
                }
            }
        }
        known[full as usize] = Some(least);
        least
    }

    /// The mean time of the best policy that has each site captured by a face that is known beforehand, and closes none before its block has
    /// come: no program takes less \[ticks\]. `None`: there are more than so many trees of captures.
    pub fn best_fixed(&mut self, most: usize) -> Option<f64> {
        let trees = self.trees(most)?;
        let times = trees.into_iter().map(|tree| {
            let mut known = FxHashMap::default();
            self.fixed_from(OpenState::of(0), &tree, &mut known)
        });
        Some(times.fold(f64::INFINITY, f64::min))
    }

    /// All trees of captures from the plate: the way into each site.
    fn trees(&self, most: usize) -> Option<Vec<Vec<Face>>> {
        /// Choices of ways, trees or not.
        const MOST: usize = 200_000;
        let mut trees: Vec<Vec<Face>> = vec![Vec::new()];
        for site in self.sites() {
            let ways = self.ways(self.all(), site);
            if trees.len() * ways.len() > MOST {
                return None;
            }
            trees = (trees.iter())
                .flat_map(|tree| ways.iter().map(|&way| [&tree[..], &[way]].concat()))
                .collect();
        }
        trees.retain(|tree| {
            let parent = |&site: &u32| match self.job.parent(site, tree[site as usize]) {
                NONE => None,
                parent => Some(parent),
            };
            self.sites().all(|site| {
                let steps = std::iter::successors(Some(site), parent);
                steps.take(self.job.sites.len() + 1).count() <= self.job.sites.len()
            })
        });
        (trees.len() <= most).then_some(trees)
    }

    /// From a state in which a block has just come: what is open stays open.
    fn fixed_from(
        &mut self,
        from: OpenState,
        tree: &[Face],
        known: &mut FxHashMap<OpenState, f64>,
    ) -> f64 {
        let full = from.full();
        if full == self.all() {
            return 0.0;
        }
        if let Some(&known) = known.get(&from) {
            return known;
        }
        let mut least = f64::INFINITY;
        let mut choices = vec![(from, 0)];
        while let Some((state, first)) = choices.pop() {
            let rest =
                |times: &mut Self, site: u32| times.fixed_from(state.filled(site), tree, known);
            least = least.min(self.until_next(state, rest));
            for site in first..self.sites().end {
                let way = tree[site as usize];
                let parent = self.job.parent(site, way);
                let is_closed = !state.has(site) && state.way(site).is_none();
                if is_closed && (parent == NONE || state.has(parent)) {
                    let state = state.with(site, way);
                    if self.rates(state).is_some() {
                        choices.push((state, site + 1));
                    }
                }
            }
        }
        known.insert(from, least);
        least
    }
}

/// For each set that stands, how a block comes to each other site by a way two cells wide.
fn ways_in(job: &SchedulingJob<'_>) -> Vec<Vec<Option<WayIn>>> {
    let sites: &Sites<'_> = job.sites;
    let count = sites.len() as u32;
    let closed = FreeSpace::of(sites, 2).with_gaps(job.waits.has_passable_gaps());
    let of = |full: u32| {
        let mut space = closed.clone();
        let mut stands = (1u32 << count) - 1;
        for site in (0..count).filter(|site| full >> site & 1 == 0) {
            stands &= !(1 << site);
            space.open(sites, site, &|site| stands >> site & 1 == 1, &mut |_| {});
        }
        let way_in = |site: u32| {
            let with = full | 1 << site;
            space.way_in(sites, site, &|site| with >> site & 1 == 1)
        };
        (0..count).map(way_in).collect()
    };
    (0..1u32 << count).map(of).collect()
}
