//! The best of all programs for a target so small that their mean times need no sampling.
//!
//! A program says beforehand which face captures each site, and which sites have to be there before it opens. Besides waits that keep ways
//! and corners, that includes faces that are held back only so that they slow no other.
use rand::RngExt as _;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use stochc_ir::Face;

use super::adaptive::{ExactTimes, OpenState};
use crate::schedule::Schedule;
use crate::sites::NONE;

/// What a program says of each site.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedProgram {
    /// The way from the face that captures it.
    way: Vec<Face>,
    /// What has to be there before that face opens, as bits; what holds the site is among it.
    before: Vec<u32>,
}

/// Searches that are made, from the program that is known and from a chain of its captures by turns, and programs that are tried in each.
const STARTS: usize = 4;
const STEPS: usize = 8000;

/// The part by which a program may be longer than the one before, on average at first.
const TOLERANCE: f64 = 0.03;

impl FixedProgram {
    /// That of a schedule.
    pub fn of(times: &ExactTimes<'_>, schedule: &Schedule) -> FixedProgram {
        let waiting = times.job().waiting(schedule);
        let mut before = vec![0; schedule.order.len()];
        for (&site, places) in schedule.order.iter().zip(&waiting.before) {
            let sites = places.iter().map(|&place| schedule.order[place as usize]);
            before[site as usize] = sites.fold(0, |bits, other| bits | 1 << other);
        }
        FixedProgram {
            way: schedule.way.clone(),
            before,
        }
    }

    /// The same captures one after the other.
    fn chain(&self, order: &[u32]) -> FixedProgram {
        let mut chain = self.clone();
        let mut before = 0;
        for &site in order {
            chain.before[site as usize] = before;
            before |= 1 << site;
        }
        chain
    }

    /// With another way into a site, or one wait more or less.
    fn change(&mut self, times: &ExactTimes<'_>, rng: &mut ChaCha8Rng) {
        let site = rng.random_range(times.sites());
        let here = site as usize;
        if rng.random_range(0..4) == 0 {
            let ways = times.ways(times.all() & !(1 << site), site);
            self.way[here] = ways[rng.random_range(0..ways.len())];
        } else {
            let other = rng.random_range(times.sites());
            if other != site {
                self.before[here] ^= 1 << other;
            }
        }
        let parent = times.job().parent(site, self.way[here]);
        if parent != NONE {
            self.before[here] |= 1 << parent;
        }
    }
}

