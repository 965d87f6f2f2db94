//! What a policy that sees every docking could reach at best.
//!
//! Waits are taken to be exponential here, with the means that the law of rates has for what stands and what is open. Nothing is
//! forgotten by closing a face then, so a policy decides by what stands alone: after each docking it opens any faces that the hardware
//! and the rule of corners allow. That is a Markov decision process over the sets of sites, and so is the program of a schedule, which
//! opens whatever it may.
use super::{Schedule, SchedulingJob};
use crate::sites::NONE;
use crate::waiting::Waiting;
use crate::waits::{Moment, Stand};
use stochc_ir::{Cell, Face};

/// Sites of a target whose best policy is looked for, at most.
pub const MOST_ADAPTIVE: usize = 10;

/// A face that may open.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OpenFace {
    site: u32,
    way: Face,
}

/// The mean times from each set of sites that stand to the end \[ticks\].
pub struct Policies<'a> {
    job: &'a SchedulingJob<'a>,
    best: Vec<Option<f64>>,
}

impl<'a> Policies<'a> {
    /// Of a job of no more than [`MOST_ADAPTIVE`] sites, none of which stands before.
    pub fn new(job: &'a SchedulingJob<'a>) -> Policies<'a> {
        Policies {
            job,
            best: vec![None; 1 << job.sites.len()],
        }
    }

    /// The mean time of the best policy \[ticks\].
    pub fn best(&mut self) -> f64 {
        self.from(0)
    }

    fn all(&self) -> u32 {
        (1 << self.job.sites.len()) - 1
    }

    fn from(&mut self, full: u32) -> f64 {
        if full == self.all() {
            return 0.0;
        }
        if let Some(known) = self.best[full as usize] {
            return known;
        }
        let mut open = Vec::new();
        let found = self.least(full, 0, &mut open);
        self.best[full as usize] = Some(found);
        found
    }

    /// The least mean time over all faces that may be open besides `open`, of sites from `from` on.
    fn least(&mut self, full: u32, from: u32, open: &mut Vec<OpenFace>) -> f64 {
        if from as usize == self.job.sites.len() {
            return match open.is_empty() {
                true => f64::INFINITY,
                false => self.with(full, open),
            };
        }
        let mut least = self.least(full, from + 1, open);
        if full >> from & 1 == 0 {
            for way in Face::ALL {
                let option = OpenFace { site: from, way };
                if self.may_open(full, open, option) {
                    open.push(option);
                    least = least.min(self.least(full, from + 1, open));
                    open.pop();
                }
            }
        }
        least
    }

    fn may_open(&self, full: u32, open: &[OpenFace], OpenFace { site, way }: OpenFace) -> bool {
        let SchedulingJob {
            sites, hardware, ..
        } = *self.job;
        let parent = self.job.parent(site, way);
        let is_held = match parent {
            NONE => way == Face::Up && sites.is_on_seed(site),
            parent => full >> parent & 1 == 1,
        };
        let is_sibling = |other: &&OpenFace| self.job.parent(other.site, other.way) == parent;
        let has_face =
            parent == NONE || open.iter().filter(is_sibling).count() < usize::from(hardware.faces);
        let open_way = |near: u32| {
            let other = open.iter().find(|other| other.site == near);
            other.map(|other| other.way)
        };
        is_held && has_face && self.job.crowding().may_open(site, way, open_way)
    }

    /// The mean time with these faces open until one of their blocks comes, and by the best policy from then on.
    fn with(&mut self, full: u32, open: &[OpenFace]) -> f64 {
        self.until_next(full, open, |policies, full| policies.from(full))
    }

    fn until_next(
        &mut self,
        full: u32,
        open: &[OpenFace],
        mut rest: impl FnMut(&mut Self, u32) -> f64,
    ) -> f64 {
        let rates: Vec<f64> = (open
            .iter()
            .map(|&option| 1.0 / self.mean(full, open, option)))
        .collect();
        let mut sum = 1.0;
        for (option, rate) in open.iter().zip(&rates) {
            sum += rate * rest(self, full | 1 << option.site);
        }
        sum / rates.iter().sum::<f64>()
    }

    fn mean(&self, full: u32, open: &[OpenFace], OpenFace { site, way }: OpenFace) -> f64 {
        let sites = self.job.sites;
        let stands = |near: Cell| match sites.at(near) {
            other if other == NONE || other == site => Stand::Empty,
            other if full >> other & 1 == 1 => Stand::Full,
            other => match open.iter().find(|option| option.site == other) {
                Some(option) => Stand::Awaited(option.way),
                None => Stand::Empty,
            },
        };
        let bound = f64::from(full.count_ones()) / f64::from(self.job.hardware.free.max(1));
        let moment = Moment {
            free: 1.0 - bound,
            is_first: full == 0,
        };
        self.job.waits.mean(sites.cell(site), way, moment, stands)
    }

    /// The mean time of the program of a schedule \[ticks\].
    pub fn of(&mut self, schedule: &Schedule) -> f64 {
        let waiting = Waiting::of(self.job, schedule);
        let mut known = vec![None; self.best.len()];
        self.planned(schedule, &waiting, 0, &mut known)
    }

    fn planned(
        &mut self,
        schedule: &Schedule,
        waiting: &Waiting,
        full: u32,
        known: &mut [Option<f64>],
    ) -> f64 {
        if full == self.all() {
            return 0.0;
        }
        if let Some(known) = known[full as usize] {
            return known;
        }
        let is_full = |place: &u32| full >> schedule.order[*place as usize] & 1 == 1;
        let places = schedule.order.iter().zip(&waiting.before);
        let open: Vec<OpenFace> = places
            .filter(|(site, before)| full >> **site & 1 == 0 && before.iter().all(is_full))
            .map(|(&site, _)| OpenFace {
                site,
                way: schedule.way[site as usize],
            })
            .collect();
        let found = self.until_next(full, &open, |policies, full| {
            policies.planned(schedule, waiting, full, known)
        });
        known[full as usize] = Some(found);
        found
    }
}

