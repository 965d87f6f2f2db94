//! Plans carried out in a world in which a run takes a known time.
use std::collections::BTreeMap;

use stochc_runtime::{Model, Reduction};

use super::*;
use crate::trade::sample::End;

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
    ticks: |settings, _, run| 1000 + 5 * (run % 3) + 1000 / u64::from(settings.substeps.min(16)),
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
        let first = (0..under_way.len()).min_by(|&a, &b| under_way[a].0.total_cmp(&under_way[b].0));
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
            found.extend((cell.runs.iter()).map(|run| (key(settings(), program, run.run), *run)));
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
