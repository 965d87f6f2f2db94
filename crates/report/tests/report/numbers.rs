//! Comparison of values in tables with values computed by hand.
use stochc_experiments::statistics::{Observation, Runs, compare};
use stochc_ir::record::Outcome;
use stochc_ir::table::PhaseId;
use stochc_results::{Finished, Manifest, Records};

use crate::sample::{Waits, five, manifest, record, report_of, rows};

fn number(text: &str) -> f64 {
    text.parse().unwrap()
}

fn close(found: &str, expected: f64) {
    assert!(
        (number(found) - expected).abs() < 1e-9,
        "{found} {expected}"
    );
}

/// Checks the curve for the times 100, 200, 200, 300+, 400. It is 4/5, then 4/5 x 2/4, then 0.
/// Greenwood's sum is 1/(5 x 4) = 0.05, then + 2/(4 x 2) = 0.30. After the second step, e is
/// therefore sqrt 0.3 / |ln 0.4| = 0.59775.
#[test]
fn the_survival_curve_is_kaplan_meier() {
    let report = report_of(&[five(0.2)]);
    let rows = rows(&report, "survival.csv");
    let whole: Vec<_> = rows.iter().filter(|row| row["phase"].is_empty()).collect();
    let expected = [
        (100.0, "5", "1", 0.8),
        (200.0, "4", "2", 0.4),
        (400.0, "1", "1", 0.0),
    ];
    assert_eq!(whole.len(), expected.len());
    for (row, (ticks, at_risk, completed, share)) in whole.iter().zip(expected) {
        close(&row["ticks"], ticks);
        assert_eq!((&*row["at_risk"], &*row["completed"]), (at_risk, completed));
        close(&row["incomplete"], share);
    }
    let by = (1.959963984540054 * 0.3_f64.sqrt() / 0.4_f64.ln().abs()).exp();
    close(&whole[1]["low"], 0.4_f64.powf(by));
    close(&whole[1]["high"], 0.4_f64.powf(1.0 / by));
    assert_eq!(whole[2]["low"], "", "nothing is left");
    // The second phase of the stopped run is right-censored 200 ticks after its start.
    let last: Vec<_> = rows.iter().filter(|row| row["phase"] == "last").collect();
    let shares: Vec<f64> = last.iter().map(|row| number(&row["incomplete"])).collect();
    let expected = [0.8, 0.6, 0.4, 0.0];
    for (found, expected) in shares.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{shares:?}");
    }
}

/// Checks the mean restricted to 400: 100 + 0.8 x 100 + 0.4 x 200.
#[test]
fn a_censored_mean_is_a_lower_bound() {
    let report = report_of(&[five(0.2)]);
    let means = rows(&report, "means.csv");
    let row = &means[0];
    assert_eq!((&*row["completed"], &*row["incomplete"]), ("4", "1"));
    close(&row["mean"], 260.0);
    close(&row["horizon"], 400.0);
    close(&row["median"], 200.0);
    assert_eq!((&*row["max"], &*row["sd"]), ("", ""), "unknown");
    assert!(report.page.contains("≥ 260"));
}

/// Checks the critical paths. In run 1, the first phase ends with D (100 > 90), in other runs with
/// C and E. F then follows, also in the stopped run.
#[test]
fn the_critical_path_names_the_deciding_captures() {
    let report = report_of(&[five(0.2)]);
    let chains = rows(&report, "critical-paths.csv");
    let of = |run: &str| -> Vec<(String, f64)> {
        let links = chains.iter().filter(|row| row["run"] == run);
        let link = |row: &std::collections::BTreeMap<String, String>| {
            (
                row["event"].clone(),
                number(&row["to"]) - number(&row["from"]),
            )
        };
        links.map(link).collect()
    };
    let link = |event: &str, ticks: f64| (event.to_owned(), ticks);
    assert_eq!(
        of("0"),
        [
            link("A.up -> C", 20.0),
            link("C.up -> E", 30.0),
            link("M.up -> F", 50.0)
        ]
    );
    assert_eq!(
        of("1"),
        [link("B.up -> D", 100.0), link("M.up -> F", 100.0)]
    );
    assert_eq!(of("3")[2], link("M.up -> F", 200.0));
    // The segments of a critical path sum to the time of the run.
    for (run, ticks) in [
        ("0", 100.0),
        ("1", 200.0),
        ("2", 200.0),
        ("3", 300.0),
        ("4", 400.0),
    ] {
        assert_eq!(of(run).iter().map(|link| link.1).sum::<f64>(), ticks);
    }
    // The total time is 1,200 ticks. The shares of F are 50 + 100 + 80 + 200 + 300, and of C 20 +
    // 60 + 50 + 70.
    let waits = rows(&report, "waits.csv");
    let share = |capture: &str| {
        let row = waits.iter().find(|row| row["capture"] == capture).unwrap();
        (number(&row["share"]), row["decided"].clone())
    };
    assert_eq!(share("M.up -> F"), (730.0 / 1200.0, "5".to_owned()));
    assert_eq!(share("A.up -> C"), (200.0 / 1200.0, "4".to_owned()));
    assert_eq!(share("B.up -> D"), (100.0 / 1200.0, "1".to_owned()));
}

