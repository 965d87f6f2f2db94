//! Which run comes next: a pure function of what has been measured and of the time that has passed.
//!
//! With a number of runs, every program gets as many at every candidate. With a budget, every candidate is
//! first tried with a few runs, and then the next run always goes where it narrows an interval most
//! for its cost. Either way the reference is refined until that changes no mean any more, as far as can be
//! told, or cannot be.
use std::time::Duration;

use stochc_runtime::Settings;

use super::candidates::{candidates, refines, rigid};
use super::convergence::{Doubling, is_settled};
use super::sample::{End, Measured, Sample};
use crate::statistics::unseen_share_error;

/// Runs by which a program is first known at a candidate.
pub const PILOT: u64 = 4;

/// Ticks after which a run is given up while nobody knows how long they take.
pub const FIRST_LIMIT: u64 = 1_000_000;

/// The limit of ticks, as a multiple of the mean of the first runs.
const LIMIT: f64 = 20.0;

/// How much is to be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// This many runs of every program at every candidate.
    Runs(u64),
    /// As much as this time allows.
    Budget(Duration),
}

/// One run to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Job {
    /// Index of the candidate.
    pub candidate: usize,
    /// Index of the program.
    pub program: usize,
    /// Number of the run.
    pub run: u64,
    /// Ticks after which it is given up.
    pub max_ticks: u64,
}

/// What a worker should do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NextJob {
    /// This run.
    Do(Job),
    /// Ask again when another run has ended.
    Wait,
    /// Nothing any more.
    End,
}

/// All of it, while it goes on.
#[derive(Clone, Debug)]
pub struct Plan {
    extent: Extent,
    /// Runs at the same time.
    threads: usize,
    finest: u32,
    programs: usize,
    /// For each program, once it is known; of the user where he says so.
    limits: Option<Vec<u64>>,
    candidates: Vec<CandidateRuns>,
    /// Runs of the finest candidate at which it is next asked whether a finer one is needed.
    checkpoint: u64,
}

/// A setting and its runs.
#[derive(Clone, Debug)]
struct CandidateRuns {
    settings: Settings,
    /// Why it is not measured.
    left_out: Option<String>,
    /// For each program.
    program_runs: Vec<ProgramRuns>,
}

/// One program at one candidate.
#[derive(Clone, Debug, Default)]
struct ProgramRuns {
    started: u64,
    runs: Vec<Measured>,
    /// Of the ticks of runs that did not fail: number, mean, sum of squared deviations (Welford).
    moments: (f64, f64, f64),
    wall: f64,
}

/// A candidate when all is over.
#[derive(Clone, Debug, PartialEq)]
pub struct CandidateOutcome {
    /// What was tried.
    pub settings: Settings,
    /// Why it was not, in words.
    pub left_out: Option<String>,
    /// Of each program.
    pub samples: Vec<Sample>,
}

impl Plan {
    /// A plan for so many programs; `cannot` says why a setting is out of the question.
    pub fn new(
        extent: Extent,
        programs: usize,
        threads: usize,
        finest: u32,
        max_ticks: Option<u64>,
        cannot: impl Fn(&Settings) -> Option<String>,
    ) -> Plan {
        let candidate = |settings: Settings| CandidateRuns {
            left_out: cannot(&settings),
            settings,
            program_runs: vec![ProgramRuns::default(); programs],
        };
        Plan {
            extent,
            threads: threads.max(1),
            finest,
            programs,
            limits: max_ticks.map(|limit| vec![limit; programs]),
            candidates: candidates(finest).into_iter().map(candidate).collect(),
            checkpoint: 2 * PILOT,
        }
    }

    /// What the runs of a program at a candidate are made with.
    pub fn settings(&self, candidate: usize, program: usize) -> Settings {
        Settings {
            max_ticks: Some(self.limit(program)),
            ..self.candidates[candidate].settings.clone()
        }
    }

