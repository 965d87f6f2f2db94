//! Tests the remaining time of runs in progress.
use std::ops::ControlFlow;

use stochc_estimate::{Rates, remaining_time};
use stochc_ir::record::{Outcome, RunRecord};
use stochc_results::{EnsembleProgram, partial_run};
use stochc_runtime::{Model, Settings};

use crate::experiment_log::example;

/// Number of runs of each program.
const RUNS: u64 = 200;

/// Largest distance from 180 runs that the 90 % interval covers, with a probability of 99.9 %.
const TOLERANCE: u64 = 14;

fn run(program: &EnsembleProgram, seed: u64, run: u64, max_ticks: Option<u64>) -> RunRecord {
    let settings = Settings {
        max_ticks,
        ..Settings::new(Model::Rate, 1)
    };
    let mut watch = |_, _| ControlFlow::Continue(());
    program.run(&settings, seed, run, &mut watch).unwrap()
}

/// Returns the number of runs whose remaining time is in its 90 % interval. Each run is cut at a
/// random time.
fn covered(program: &EnsembleProgram, seed: u64) -> u64 {
    let rates = Rates::built_in(&program.scene).unwrap();
    let is_covered = |&number: &u64| {
        let whole = run(program, seed, number, None);
        assert_eq!(whole.outcome, Outcome::Completed);
        // Multiples of the golden ratio are uniform in the unit interval.
        let share = (number as f64 * 0.618_033_988_749_895).fract();
        let cut = (share * whole.ticks as f64) as u64;
        let partial = run(program, seed, number, Some(cut.max(1)));
        let state = partial_run(program, &partial).unwrap();
        let remaining = remaining_time(program.parts(), rates, &state).unwrap();
        let rest = (whole.ticks - partial.ticks) as f64;
        // Times of the rate model are rounded up to ticks.
        (remaining.low.unwrap()..=remaining.high.unwrap() + 1.0).contains(&rest)
    };
    (0..RUNS).filter(is_covered).count() as u64
}

#[test]
fn the_interval_covers_ninety_percent_of_the_runs() {
    for file in [
        "line.sa",
        "five_tower.sa",
        "five_tower_reconfigured.sa",
        "bridge.sa",
    ] {
        let covered = covered(&example(file), 31);
        println!("{file}: the interval covers {covered} of {RUNS} runs");
        let expected = RUNS * 9 / 10;
        assert!(covered.abs_diff(expected) <= TOLERANCE, "{file}");
    }
}

#[test]
fn ended_runs_have_no_remaining_time() {
    let program = example("line.sa");
    assert_eq!(partial_run(&program, &run(&program, 1, 0, None)), None);
}