#[test]
fn mean_waits_include_censored_waits() {
    let report = report_of(&[five(0.2)]);
    let waits = rows(&report, "waits.csv");
    let order: Vec<&str> = waits.iter().map(|row| &*row["capture"]).collect();
    assert_eq!(order, ["A.up -> C", "C.up -> E", "B.up -> D", "M.up -> F"]);
    close(&waits[0]["wait"], (20 + 50 + 60 + 50 + 70) as f64 / 5.0);
    // The waiting times of F are 50, 80, 100, 200+, 300. Their mean up to 300 is 50 + 0.8 x 30 +
    // 0.6 x 20 + 0.4 x 200.
    assert_eq!((&*waits[3]["captured"], &*waits[3]["censored"]), ("4", "1"));
    close(&waits[3]["wait"], 166.0);
    // One tenth of the waits has ended at 50, and nine tenths at 300, the end of the curve.
    close(&waits[3]["p10"], 50.0);
    close(&waits[3]["p90"], 300.0);
    let origins = rows(&report, "origins.csv");
    let f: Vec<_> = origins
        .iter()
        .filter(|row| row["capture"] == "M.up -> F")
        .collect();
    let reported: Vec<_> = f
        .iter()
        .map(|row| (&*row["origin"], &*row["role"], &*row["captured"]))
        .collect();
    // Among the runs that captured F, only run 1 is odd. Run 3 was stopped.
    assert_eq!(reported, [("free", "", "3"), ("released", "E", "1")]);
}

/// Checks a paired test. The differences of the pairs are -10, -30, -20, -40. Their mean is -25 and
/// their SD sqrt(500 / 3), so t = -25 / (SD / 2).
#[test]
fn programs_with_one_seed_are_compared_run_by_run() {
    let [mut first, mut second] = [0.2, 0.3].map(five);
    let waits = |f| Waits {
        c: 10,
        e: 10,
        d: 5,
        f: Some(f),
        after: 0,
    };
    let make = |friction, fs: [u64; 4]| {
        let manifest = manifest(friction, 4);
        let runs = (0..)
            .zip(fs)
            .map(|(run, f)| record(&manifest, run, &waits(f)));
        (Records::from(runs.collect::<Vec<_>>()), manifest)
    };
    (first.finished, first.manifest) = make(0.2, [100, 200, 300, 400]);
    (second.finished, second.manifest) = make(0.3, [110, 230, 320, 440]);
    let report = report_of(&[first.clone(), second.clone()]);
    let rows_of = |report| rows(report, "differences.csv").remove(0);
    let row = rows_of(&report);
    assert_eq!(row["test"], "paired t");
    close(&row["difference"], -25.0);
    // By scipy 1.17.1: `ttest_rel(a, b)` gives the p-value 0.030466291662170977, and `t.ppf(.975,
    // 3)` the interval.
    close(&row["p"], 0.030466291662170977);
    let half = 3.182446305284263 * (500.0_f64 / 3.0).sqrt() / 2.0;
    assert!((number(&row["half_width"]) - half).abs() < 1e-6, "{row:?}");
    assert_eq!(row["p"], row["p_holm"], "one test needs no correction");
    // Runs with the same number but different seeds are unrelated.
    second.manifest.seed = 8;
    let report = report_of(&[first.clone(), second]);
    let row = rows_of(&report);
    let times = |fs: [f64; 4]| fs.map(|f| Observation::completed(f + 20.0));
    let runs = |seed, fs| Runs {
        seed,
        times: (0..).zip(times(fs)).collect(),
    };
    let expected = compare(
        &runs(1, [100.0, 200.0, 300.0, 400.0]),
        &runs(2, [110.0, 230.0, 320.0, 440.0]),
    );
    assert_eq!(row["test"], "Welch t");
    close(&row["p"], expected.unwrap().p);
    // A copy of the same runs is not a second sample.
    let again = report_of(&[first.clone(), first]);
    assert_eq!(rows_of(&again)["test"], "same runs");
}