    /// Runs that have ended, and all that are known to come; `None`: time decides.
    pub fn progress(&self) -> (u64, Option<u64>) {
        let program_runs = || {
            self.candidates
                .iter()
                .flat_map(|candidate| &candidate.program_runs)
        };
        let done = program_runs().map(|cell| cell.runs.len() as u64).sum();
        let total = match self.extent {
            Extent::Budget(_) => None,
            Extent::Runs(runs) => {
                let open = self
                    .candidates
                    .iter()
                    .filter(|candidate| candidate.left_out.is_none());
                Some(open.count() as u64 * self.programs as u64 * runs)
            }
        };
        (done, total)
    }

    /// The next run, `elapsed` after the first.
    pub fn next(&mut self, elapsed: Duration) -> NextJob {
        let left = match self.extent {
            Extent::Runs(_) => f64::INFINITY,
            Extent::Budget(budget) => budget.saturating_sub(elapsed).as_secs_f64(),
        };
        if left <= 0.0 {
            return NextJob::End;
        }
        if self.limits.is_none() {
            let first = self.pilot();
            if let Some(program) = self.candidates[0].lacking(first) {
                return self.start(0, program);
            }
            if self.candidates[0].under_way() {
                return NextJob::Wait;
            }
            self.set_limits();
        }
        match self.extent {
            Extent::Runs(runs) => self.next_of(runs),
            Extent::Budget(_) => self.next_within(left),
        }
    }

    /// Takes over the runs that were measured before, up to the first one that was not; `known` has them. Time decides which are measured next, and
    /// may be over. Of a number of runs there are as many as are asked for, and each is looked up when its turn comes.
    pub fn recall(&mut self, known: impl Fn(&Job, &Settings) -> Option<Measured>) {
        if let Extent::Runs(_) = self.extent {
            return;
        }
        if self.limits.is_none() {
            let first = self.pilot();
            self.recall_candidate(0, first, &known);
            if self.candidates[0].lacking(first).is_some() {
                return;
            }
            self.set_limits();
        }
        for candidate in 0..self.candidates.len() {
            self.recall_candidate(candidate, u64::MAX, &known);
        }
        while let Some(settings) = self.next_refinement() {
            self.add(settings);
            if !self.recall_candidate(self.candidates.len() - 1, u64::MAX, &known) {
                self.candidates.pop();
                return;
            }
        }
    }

    /// Takes down a run that has ended.
    pub fn done(&mut self, job: &Job, measured: Measured) {
        self.candidates[job.candidate].program_runs[job.program].add(measured);
    }

    /// What has been measured.
    pub fn outcomes(&self) -> Vec<CandidateOutcome> {
        let outcome = |candidate: &CandidateRuns| CandidateOutcome {
            settings: candidate.settings.clone(),
            left_out: candidate.left_out.clone(),
            samples: (0..self.programs)
                .map(|p| self.sample(candidate, p))
                .collect(),
        };
        self.candidates.iter().map(outcome).collect()
    }

    /// The limit of ticks of each program.
    pub fn limits(&self) -> Vec<u64> {
        let unknown = || vec![FIRST_LIMIT; self.programs];
        self.limits.clone().unwrap_or_else(unknown)
    }

    fn sample(&self, candidate: &CandidateRuns, program: usize) -> Sample {
        let runs = candidate.program_runs[program].runs.clone();
        Sample::new(runs, self.limit(program))
    }

    fn pilot(&self) -> u64 {
        match self.extent {
            Extent::Runs(runs) => runs.min(PILOT),
            Extent::Budget(_) => PILOT,
        }
    }

    fn set_limits(&mut self) {
        let base = self.candidates[0].program_runs.iter();
        self.limits = Some(base.map(ProgramRuns::limit).collect());
    }

    /// The limit of ticks of a program, as far as it is known.
    fn limit(&self, program: usize) -> u64 {
        let limits = self.limits.as_ref();
        limits.map_or(FIRST_LIMIT, |limits| limits[program])
    }

    /// The next run of a program at a candidate.
    fn job(&self, candidate: usize, program: usize) -> Job {
        Job {
            candidate,
            program,
            run: self.candidates[candidate].program_runs[program].started,
            max_ticks: self.limit(program),
        }
    }

