//! Checks that every shape of the lab is planned, accepted and built.
use stochc_compiler::check_text;
use stochc_ir::record::Outcome;
use stochc_planner::Baseline;
use stochc_runtime::{Model, Settings};

use crate::{cells, compile, files, goal, named, simulate, tried};

/// Shapes that need a gap of one cell in every known order.
const TIGHT: [&str; 0] = [];

#[test]
fn shapes_are_planned_accepted_and_built_in_several_orders() {
    let mut narrow = Vec::new();
    let files = files();
    assert!(files.len() >= 30, "{}", files.len());
    for path in files {
        let goal = goal(&path);
        let name = goal.name.clone();
        let rounds = if goal.cells.len() > 200 { 1 } else { 12 };
        let mut planned = tried(&goal, rounds);
        if goal.cells.len() > 300 {
            // The shape needs more blocks than the default scene has.
            let mut larger = goal.clone();
            larger.declare_scene("crowd", "scene crowd from hemisphere { free 1000 uniform }");
            assert!(planned.is_err(), "{name}");
            planned = tried(&larger, rounds);
        }
        let planned = planned.unwrap_or_else(|error| panic!("{name}: {error:?}"));
        let mut expected = goal.cells.clone();
        expected.sort_unstable();
        assert_eq!(cells(&planned.plan), expected, "{name}");
        if planned.text.contains("allow tight-approach") {
            narrow.push(name.clone());
        }
        let checked = check_text("planned.sa", &planned.text);
        assert!(
            checked.diagnostics.is_empty(),
            "{name}: {:?}",
            checked.diagnostics
        );
        assert!(planned.text.contains(&format!("yields {name}")), "{name}");
        assert_eq!(
            stochc_grammar::format(&planned.text).unwrap(),
            planned.text,
            "{name}"
        );
        let executables = compile(checked);
        let settings = Settings::new(Model::Shuffle, 1);
        for run in 0..3 {
            let record = simulate(&executables[0], &settings, 1, run);
            assert_eq!(record.outcome, Outcome::Completed, "{name}");
            let dismantling = planned.plan.dismantling.as_ref();
            let handed_over = dismantling.map_or(0, |it| it.hand_overs.len());
            let captures = planned.plan.all_captures().count() + handed_over;
            assert_eq!(record.bonds.len(), captures, "{name}");
        }
    }
    assert_eq!(narrow, TIGHT);
}

#[test]
fn programs_are_written_for_people() {
    for name in ["five_towers", "arch", "pit", "comb", "table"] {
        let planned = tried(&named(name), 300).unwrap();
        insta::with_settings!({ omit_expression => true }, {
            insta::assert_snapshot!(format!("program_{name}"), planned.text);
        });
    }
}

/// Makes a few runs. `lab/planner/run.py` makes more.
#[test]
fn with_physics_nothing_jams() {
    for name in ["five_towers", "closed_platform", "blob_30"] {
        let planned = tried(&named(name), 100).unwrap();
        let executables = compile(check_text("planned.sa", &planned.text));
        let settings = Settings {
            max_ticks: Some(6 * planned.plan.estimate.mean as u64),
            ..Settings::default()
        };
        for run in 0..2 {
            let record = simulate(&executables[0], &settings, 4711, run);
            assert_eq!(record.outcome, Outcome::Completed, "{name}");
        }
    }
}

/// For a line all orders are equal, so naive programs are as good.
#[test]
fn plans_are_no_slower_than_the_baseline() {
    let mut free = 0;
    for path in files() {
        let goal = goal(&path);
        if goal.cells.len() > 40 {
            continue;
        }
        let plan = tried(&goal, 4).unwrap().plan;
        let others = plan
            .alternatives
            .iter()
            .filter(|other| other.diagnostic.is_none());
        for other in others {
            free += 1;
            assert!(
                plan.estimate.mean <= other.estimate.mean,
                "{}: {:?}",
                goal.name,
                other.baseline
            );
        }
        let crowded = plan
            .alternatives
            .iter()
            .any(|other| other.diagnostic == Some("tight-approach"));
        assert!(goal.name != "five_towers" || crowded);
    }
    assert!(free > 20, "{free}");
}

#[test]
fn prints_explanations() {
    let planned = tried(&named("five_towers"), 300).unwrap();
    let explanation = stochc_planner::explanation(&planned.plan);
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!("explanation_five_towers", explanation);
    });
}

#[test]
fn the_same_seed_gives_the_same_plan() {
    let goal = named("chair");
    let first = tried(&goal, 40).unwrap();
    assert_eq!(first.text, tried(&goal, 40).unwrap().text);
    // More tries of the same kind are never worse in the runs that compare them.
    let more = tried(&goal, 400).unwrap();
    assert!(more.plan.estimate.mean < 1.03 * first.plan.estimate.mean);
    for other in &more.plan.alternatives {
        let serial = matches!(other.baseline, Baseline::Chain | Baseline::Nearest);
        assert!(!serial || more.plan.estimate.mean < other.estimate.mean);
    }
    assert_eq!(more.plan.alternatives.len(), Baseline::ALL.len());
}

/// Plans that may jam allow warnings about jams, and cause no other diagnostics.
#[test]
fn plans_that_may_jam_pass_the_check() {
    let table = named("table");
    let plans = table.plans_that_may_jam(&[], 7).unwrap();
    for plan in &plans {
        let checked = check_text("planned.sa", &plan.text);
        assert!(checked.diagnostics.is_empty(), "{:?}", checked.diagnostics);
    }
    let at_once = plans
        .iter()
        .find(|it| it.plan.baseline == Some(Baseline::AtOnce));
    let text = &at_once.unwrap().text;
    assert!(text.contains("allow tight-approach"), "{text}");
    let explained = stochc_planner::explanation(&at_once.unwrap().plan);
    assert!(
        explained.contains("access paths: not checked"),
        "{explained}"
    );
}