/// Checks two folders. The first has two programs. The second has one of them under another name,
/// with the same runs.
#[test]
fn equal_runs_in_different_folders_are_reported() {
    let times = |manifest: &Manifest, program: usize, fs: [u64; 4]| {
        let runs = (0..).zip(fs).map(|(run, f)| {
            let waits = Waits {
                c: 10,
                e: 10,
                d: 5,
                f: Some(f),
                after: 0,
            };
            let mut done = record(manifest, run, &waits);
            done.program = program;
            done
        });
        runs.collect::<Vec<_>>()
    };
    let mut both = five(0.2);
    let mut alone = five(0.3);
    alone.manifest.runs = 4;
    let mut second = alone.manifest.programs[0].clone();
    alone.finished = times(&alone.manifest, 0, [110, 230, 320, 440]).into();
    second.name = "second".into();
    both.manifest.programs.push(second);
    let first = times(&both.manifest, 0, [100, 200, 300, 400]);
    let second = times(&both.manifest, 1, [110, 230, 320, 440]);
    both.finished = first.into_iter().chain(second).collect::<Vec<_>>().into();
    let report = report_of(&[both, alone]);
    let rows = rows(&report, "differences.csv");
    let tests: Vec<&str> = rows.iter().map(|row| &*row["test"]).collect();
    assert_eq!(tests, ["paired t", "repeated", "same runs"]);
    // A single test requires no correction.
    assert_eq!(rows[0]["p"], rows[0]["p_holm"]);
    assert!(report.page.contains("repeat the runs of another pair"));
}

/// Checks that shares and counts on the page exclude failed runs, as the data do.
#[test]
fn failed_runs_are_excluded() {
    let summarize = |runs: Vec<Finished>| {
        let mut input = five(0.2);
        input.finished = runs.into();
        let report = report_of(&[input]);
        let cells = |caption: &str| {
            let (_, table) = report.page.split_once(caption).unwrap();
            table.split_once("</table>").unwrap().0.to_owned()
        };
        [
            cells("Times of the phases"),
            cells("Mean waiting and docking times"),
        ]
    };
    let mut runs: Vec<Finished> = Vec::new();
    five(0.2)
        .finished
        .each(|done| runs.push(done.clone()))
        .unwrap();
    let mut failed = runs[0].clone();
    failed.record.run = 5;
    failed.record.ticks = 50_000;
    failed.record.outcome = Outcome::Failed {
        phase: PhaseId(0),
        reason: "a block is nowhere".into(),
        is_broken: false,
    };
    let with_failed = runs.iter().cloned().chain([failed]).collect();
    let complete = summarize(runs);
    assert!(complete[1].contains("5 of 5"), "{}", complete[1]);
    assert_eq!(summarize(with_failed), complete);
}

/// Checks the differences between slow and fast runs with and without broken structures.
#[test]
fn broken_runs_are_not_among_the_slow_runs() {
    let mut runs: Vec<Finished> = Vec::new();
    for copy in 0..6 {
        let add = |done: &Finished| {
            let mut done = done.clone();
            done.record.run += 5 * copy;
            runs.push(done);
        };
        five(0.2).finished.each(add).unwrap();
    }
    let slower = |runs: &[Finished]| {
        let mut input = five(0.2);
        input.finished = runs.to_vec().into();
        let report = report_of(&[input]);
        let found = rows(&report, "waits.csv").into_iter();
        found
            .map(|mut row| row.remove("slower").unwrap())
            .collect::<Vec<_>>()
    };
    let expected = slower(&runs);
    assert!(expected.iter().any(|it| it != "0"), "{expected:?}");
    for run in 30..36 {
        let mut broken = runs[0].clone();
        broken.record.run = run;
        broken.record.outcome = Outcome::Failed {
            phase: PhaseId(0),
            reason: "a bond broke".into(),
            is_broken: true,
        };
        runs.push(broken);
    }
    assert_eq!(slower(&runs), expected);
}

#[test]
fn three_programs_are_corrected_for_three_pairs() {
    let mut inputs = [0.1, 0.2, 0.3].map(five);
    for (input, seed) in inputs.iter_mut().zip(1..) {
        input.manifest.seed = seed;
    }
    let report = report_of(&inputs);
    let rows = rows(&report, "differences.csv");
    assert_eq!(rows.len(), 3);
    for row in rows {
        // All times are equal except for one censored run, so there is no significant difference.
        assert_eq!(row["test"], "Welch t");
        close(&row["difference"], 0.0);
        assert_eq!(row["p_holm"], "1");
    }
}

#[test]
fn one_differing_parameter_is_a_sweep() {
    let report = report_of(&[0.3, 0.1, 0.2].map(five));
    let rows = rows(&report, "sweeps.csv");
    let values: Vec<&str> = rows.iter().map(|row| &*row["value"]).collect();
    assert_eq!(values, ["0.1", "0.2", "0.3"]);
    assert!(
        rows.iter()
            .all(|row| row["parameter"] == "contact.friction")
    );
    assert!(report.page.contains("contact.friction"));
    // If two scene parameters differ, there is no sweep.
    let mut inputs = [0.1, 0.2].map(five);
    inputs[0].manifest.programs[0].scene.tick *= 2.0;
    let text = &mut inputs[0].manifest.programs[0].sources[0].text;
    *text = text.replace("hemisphere_2005 {", "hemisphere_2005 { tick 40ms ");
    let report = report_of(&inputs);
    assert!(!report.files.iter().any(|(name, _)| name == "sweeps.csv"));
    // If scenes have different ticks, times are compared in seconds.
    assert_eq!(
        crate::sample::rows(&report, "differences.csv")[0]["unit"],
        "s"
    );
}