    fn start(&mut self, candidate: usize, program: usize) -> NextJob {
        let job = self.job(candidate, program);
        self.candidates[candidate].program_runs[program].started += 1;
        NextJob::Do(job)
    }

    /// Takes over the runs of a candidate, so many of each program at most; whether there are any.
    fn recall_candidate(
        &mut self,
        candidate: usize,
        most: u64,
        known: impl Fn(&Job, &Settings) -> Option<Measured>,
    ) -> bool {
        let mut has_any = false;
        if self.candidates[candidate].left_out.is_some() {
            return has_any;
        }
        for program in 0..self.programs {
            let settings = self.settings(candidate, program);
            loop {
                let job = self.job(candidate, program);
                let Some(run) = (job.run < most).then(|| known(&job, &settings)).flatten() else {
                    break;
                };
                let cell = &mut self.candidates[candidate].program_runs[program];
                cell.started += 1;
                cell.add(run);
                has_any = true;
            }
        }
        has_any
    }

    fn next_of(&mut self, runs: u64) -> NextJob {
        loop {
            let open = self.candidates.iter().enumerate();
            let lacking = open
                .filter(|(_, candidate)| candidate.left_out.is_none())
                .find_map(|(i, candidate)| Some((i, candidate.lacking(runs)?)));
            if let Some((candidate, program)) = lacking {
                return self.start(candidate, program);
            }
            if self.candidates.iter().any(CandidateRuns::under_way) {
                return NextJob::Wait;
            }
            match self.finer() {
                Some(settings) => self.add(settings),
                None => return NextJob::End,
            }
        }
    }

    fn next_within(&mut self, left: f64) -> NextJob {
        for candidate in 0..self.candidates.len() {
            if self.candidates[candidate].left_out.is_some() {
                continue;
            }
            let Some(program) = self.candidates[candidate].lacking(PILOT) else {
                continue;
            };
            /// More of what is left is not spent on trying a candidate.
            const SHARE: f64 = 0.25;
            let new = self.candidates[candidate]
                .program_runs
                .iter()
                .all(|cell| cell.started == 0);
            let trial = self.expected(candidate) * PILOT as f64 / self.threads as f64;
            if new && trial > SHARE * left {
                let reason = "its first runs would have taken too much of the budget";
                self.candidates[candidate].left_out = Some(reason.to_owned());
                continue;
            }
            if self
                .cost(candidate, program)
                .is_none_or(|cost| cost <= left)
            {
                return self.start(candidate, program);
            }
        }
        if let Some(settings) = self.finer_within(left) {
            self.add(settings);
            return self.next_within(left);
        }
        match self.best(left) {
            Some((candidate, program)) => self.start(candidate, program),
            None => NextJob::End,
        }
    }

    /// Candidates of the refinement that are measured, by substeps.
    fn refinement(&self) -> Vec<usize> {
        let candidates = 0..self.candidates.len();
        let mut found: Vec<usize> = candidates
            .filter(|&i| {
                refines(&self.candidates[i].settings) && self.candidates[i].left_out.is_none()
            })
            .collect();
        found.sort_by_key(|&i| self.candidates[i].settings.substeps);
        found
    }

    /// The next candidate of the refinement, if one is needed and allowed.
    fn finer(&self) -> Option<Settings> {
        let candidates = self.refinement();
        let times = |&i: &usize| -> Vec<_> {
            let candidate = &self.candidates[i];
            (0..self.programs)
                .map(|p| self.sample(candidate, p).times())
                .collect()
        };
        let times: Vec<_> = candidates.iter().map(times).collect();
        let substeps = |i: usize| self.candidates[candidates[i]].settings.substeps;
        let doublings: Vec<Doubling> = (1..candidates.len())
            .map(|i| Doubling::of((substeps(i - 1), &times[i - 1]), (substeps(i), &times[i])))
            .collect();
        let next = self.next_refinement()?;
        (!is_settled(&doublings)).then_some(next)
    }

    /// The next candidate of the refinement that is allowed.
    fn next_refinement(&self) -> Option<Settings> {
        let finest = *self.refinement().last()?;
        let next = self.candidates[finest].settings.substeps.checked_mul(2)?;
        let is_tried = |candidate: &CandidateRuns| candidate.settings == rigid(next);
        (next <= self.finest && !self.candidates.iter().any(is_tried)).then(|| rigid(next))
    }

