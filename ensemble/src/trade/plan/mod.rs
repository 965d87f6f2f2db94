//! Which run comes next: a pure function of what has been measured and of the time that has passed.
//!
//! With a number of runs, every program gets as many at every candidate. With a budget, every candidate is
//! first tried with a few runs, and then the next run always goes where it narrows an interval most
//! for its cost. Either way the reference is refined until that changes no mean any more, as far as can be
//! told, or cannot be.
mod candidate_runs;
#[cfg(test)]
mod tests;

use std::time::Duration;

use stochc_runtime::Settings;

use super::candidates::{candidates, refines, rigid};
use super::convergence::{Doubling, is_settled};
use super::sample::{Measured, Sample};
use candidate_runs::{CandidateRuns, ProgramRuns};

/// Runs by which a program is first known at a candidate.
pub const PILOT: u64 = 4;

/// Ticks after which a run is given up while nobody knows how long they take.
pub const FIRST_LIMIT: u64 = 1_000_000;

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