#[cfg(test)]
mod tests {
    use stochc_grammar::Cancellation;
    use stochc_ir::table::Plate;

    use super::*;
    use crate::corridor::Corridors;
    use crate::disassembly::disassemble;
    use crate::free_space::FreeSpace;
    use crate::sites::Sites;
    use crate::waits::RateLaw;
    use crate::{Hardware, Target};

    /// What is found of the job of these cells and its listed schedule.
    fn of_job<R>(
        cells: &[(i32, i32, i32)],
        find: impl FnOnce(&mut Policies<'_>, &Schedule) -> R,
    ) -> R {
        let cells = cells.iter().map(|&(x, y, z)| Cell::new(x, y, z)).collect();
        let target = Target::new(cells, Plate { width: 3, depth: 3 }, None, 300).unwrap();
        let sites = Sites::of(&target);
        let spaces = [FreeSpace::of(&sites, 2), FreeSpace::of(&sites, 1)];
        let keys = vec![0.5; sites.len()];
        let apart = disassemble(&sites, spaces, &keys, Cancellation::NEVER).unwrap();
        let corridors = Corridors::of(&sites, &apart, Cancellation::NEVER).unwrap();
        let hardware = Hardware {
            faces: 1,
            attracts_always: false,
            free: 300,
        };
        let law = RateLaw::new(None);
        let job = SchedulingJob::new(&sites, &apart, &corridors, hardware, &law);
        let schedule = job.schedule(&keys, Cancellation::NEVER).unwrap();
        find(&mut Policies::new(&job), &schedule)
    }

    /// The mean times of the best policy and of the listed schedule.
    fn times(cells: &[(i32, i32, i32)]) -> (f64, f64) {
        of_job(cells, |policies, schedule| {
            (policies.best(), policies.of(schedule))
        })
    }

    #[test]
    fn there_is_nothing_to_decide_in_a_column() {
        let (best, planned) = times(&[(0, 0, 1), (0, 0, 2), (0, 0, 3)]);
        assert!((best / planned - 1.0).abs() < 1e-9, "{best} {planned}");
    }

    /// The first of two exponential waits, and then the other one, which has forgotten how long it has waited.
    #[test]
    fn far_columns_take_as_long_as_the_later_of_two() {
        let cells = [(0, 0, 1), (2, 2, 1)];
        let expected = of_job(&cells, |policies, _| {
            let face = |site| OpenFace {
                site,
                way: Face::Up,
            };
            let both = [face(0), face(1)];
            let [one, other] = both.map(|it| policies.mean(0, &both, it));
            let [after_one, after_other] =
                [(1, face(1)), (2, face(0))].map(|(full, it)| policies.mean(full, &[it], it));
            one * other / (one + other) + (other * after_one + one * after_other) / (one + other)
        });
        let (best, planned) = times(&cells);
        assert!((best / planned - 1.0).abs() < 1e-9, "{best} {planned}");
        assert!((best / expected - 1.0).abs() < 1e-9, "{best} {expected}");
    }

    #[test]
    fn no_schedule_is_better_than_the_best_policy() {
        let square = [(0, 0, 1), (1, 0, 1), (0, 1, 1), (1, 1, 1)];
        let arm = [(1, 1, 1), (1, 1, 2), (0, 1, 2), (2, 1, 2), (1, 0, 2)];
        for cells in [&square[..], &arm] {
            let (best, planned) = times(cells);
            assert!(best <= planned + 1e-6, "{best} {planned}");
        }
    }
}