    /// [`Plan::finer`] at a few points only, since a test that is repeated after every run fails
    /// sooner or later, and only if half of what is left gives the new candidate as many runs.
    fn finer_within(&mut self, left: f64) -> Option<Settings> {
        let finest = *self.refinement().last()?;
        let done = |cell: &ProgramRuns| cell.runs.len() as u64;
        let least = self.candidates[finest]
            .program_runs
            .iter()
            .map(done)
            .min()?;
        if least < self.checkpoint {
            return None;
        }
        let needed = 2.0 * self.expected(finest) * least as f64 / self.threads as f64;
        let settings = self.finer();
        self.checkpoint = match settings {
            Some(_) if needed <= 0.5 * left => 2 * PILOT,
            _ => 2 * least,
        };
        settings.filter(|_| needed <= 0.5 * left)
    }

    fn add(&mut self, settings: Settings) {
        self.candidates.push(CandidateRuns {
            settings,
            left_out: None,
            program_runs: vec![ProgramRuns::default(); self.programs],
        });
    }

    /// Where a run takes most from the variance of a bias for its cost.
    ///
    /// Every bias has the reference in it, so that its runs count for all candidates.
    fn best(&self, left: f64) -> Option<(usize, usize)> {
        let refinement = self.refinement();
        let open = |candidate: &&CandidateRuns| candidate.left_out.is_none();
        let candidates = self.candidates.iter().filter(open).count() as f64;
        let weight = |candidate: usize| match refinement.iter().rev().position(|&r| r == candidate)
        {
            Some(0) => candidates,
            Some(1) => 2.0,
            _ => 1.0,
        };
        let mut best: Option<(f64, usize, usize)> = None;
        for (i, candidate) in self.candidates.iter().enumerate().filter(|(_, r)| open(r)) {
            for (program, cell) in candidate.program_runs.iter().enumerate() {
                let Some(cost) = self.cost(i, program).filter(|cost| *cost <= left) else {
                    continue;
                };
                let n = cell.started as f64;
                let gain = weight(i) * cell.spread() / (n * (n + 1.0) * cost.max(1e-9));
                if gain > best.map_or(0.0, |best| best.0) {
                    best = Some((gain, i, program));
                }
            }
        }
        best.map(|(_, candidate, program)| (candidate, program))
    }

    /// Time for one run of each program at a candidate \[s\]; 0 where nobody can tell.
    fn expected(&self, candidate: usize) -> f64 {
        let programs = 0..self.programs;
        programs
            .filter_map(|program| self.cost(candidate, program))
            .sum()
    }

    /// Time for a run \[s\]: as seen, or as seen at the closest candidate of the same model; `None`:
    /// nobody can tell.
    fn cost(&self, candidate: usize, program: usize) -> Option<f64> {
        let cell = |candidate: &CandidateRuns| candidate.program_runs[program].cost();
        let this = &self.candidates[candidate];
        let substeps = |candidate: &CandidateRuns| f64::from(candidate.settings.substeps);
        cell(this).or_else(|| {
            let kin = self.candidates.iter().filter(|candidate| {
                let plain = candidate.settings.reduction.is_none();
                plain
                    && candidate.settings.model == this.settings.model
                    && cell(candidate).is_some()
            });
            let closest = kin.max_by_key(|candidate| {
                (
                    candidate.settings.substeps <= this.settings.substeps,
                    candidate.settings.substeps,
                )
            })?;
            Some(cell(closest)? * substeps(this) / substeps(closest))
        })
    }
}

impl CandidateRuns {
    /// The program with the fewest runs, if these are fewer than `runs`.
    fn lacking(&self, runs: u64) -> Option<usize> {
        let program_runs = self.program_runs.iter().enumerate();
        let (program, cell) = program_runs.min_by_key(|(_, cell)| cell.started)?;
        (cell.started < runs).then_some(program)
    }

