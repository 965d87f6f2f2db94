//! Tests trades with artificial runs: numbers, order, text and figure.
use stochc_experiments::trade::{Convergence, Trade};
use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::table::PhaseId;
use stochc_report::figures;
use stochc_report::tables::trade_to_text;
use stochc_results::{ChosenSetting, EnsembleProgram, Finished, Manifest, Records};
use stochc_runtime::Settings;

/// Limit of ticks. Only very slow runs reach it.
const LIMIT: u64 = 10_000;

/// For each combination of settings, the mean time of each program and the CPU time per run.
const SETTINGS: [(&str, [u64; 2], f64); 7] = [
    ("substeps=1", [1040, 2080], 1.0),
    // Relative to its mean, the first program has the wider interval.
    ("substeps=2", [1000, 2001], 2.0),
    ("substeps=4", [1001, 2000], 4.0),
    ("substeps=8", [1000, 2000], 8.0),
    ("substeps=1 without=rotation", [2000, 1000], 0.5),
    ("substeps=1 without=corners", [3000, 3001], 0.8),
    ("model=rate", [1100, 2200], 0.001),
];

/// Returns an artificial run with a time near `mean`. Runs of different settings with the same
/// number are almost uncorrelated.
fn finished(program: usize, number: u64, mean: u64, cpu: f64, limit: u64) -> Finished {
    let turn = [1, 2, 4][mean as usize / 1000 - 1];
    let ticks = mean - 10 + number * turn % 21;
    let outcome = if ticks <= limit {
        Outcome::Completed
    } else {
        Outcome::TimedOut {
            phase: PhaseId(0),
            by: Limit::MaxTicks,
        }
    };
    Finished {
        program,
        record: RunRecord::without_bonds(number, outcome, ticks.min(limit)),
        cpu: Some(cpu),
    }
}

fn trade() -> Trade {
    trade_within([LIMIT; 2])
}

/// Returns a trade whose runs are stopped at these limits, one for each program.
fn trade_within(limits: [u64; 2]) -> Trade {
    let mut reader = |_: &str| {
        let text = "assembly a { seed plate 3 x 3 { M at (1, 1) }\nphase p { M.up -> A } }";
        Ok(text.as_bytes().to_vec())
    };
    let bounds = stochc_compiler::Limits::default();
    let program = stochc_compiler::check("x.sa", &mut reader, bounds)
        .programs
        .remove(0);
    let executable = program.into_executable().unwrap();
    let (mut programs, mut runs) = (Vec::new(), Vec::new());
    for (place, name) in ["one", "two"].into_iter().enumerate() {
        let mut program = EnsembleProgram::new(name, Vec::new(), executable.clone());
        // Without this change, the programs would be equal and have equal runs.
        program.scene.free.count += place as u32;
        for (settings, means, cpu) in SETTINGS {
            let chosen = settings.split(' ').map(|it| it.split_once('=').unwrap());
            let chosen = chosen.map(|(of, value)| ChosenSetting::new(of, value).unwrap());
            let run = |number| finished(programs.len(), number, means[place], cpu, limits[place]);
            runs.extend((0..21).map(run));
            programs.push(program.at(&chosen.collect::<Vec<_>>()));
        }
    }
    let manifest = Manifest::new(Settings::default(), 1, 21, programs);
    let trade = Trade::from_runs(&manifest, &Records::from(runs));
    trade.unwrap().unwrap()
}

#[test]
fn every_candidate_is_compared_with_the_finest() {
    let trade = trade();
    let reference = trade.reference.as_ref().unwrap();
    assert_eq!(
        (reference.candidate, reference.convergence),
        (3, Convergence::Converged)
    );
    assert!(reference.bound.unwrap() < 0.005);
    assert_eq!(trade.candidates[3].worst, None);
    let worst = trade.candidates[0].worst.unwrap();
    assert!((worst.value - 0.04).abs() < 1e-12, "{worst:?}");
    let close = &trade.candidates[1];
    let [first, second] = [0, 1].map(|program| close.programs[program].bias);
    assert_eq!(close.worst, second, "the first is not off at all");
    // The first program has the wider interval.
    assert_eq!(close.bound, first.and_then(|bias| bias.bound()));
    assert_eq!(trade.candidates[0].cost_ratio, Some(1.0 / 8.0));
    let reversed: Vec<bool> = trade
        .candidates
        .iter()
        .map(|candidate| candidate.reversed)
        .collect();
    assert_eq!(reversed, [false, false, false, false, true, false, false]);
    let front: Vec<bool> = trade
        .candidates
        .iter()
        .map(|candidate| candidate.front)
        .collect();
    // Settings that reverse the order are not Pareto-optimal here.
    assert_eq!(front, [true, true, false, true, false, false, true]);
    assert!(
        trade.candidates[4]
            .reversals()
            .all(|pair| (pair.first, pair.second) == (0, 1))
    );
}

