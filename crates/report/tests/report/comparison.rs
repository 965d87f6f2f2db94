//! Tests the table that compares programs, and its figures.
use insta::{assert_json_snapshot, assert_snapshot};
use stochc_experiments::statistics::{Test, median};
use stochc_experiments::{Comparison, WaitsTally, captures};
use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::table::PhaseId;
use stochc_report::tables::{captures_to_text, comparison_to_text};
use stochc_results::{Destination, Finished, Manifest};
use stochc_runtime::Settings;

use crate::world::{manifest, program, run_on, scene, simulate};

/// Times of the runs of the first program.
const LEFT: [u64; 8] = [2948, 6611, 5120, 7303, 14496, 4410, 3999, 6120];
/// Times of the runs of the second program.
const RIGHT: [u64; 6] = [2826, 5158, 4400, 5011, 8312, 4790];

fn record(run: usize, outcome: Outcome, phase_ticks: Vec<u64>, ticks: u64) -> RunRecord {
    RunRecord {
        phase_ticks,
        blocks_used: 12 + run as u32 % 3,
        hops: 40,
        ..RunRecord::without_bonds(run as u64, outcome, ticks)
    }
}

fn at(program: usize, times: &[u64]) -> Vec<Finished> {
    let record = |(run, &ticks)| {
        let first = ticks / 4;
        record(run, Outcome::Completed, vec![first, ticks - first], ticks)
    };
    let records = times.iter().enumerate().map(record);
    records
        .map(|record| Finished {
            program,
            record,
            cpu: None,
        })
        .collect()
}

/// Stops every run of a program that takes more than `limit` ticks.
fn limit(finished: &mut [Finished], limit: u64) {
    for Finished { record, .. } in finished {
        if record.ticks > limit {
            record.outcome = Outcome::TimedOut {
                phase: PhaseId(1),
                by: Limit::MaxTicks,
            };
            record.phase_ticks.truncate(1);
            record.ticks = limit;
        }
    }
}

fn both() -> (Manifest, Vec<Finished>) {
    (manifest(8), [at(0, &LEFT), at(1, &RIGHT)].concat())
}

#[test]
fn two_programs_without_censoring() {
    let (manifest, finished) = both();
    let comparison = Comparison::new(&manifest, &finished);
    assert_snapshot!(comparison_to_text(&comparison, 100));
    let difference = comparison.pairs[0].difference.as_ref().unwrap();
    // Two runs of `left` have no partner in `right` and are ignored.
    assert_eq!(difference.test, Test::Paired { pairs: 6 });
    assert!((difference.difference - 10391.0 / 6.0).abs() < 1e-9);
    // The expected value is for t = 1.7834523482 with 5 degrees of freedom, by numerical
    // integration.
    assert!((difference.p - 0.134595134).abs() < 1e-8);
}

#[test]
fn censored_runs_make_means_lower_bounds() {
    let (manifest, mut finished) = both();
    limit(&mut finished, 6500);
    let failed = Outcome::Failed {
        phase: PhaseId(0),
        reason: "block 7 left the world".into(),
        is_broken: false,
    };
    finished.push(Finished {
        program: 1,
        record: record(6, failed, Vec::new(), 1),
        cpu: None,
    });
    let comparison = Comparison::new(&manifest, &finished);
    assert_snapshot!(comparison_to_text(&comparison, 100));
    let left = comparison.programs[0].time.as_ref().unwrap();
    let all: Vec<f64> = LEFT.iter().map(|&ticks| ticks as f64).collect();
    // Less than half of the runs are stopped, so their times do not affect the median.
    assert_eq!(left.median, median(&all));
    assert!(left.mean < all.iter().sum::<f64>() / 8.0);
    assert_json_snapshot!(comparison);
}

#[test]
fn a_significant_difference_is_reported() {
    let manifest = manifest(6);
    let slow: Vec<u64> = RIGHT.iter().map(|ticks| ticks * 4).collect();
    let mut finished = [at(0, &slow), at(1, &RIGHT)].concat();
    let text = |finished: &[Finished]| {
        let text = comparison_to_text(&Comparison::new(&manifest, finished), 200);
        text.lines().last().unwrap().to_owned()
    };
    let known = text(&finished);
    limit(&mut finished, 20_000);
    assert_snapshot!(format!("{known}\n{}", text(&finished)), @"left - right: 15,248 ± 5,647 ticks, p = 0.0010, paired t test of 6 runs: left takes longer.
left - right: 12,928 ± 2,630 ticks, p < 0.0001, paired t test of 6 runs, times to 20,000 ticks: left takes longer.");
}

#[test]
fn no_run_and_no_completed_run() {
    let manifest = manifest(3);
    let mut never = at(1, &[900, 900, 900]);
    limit(&mut never, 500);
    assert_snapshot!(comparison_to_text(&Comparison::new(&manifest, &never), 100));
}

#[test]
fn many_programs_with_long_names_are_stacked() {
    let name = "a_reconfigured_five_tower_with_a_very_long_name";
    let programs = [name, "line", "line", "line"].map(program);
    let manifest = Manifest::new(Settings::default(), 1, 6, programs.into());
    let turned = |program: usize| {
        let mut times = RIGHT;
        times.rotate_left(program);
        at(program, &times)
    };
    let finished: Vec<_> = (0..4).flat_map(turned).collect();
    let text = comparison_to_text(&Comparison::new(&manifest, &finished), 78);
    assert!(
        text.lines()
            .take_while(|l| !l.is_empty())
            .all(|l| l.chars().count() <= 78)
    );
    assert_snapshot!(text);
}

#[test]
fn one_program_has_no_pairs() {
    let manifest = Manifest::new(Settings::default(), 1, 6, vec![program("line")]);
    let comparison = Comparison::new(&manifest, &at(0, &RIGHT));
    assert!(comparison.pairs.is_empty());
    assert_snapshot!(comparison_to_text(&comparison, 100));
}

#[test]
fn captures_are_summarized_by_edge() {
    let manifest = manifest(40);
    let never = std::sync::atomic::AtomicBool::new(false);
    let results = run_on(2, Destination::Memory(&manifest), &never, simulate).unwrap();
    let finished = results.finished.to_vec().unwrap();
    let mut waits = WaitsTally::default();
    let first = finished.iter().filter(|done| done.program == 0);
    first.for_each(|done| waits.add(&done.record));
    let found = captures(&manifest.programs[0], waits);
    assert_snapshot!(captures_to_text(&found, scene().tick, 100));
    let second = &found[1];
    assert_eq!(second.released, [("B".to_owned(), second.wait.completed)]);
    // Some runs were stopped while waiting for this capture. All their waiting times are included.
    let runs = (finished.iter()).filter(|done| done.program == 0);
    let runs = runs.filter(|done| !matches!(done.record.outcome, Outcome::Failed { .. }));
    assert!(second.wait.incomplete > 0);
    let attempts: usize = runs.map(|done| 1 + done.record.aborts.len()).sum();
    assert_eq!(second.wait.completed + second.wait.incomplete, attempts);
    assert!(captures(&manifest.programs[1], WaitsTally::default()).is_empty());
    assert_snapshot!(captures_to_text(&[], 1.0, 100), @"n  waiting time  CV  entries  docking
─  ────────────  ──  ───────  ───────");
}