impl ExactTimes<'_> {
    /// The mean time of a program \[ticks\]; infinite if it gets stuck, or opens what may not be open.
    pub fn of(&mut self, program: &FixedProgram) -> f64 {
        let mut known = vec![None; self.all() as usize + 1];
        self.program_from(0, program, &mut known)
    }

    fn program_from(
        &mut self,
        full: u32,
        program: &FixedProgram,
        known: &mut [Option<f64>],
    ) -> f64 {
        if full == self.all() {
            return 0.0;
        }
        if let Some(known) = known[full as usize] {
            return known;
        }
        let opens =
            |&site: &u32| full >> site & 1 == 0 && program.before[site as usize] & !full == 0;
        let open = self.sites().filter(opens);
        let state = open.fold(OpenState::of(full), |state, site| {
            state.with(site, program.way[site as usize])
        });
        let found = self.until_next(state, |times, site| {
            times.program_from(full | 1 << site, program, known)
        });
        known[full as usize] = Some(found);
        found
    }

    /// The mean time of the best program that is found by changing that of a schedule \[ticks\].
    pub fn best_program(&mut self, schedule: &Schedule, seed: u64) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let first = FixedProgram::of(self, schedule);
        let chain = first.chain(&schedule.order);
        let mut best = f64::INFINITY;
        for start in 0..STARTS {
            let mut program = [&first, &chain][start % 2].clone();
            let mut time = self.of(&program);
            best = best.min(time);
            for step in 0..STEPS {
                let mut other = program.clone();
                for _ in 0..rng.random_range(1..=3) {
                    other.change(self, &mut rng);
                }
                let left = 1.0 - step as f64 / STEPS as f64;
                let chance = -(1.0 - rng.random::<f64>()).ln();
                let value = self.of(&other);
                if value.is_finite() && value <= time + TOLERANCE * left * left * chance * best {
                    (program, time) = (other, value);
                    best = best.min(time);
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use stochc_grammar::Cancellation;
    use stochc_ir::Cell;
    use stochc_ir::table::Plate;

    use super::*;
    use crate::Target;
    use crate::scheduling::{Priorities, with_job};

    /// What is found of the job of these cells and its listed schedule.
    fn of_job<R>(
        cells: &[(i32, i32, i32)],
        keeps_ways: bool,
        find: impl FnOnce(&mut ExactTimes<'_>, &Schedule) -> R,
    ) -> R {
        let cells = cells.iter().map(|&(x, y, z)| Cell::new(x, y, z)).collect();
        let target = Target::new(cells, Plate { width: 3, depth: 3 }, None, 300).unwrap();
        with_job(&target, 300, |job| {
            let even = Priorities::even(job.sites.len());
            let schedule = job.schedule(&even, Cancellation::NEVER).unwrap();
            find(&mut ExactTimes::new(job, keeps_ways), &schedule)
        })
    }

    /// The mean times of the best policy, of the best one that is fixed, of the best program and of the listed schedule.
    fn times(cells: &[(i32, i32, i32)]) -> [f64; 4] {
        of_job(cells, true, |times, schedule| {
            let program = FixedProgram::of(times, schedule);
            let fixed = times.best_fixed(1000).unwrap();
            [
                times.best(),
                fixed,
                times.best_program(schedule, 1),
                times.of(&program),
            ]
        })
    }

    fn is_close(one: f64, other: f64) -> bool {
        (one / other - 1.0).abs() < 1e-9
    }

    #[test]
    fn there_is_nothing_to_decide_in_a_column() {
        let [best, others @ ..] = times(&[(0, 0, 1), (0, 0, 2), (0, 0, 3)]);
        assert!(
            others.iter().all(|&other| is_close(best, other)),
            "{best} {others:?}"
        );
    }

    /// The first of two exponential waits, and then the other one, which has forgotten how long it has waited.
    #[test]
    fn far_columns_take_as_long_as_the_later_of_two() {
        let cells = [(0, 0, 1), (2, 2, 1)];
        let expected = of_job(&cells, true, |times, _| {
            let mut rate = |full: u32, open: &[u32], of: usize| {
                let state = open.iter().fold(OpenState::of(full), |state, &site| {
                    state.with(site, Face::Up)
                });
                times.rates(state).unwrap()[of].1
            };
            let [one, other] = [rate(0, &[0, 1], 0), rate(0, &[0, 1], 1)];
            let [after_one, after_other] = [rate(1, &[1], 0), rate(2, &[0], 0)];
            (1.0 + one / after_one + other / after_other) / (one + other)
        });
        for found in times(&cells) {
            assert!(is_close(found, expected), "{found} {expected}");
        }
    }

    #[test]
    fn whoever_may_do_more_is_no_slower() {
        let square = [(0, 0, 1), (1, 0, 1), (0, 1, 1), (1, 1, 1)];
        let arm = [(1, 1, 1), (1, 1, 2), (0, 1, 2), (2, 1, 2), (1, 0, 2)];
        for cells in [&square[..], &arm] {
            let times = times(cells);
            let is_no_less = |two: &[f64]| two[0] <= two[1] * (1.0 + 1e-9);
            assert!(times.windows(2).all(is_no_less), "{times:?}");
        }
        // The tower that is there first holds the bridge.
        let towers = [(0, 0, 1), (2, 0, 1), (0, 0, 2), (2, 0, 2), (1, 0, 2)];
        let [best, fixed, ..] = times(&towers);
        assert!(best < 0.999 * fixed, "{best} {fixed}");
    }

    /// Between two others there is no wide way to a cell: rings are closed at corners.
    #[test]
    fn ways_that_are_kept_take_time() {
        let cells = [
            (0, 0, 1),
            (0, 1, 1),
            (1, 0, 1),
            (2, 0, 1),
            (2, 1, 1),
            (1, 2, 1),
            (0, 2, 1),
            (2, 2, 1),
        ];
        let [free, kept] =
            [false, true].map(|keeps| of_job(&cells, keeps, |times, _| times.best()));
        assert!(free < kept, "{free} {kept}");
    }
}