#[test]
fn wrong_conclusions_are_marked_with_and_without_colour() {
    let trade = trade();
    let plain = trade_to_text(&trade, 100, false);
    assert!(plain.contains("REVERSED: one < two"), "{plain}");
    assert!(!plain.contains('\u{1b}'));
    let red = |line: &&str| line.starts_with("\u{1b}[31m");
    let coloured = trade_to_text(&trade, 100, true);
    let lines: Vec<&str> = coloured.lines().filter(red).collect();
    // Each program has two blocks of columns with one red line each. The ranking has one red line.
    assert_eq!(lines.len(), 5, "{coloured}");
    assert!(lines.iter().all(|line| line.contains("no-rotation")));
    let advice = &trade.advice;
    assert!(
        advice.starts_with(
            "`--model rigid --substeps 1` is within 4.4 % of the reference, including"
        ),
        "{advice}"
    );
    assert!(
        advice.contains("`--model rigid --substeps 2` is within"),
        "{advice}"
    );
    assert!(
        advice.contains("Do not compare programs with `--model rigid --substeps 1 --without rot")
    );
}

#[test]
fn the_picture_marks_reversed_pairs() {
    for medium in crate::layout::MEDIA {
        crate::layout::check("trade", &figures::trade(medium, &trade()).file(), medium);
    }
    let picture = figures::trade(figures::Medium::Screen, &trade()).file();
    let picture = roxmltree::Document::parse(&picture).unwrap();
    let of = |class: &str| {
        let nodes = picture.descendants();
        nodes
            .filter(|node| node.attribute("class") == Some(class))
            .count()
    };
    // The marks are for Rigid, Rapier, reduced physics, the rate model, a reversed order, and the
    // reference.
    let marks = ["s0", "s1", "s2", "s3", "hot", "reference"];
    let counts = marks.map(|class| of(&format!("mark {class}")));
    assert_eq!(counts, [3, 0, 1, 1, 1, 1]);
    // Each candidate has an interval bar, except the reference, which has no bias.
    assert_eq!(of("s0"), 3);
}

/// Checks that a setting does not count as accurate if its runs were stopped at the limit.
#[test]
fn unknown_times_are_not_accurate() {
    const SHORT: u64 = 1005;
    let trade = trade_within([SHORT, LIMIT]);
    let reference = trade.reference.as_ref().unwrap();
    assert_eq!(reference.convergence, Convergence::Undecided);
    assert_eq!(reference.doublings[1].censored, [6 + 5, 0]);
    let close = &trade.candidates[1];
    assert_eq!((close.bound, close.front), (None, false));
    let first = &close.programs[0];
    assert_eq!((first.censored, first.timed_out), (5, 0));
    assert_eq!(first.bias.unwrap().horizon, Some(SHORT as f64));
    assert_eq!(close.programs[1].bias.unwrap().horizon, None);
}

/// Checks that a bias of restricted means is not a bound. Censoring moves the difference towards 0.
#[test]
fn a_bias_up_to_a_horizon_is_not_a_bound() {
    let trade = trade_within([1005, LIMIT]);
    let text = trade_to_text(&trade, 200, false);
    let of = |name: &str| {
        let is_row = |line: &&str| line.contains(&format!("  {name} "));
        text.lines().find(is_row).unwrap()
    };
    let slow = of("rigid 1");
    assert!(slow.contains("≥ 1,005") && !slow.contains("≥ 0"), "{slow}");
    // The candidate has no stopped run, but the reference has one.
    assert!(of("rate").contains(" * "), "{text}");
    let text = text.replace("\n  ", " ");
    assert!(text.contains("Biases with * compare means"), "{text}");
    assert!(
        text.contains("converged: the limit of ticks has stopped 11 runs of its last doubling"),
        "{text}"
    );
    assert!(
        text.contains("Use a larger `--max-ticks` to measure them"),
        "{text}"
    );
    assert!(!trade_to_text(&self::trade(), 200, false).contains('*'));
    let drawn = |trade: &Trade| figures::trade(figures::Medium::Screen, trade).file();
    assert!(drawn(&trade).contains(">* of times up to a horizon, no bound<"));
    assert!(!drawn(&self::trade()).contains(">* "));
    for medium in crate::layout::MEDIA {
        crate::layout::check("trade", &figures::trade(medium, &trade).file(), medium);
    }
}