    fn under_way(&self) -> bool {
        self.program_runs
            .iter()
            .any(|cell| (cell.runs.len() as u64) < cell.started)
    }
}

impl ProgramRuns {
    fn add(&mut self, run: Measured) {
        self.runs.push(run);
        self.wall += run.wall;
        if run.end != End::Failed {
            let (n, mean, squares) = &mut self.moments;
            *n += 1.0;
            let off = run.ticks as f64 - *mean;
            *mean += off / *n;
            *squares += off * (run.ticks as f64 - *mean);
        }
    }

    fn cost(&self) -> Option<f64> {
        (!self.runs.is_empty()).then(|| self.wall / self.runs.len() as f64)
    }

    /// Variance of the times over their squared mean; where no run has completed, what chance may have hidden.
    fn spread(&self) -> f64 {
        let (n, mean, squares) = self.moments;
        if n < 2.0 || mean <= 0.0 {
            return 0.0;
        }
        let is_completed = |run: &Measured| run.end == End::Completed;
        match self.runs.iter().any(is_completed) {
            true => squares / (n - 1.0) / (mean * mean),
            false => n * unseen_share_error(n as usize).powi(2),
        }
    }

    /// Ticks after which a run is given up, a number of two digits and zeros.
    fn limit(&self) -> u64 {
        let (n, mean, _) = self.moments;
        if n == 0.0 {
            return FIRST_LIMIT;
        }
        let limit = (LIMIT * mean).max(1.0);
        let digit = 10f64.powi(limit.log10().floor() as i32 - 1).max(1.0);
        ((limit / digit).ceil() * digit) as u64
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use stochc_runtime::{Model, Reduction};

    use super::*;

    /// A world in which a run takes a known time.
    struct World {
        /// Of a candidate and program \[s\].
        cost: fn(&Settings, usize) -> f64,
        /// Of a candidate, program and run.
        ticks: fn(&Settings, usize, u64) -> u64,
    }

    /// Varies from run to run by a tenth, and does not change with the setting.
    fn steady(_: &Settings, _: usize, run: u64) -> u64 {
        1000 + 100 * (run * 7 % 5) - 200
    }

    const EQUAL: World = World {
        cost: |settings, _| 0.01 * f64::from(settings.substeps),
        ticks: steady,
    };

    /// Settles at 16 substeps.
    const DRIFTING: World = World {
        cost: |_, _| 0.001,
        ticks: |settings, _, run| {
            1000 + 5 * (run % 3) + 1000 / u64::from(settings.substeps.min(16))
        },
    };

    fn anything(_: &Settings) -> Option<String> {
        None
    }

    /// Does what the plan says with so many workers; the time at the end.
    fn carry_out(plan: &mut Plan, world: &World, threads: usize) -> f64 {
        // The workers' runs under way, with the time of their end.
        let mut under_way: Vec<(f64, Job, Measured)> = Vec::new();
        let mut now = 0.0;
        loop {
            let next = if under_way.len() < threads {
                plan.next(Duration::from_secs_f64(now))
            } else {
                NextJob::Wait
            };
            if let NextJob::Do(job) = next {
                let settings = plan.settings(job.candidate, job.program);
                let cost = (world.cost)(&settings, job.program);
                let ticks = (world.ticks)(&settings, job.program, job.run);
                let end = if ticks > job.max_ticks {
                    End::Censored
                } else {
                    End::Completed
                };
                let run = Measured {
                    run: job.run,
                    end,
                    ticks: ticks.min(job.max_ticks),
                    cpu: cost,
                    wall: cost,
                };
                under_way.push((now + cost, job, run));
                continue;
            }
            let first =
                (0..under_way.len()).min_by(|&a, &b| under_way[a].0.total_cmp(&under_way[b].0));
            let Some(first) = first else {
                assert_eq!(next, NextJob::End, "it waits for nothing");
                return now;
            };
            let (ended, job, run) = under_way.swap_remove(first);
            now = ended;
            plan.done(&job, run);
        }
    }

    fn budget(seconds: f64) -> Extent {
        Extent::Budget(Duration::from_secs_f64(seconds))
    }

    fn runs(plan: &Plan) -> BTreeMap<String, Vec<usize>> {
        let name = |outcome: &CandidateOutcome| crate::trade::candidates::short(&outcome.settings);
        let counts = |outcome: &CandidateOutcome| outcome.samples.iter().map(Sample::len).collect();
        plan.outcomes()
            .iter()
            .map(|o| (name(o), counts(o)))
            .collect()
    }

    #[test]
    fn a_budget_is_kept_to_within_a_run() {
        for seconds in [0.005, 0.1, 1.0, 3.0, 20.0] {
            for threads in [1, 3] {
                let mut plan = Plan::new(budget(seconds), 2, threads, 64, None, anything);
                let end = carry_out(&mut plan, &EQUAL, threads);
                let longest = 0.01 * 8.0;
                assert!(
                    end <= seconds + longest,
                    "{seconds} s, {threads} threads: {end}"
                );
                // The time is also made use of.
                assert!(
                    end >= 0.8 * seconds,
                    "{seconds} s, {threads} threads: {end}"
                );
            }
        }
    }

    #[test]
    fn every_candidate_is_tried_before_any_is_done_well() {
        let mut plan = Plan::new(budget(20.0), 2, 1, 8, None, anything);
        carry_out(&mut plan, &EQUAL, 1);
        for (name, counts) in runs(&plan) {
            assert!(
                counts.iter().all(|&n| n >= PILOT as usize),
                "{name}: {counts:?}"
            );
        }
    }

    #[test]
    fn a_candidate_that_is_too_dear_is_left_out_with_a_reason() {
        let dear = World {
            cost: |settings, _| match settings.model {
                Model::Rapier => 5.0,
                _ => 0.01,
            },
            ticks: steady,
        };
        let mut plan = Plan::new(budget(30.0), 1, 1, 8, None, anything);
        let end = carry_out(&mut plan, &dear, 1);
        assert!(end <= 35.0, "{end}");
        let outcomes = plan.outcomes();
        let rapier = outcomes
            .iter()
            .filter(|o| o.settings.model == Model::Rapier);
        let left_out = rapier.filter(|o| o.left_out.is_some()).count();
        assert!(
            left_out >= 4,
            "the first tells what the others cost: {left_out}"
        );
    }

    #[test]
    fn runs_go_where_intervals_are_wide_and_runs_cheap() {
        let uneven = World {
            cost: |_, _| 0.01,
            ticks: |settings, program, run| match (program, settings.reduction) {
                // Varies six times as much.
                (1, None) => 1000 + 300 * (run * 7 % 5) - 600,
                (_, _) => 1000 + 50 * (run * 7 % 5) - 100,
            },
        };
        let mut plan = Plan::new(budget(60.0), 2, 1, 8, None, anything);
        carry_out(&mut plan, &uneven, 1);
        let counts = runs(&plan);
        let base = &counts["rigid 1"];
        assert!(base[1] > 3 * base[0], "{counts:?}");
        assert!(
            counts["rigid 8"][1] > 2 * base[1],
            "the reference counts for all: {counts:?}"
        );
    }

    #[test]
    fn a_number_of_runs_is_kept_exactly_and_the_reference_refined() {
        let drifting = World {
            cost: |_, _| 0.01,
            ..DRIFTING
        };
        let mut plan = Plan::new(Extent::Runs(6), 2, 3, 64, None, anything);
        carry_out(&mut plan, &drifting, 3);
        let counts = runs(&plan);
        assert!(counts.values().all(|of| *of == [6, 6]), "{counts:?}");
        assert!(counts.contains_key("rigid 64"), "16, 32 and 64 agree");
        let mut plan = Plan::new(Extent::Runs(6), 2, 3, 32, None, anything);
        carry_out(&mut plan, &drifting, 3);
        assert!(
            !runs(&plan).contains_key("rigid 64"),
            "no further than told"
        );
        let mut plan = Plan::new(Extent::Runs(6), 2, 3, 64, None, anything);
        carry_out(&mut plan, &EQUAL, 3);
        assert!(
            !runs(&plan).contains_key("rigid 16"),
            "nothing changes from the first"
        );
    }

    #[test]
    fn a_budget_refines_the_reference_too() {
        let mut plan = Plan::new(budget(10.0), 1, 1, 64, None, anything);
        carry_out(&mut plan, &DRIFTING, 1);
        assert!(runs(&plan).contains_key("rigid 64"), "{:?}", runs(&plan));
    }

    #[test]
    fn what_was_measured_counts_before_time_is_asked_for() {
        // First runs were made before there was a limit.
        let key = |settings: Settings, program: usize, run: u64| {
            let unlimited = Settings {
                max_ticks: None,
                ..settings
            };
            (format!("{unlimited:?}"), program, run)
        };
        let mut before = Plan::new(budget(10.0), 2, 1, 64, None, anything);
        carry_out(&mut before, &DRIFTING, 1);
        let mut found = BTreeMap::new();
        for (candidate, of) in before.candidates.iter().enumerate() {
            for (program, cell) in of.program_runs.iter().enumerate() {
                let settings = || before.settings(candidate, program);
                found.extend(
                    (cell.runs.iter()).map(|run| (key(settings(), program, run.run), *run)),
                );
            }
        }
        let recall = |job: &Job, settings: &Settings| {
            found
                .get(&key(settings.clone(), job.program, job.run))
                .copied()
        };
        // No time is left, or some.
        for more in [0.0, 5.0] {
            let mut plan = Plan::new(budget(more), 2, 1, 64, None, anything);
            plan.recall(recall);
            assert_eq!(plan.limits(), before.limits());
            assert_eq!(runs(&plan), runs(&before));
            carry_out(&mut plan, &DRIFTING, 1);
            let now = runs(&plan);
            for (name, counts) in runs(&before) {
                assert!(now[&name] >= counts, "{name}: {counts:?}, {:?}", now[&name]);
            }
            assert_eq!(now == runs(&before), more == 0.0);
        }
        // A run that is lacking ends what is taken over of its setting.
        let mut plan = Plan::new(budget(0.0), 2, 1, 64, None, anything);
        plan.recall(|job, settings| recall(job, settings).filter(|_| job.run != 5));
        assert!(runs(&plan).values().flatten().all(|&count| count <= 5));
    }

    #[test]
    fn the_limit_of_ticks_follows_from_the_first_runs() {
        let mut plan = Plan::new(Extent::Runs(5), 1, 1, 2, None, anything);
        // Runs 0 to 3 take 800, 1000, 1200 and 900 ticks.
        carry_out(&mut plan, &EQUAL, 1);
        assert_eq!(plan.limits(), [20_000]);
        let late = World {
            cost: |_, _| 0.01,
            ticks: |settings, _, _| match settings.reduction {
                Some(Reduction::NoFriction) => 1_000_000,
                _ => 137,
            },
        };
        let mut plan = Plan::new(Extent::Runs(5), 1, 1, 2, None, anything);
        carry_out(&mut plan, &late, 1);
        assert_eq!(plan.limits(), [2800], "2740, rounded up");
        let outcomes = plan.outcomes();
        let late = outcomes
            .iter()
            .find(|o| o.settings.reduction == Some(Reduction::NoFriction));
        assert_eq!(late.unwrap().samples[0].count(End::Censored), 5);
        let mut plan = Plan::new(Extent::Runs(5), 1, 1, 2, Some(500), anything);
        carry_out(&mut plan, &EQUAL, 1);
        assert_eq!(plan.limits(), [500], "the user's own");
    }

    #[test]
    fn what_cannot_be_is_not_tried() {
        let no_rapier =
            |settings: &Settings| (settings.model == Model::Rapier).then(|| "it cannot".to_owned());
        let mut plan = Plan::new(Extent::Runs(2), 1, 1, 8, None, no_rapier);
        carry_out(&mut plan, &EQUAL, 1);
        for outcome in plan.outcomes() {
            let cannot = outcome.settings.model == Model::Rapier;
            assert_eq!(outcome.left_out.is_some(), cannot);
            assert_eq!(outcome.samples[0].len(), if cannot { 0 } else { 2 });
        }
    }
}
