//! Checks that partial programs are completed, and that the structure of a stopped run is
//! continued.
use std::collections::BTreeSet;

use proptest::prelude::*;
use stochc_compiler::Checked;
use stochc_compiler::check_text;
use stochc_compiler::expanded::EventId;
use stochc_estimate::Rates;
use stochc_ir::Cell;
use stochc_ir::Executable;
use stochc_ir::record::{Outcome, RunRecord};
use stochc_planner::{
    Completion, ExistingStructure, Goal, NoRepair, NotCompleted, PlanSearch, Planned, TargetError,
    Unplanned,
};
use stochc_runtime::{Model, Settings};

use crate::random::grown;
use crate::{compile, simulate, tried};

const PART: &str = "\
// Begun by hand.
shape arch {
    layer 1..2 {
        # . #
    }
    layer 3 {
        # # #
    }
}

assembly castle {
    seed plate 3 x 1 {
        L at (0, 0)
        R at (2, 0)
    }
    phase feet {
        L.up ->> B[1..3]   // the left one
    }
    phase rest {
        yields arch
    }
}
";

fn completed(text: &str) -> Result<Planned, NotCompleted> {
    let completion = Completion::new(&check_text("part.sa", text), None)?;
    let planned = completion.plan(&[], PlanSearch::default());
    Ok(planned.expect("it can be built"))
}

fn error(text: &str) -> String {
    match completed(text) {
        Err(NotCompleted::Refused(reason)) => reason,
        other => panic!("{other:?}"),
    }
}

fn executable(checked: Checked) -> Executable {
    compile(checked).remove(0)
}

/// Makes a run that is stopped after this number of ticks.
fn ran(executable: &Executable, model: Model, max_ticks: Option<u64>) -> RunRecord {
    let settings = Settings {
        max_ticks,
        ..Settings::new(model, 1)
    };
    simulate(executable, &settings, 3, 0)
}

/// Waiting time that the planner assumes for a gap that jams.
const JAM: f64 = 15_000.0;

/// Checks that the estimate of a plan equals `check --cost` for the phase of the plan. `None`
/// compares the whole program.
fn assert_times(planned: &Planned, whole: &Checked, phase: Option<&str>) {
    let program = &whole.programs[0];
    let rates = Rates::known_or_guessed(&[], program.scene.as_ref().unwrap());
    let cost = program.estimate(rates.as_deref()).unwrap();
    let mut phases = program.plan.phases.iter().zip(&cost.phases);
    let times = match phase {
        Some(name) => {
            phases
                .find(|(phase, _)| phase.name == name)
                .unwrap()
                .1
                .times
        }
        None => cost.total,
    };
    let times = times.unwrap();
    let plan = &planned.plan;
    assert_eq!(
        [plan.estimate.mean, plan.estimate.p90].map(Some),
        [times.mean, times.p90]
    );
    assert!(plan.widest <= plan.captures.len(), "{plan:?}");
    // The other blocks already exist, so the only capture decides the time.
    if let [only] = &plan.captures[..]
        && only.wait < JAM
    {
        assert!((f64::from(only.decides) - 1.0).abs() < 1e-3, "{only:?}");
        let cell = |event: EventId| program.layout.cells[event.0 as usize];
        let mut captures = cost.captures.iter();
        let same = captures
            .find(|it| cell(it.event) == Some(only.cell))
            .unwrap();
        assert!(
            (only.wait / same.wait - 1.0).abs() < 0.01,
            "{only:?} {same:?}"
        );
    }
}

#[test]
fn built_cells_are_not_waited_for() {
    let second = PART.replace("yields arch", "R.up -> rest\n        yields arch");
    let started = "\
shape two { layer 1..2 { # . # } }
assembly h {
    seed plate 3 x 1 { A at (0, 0) B at (2, 0) A.up ->> X[1..2] }
    phase p { yields two }
}
";
    let one = "\
shape s { layer 1 { # # } }
scene few from hemisphere { free 200 uniform }
assembly a in few {
    seed plate 2 x 1 { A at (0, 0) B at (1, 0) A.up -> W }
    phase p { yields s }
}
";
    for (text, phase) in [
        (PART, "rest"),
        (&second, "rest2"),
        (started, "p"),
        (one, "p"),
    ] {
        let planned = completed(text).unwrap();
        let whole = check_text("whole.sa", &planned.text);
        assert_times(&planned, &whole, Some(phase));
        assert_eq!(planned.plan.estimate.is_first_guess, text == one);
    }
}

#[test]
fn missing_captures_go_to_the_phase_with_the_claim() {
    let planned = completed(PART).unwrap();
    insta::assert_snapshot!(planned.text);
    let checked = check_text("whole.sa", &planned.text);
    assert_eq!(checked.diagnostics.len(), 0, "{:?}", checked.diagnostics);
    let record = ran(&executable(checked), Model::Shuffle, None);
    assert_eq!(record.outcome, Outcome::Completed);
    assert_eq!(record.blocks_used, 7);
}

#[test]
fn a_phase_with_captures_moves_its_claim_to_a_later_one() {
    let text = PART.replace(
        "yields arch\n    }",
        "R.up -> rest\n        yields arch\n    } // both feet",
    );
    let planned = completed(&text).unwrap();
    insta::assert_snapshot!(planned.text);
    let checked = check_text("whole.sa", &planned.text);
    assert_eq!(checked.diagnostics.len(), 0, "{:?}", checked.diagnostics);
}

#[test]
fn a_structure_that_contains_the_shape_keeps_its_other_blocks() {
    let claim = "R.up -> rest\n        B[3].west -> flag\n        yields at least arch";
    let planned = completed(&PART.replace("yields arch", claim)).unwrap();
    assert!(planned.text.contains("yields at least arch"));
    let checked = check_text("whole.sa", &planned.text);
    assert_eq!(checked.diagnostics.len(), 0, "{:?}", checked.diagnostics);
}

/// The false claim is completed, and not the first one of the file.
#[test]
fn completes_the_unsatisfied_claim() {
    let feet = "shape foot {\n    layer 1..3 {\n        # . .\n    }\n}\n\nassembly";
    let text = PART.replace("assembly", feet);
    let text = text.replace("// the left one\n", "\n        yields foot\n");
    for text in [
        text.clone(),
        text.replace("yields arch", "R.up -> C\n        yields arch"),
    ] {
        let planned = completed(&text).unwrap();
        let checked = check_text("whole.sa", &planned.text);
        assert_eq!(checked.diagnostics.len(), 0, "{}", planned.text);
        let claims = checked.programs[0].plan.phases.iter();
        assert_eq!(claims.filter(|it| !it.claims.is_empty()).count(), 2);
    }
}

/// Blocks on a block that a later phase releases would be released with it.
#[test]
fn nothing_is_attached_to_a_block_released_later() {
    let text = "shape bar { layer 1 { # # } layer 2 { # # } }
assembly a {
    seed plate 2 x 1 { A at (0, 0) }
    phase one { A.up -> C.up -> D }
    phase rest { yields bar }
    phase late { release D }
}
";
    let planned = completed(text).unwrap();
    let checked = check_text("whole.sa", &planned.text);
    assert!(!checked.has_errors(), "{}", planned.text);
}

#[test]
fn impossible_completions_are_rejected_with_a_reason() {
    let whole = completed(PART).unwrap().text;
    assert_eq!(error(&whole), "every phase that claims a shape builds it");
    assert_eq!(
        error(&PART.replace("yields arch", "R.up -> X")),
        "no phase claims a shape: state the final shape with `phase rest { yields NAME }`"
    );
    assert_eq!(
        error(&PART.replace("[1..3]", "[1..4]")),
        "`arch` has no block at (0, 0, 4), where `B[4]` stands: release it in this phase or before"
    );
    let looped = PART.replace("phase rest {", "for i in 1..1 { phase rest[i] {");
    assert!(error(&looped.replace("arch\n    }", "arch\n    } }")).contains("in a loop"));
    let second = format!(
        "{PART}\nassembly other {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ yields arch }} }}\n"
    );
    let first = completed(&second).unwrap().text;
    assert!(first.contains("phase p { yields arch }"), "{first}");
    let wrong = PART.replace("L.up", "Q.up");
    assert!(matches!(completed(&wrong), Err(NotCompleted::Wrong)));
    // The program cannot name a block of an instance without a name, so that block can hold
    // nothing.
    let anonymous = "pattern tower(base) { base.up ->> T[1..2] }\nshape mast { layer 1..4 { # } }\n\
         assembly part { seed plate 1 x 1 { A at (0, 0) }\n phase one { tower(A) }\n phase rest { yields mast } }\n";
    assert_eq!(
        error(anonymous),
        "existing blocks need names to hold the rest: name the instances of `tower`, such as `tower(A) as a`"
    );
    let named = completed(&anonymous.replace("tower(A)", "tower(A) as a")).unwrap();
    assert!(named.text.contains("a.T[2].up"), "{}", named.text);
    let floating = PART
        .replace("R at (2, 0)\n", "")
        .replace("B[1..3]", "B[1..2]");
    let held = completed(&floating).unwrap();
    assert!(held.text.contains("B[2].up"), "{}", held.text);
}

/// The comment belongs to the claim and moves with it.
#[test]
fn a_comment_stays_with_its_claim() {
    let text = "shape mast { layer 1..4 { # } }\n\
         assembly part { seed plate 1 x 1 { A at (0, 0) }\n phase one { A.up -> B\n /// All of it.\n yields mast } }\n";
    let behind = completed(text).unwrap().text;
    assert!(
        behind.contains("/// All of it.\n        yields mast"),
        "{behind}"
    );
    assert_eq!(behind.matches("All of it").count(), 1, "{behind}");
    let inside = text.replace("A.up -> B\n", "A.up -> B }\n phase rest {\n");
    let inside = completed(&inside).unwrap().text;
    assert!(
        inside.contains("/// All of it.\n        yields mast"),
        "{inside}"
    );
}

/// Each assembly has a shape of this name.
const LOCAL: &str = "\
assembly a { shape s { layer 1 { # } }
    seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A yields s } }
assembly b { shape s { layer 1..3 { # } }
    seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> B } phase rest { yields s } }
";

#[test]
fn a_shape_is_that_of_its_assembly() {
    let text = completed(LOCAL).unwrap().text;
    assert!(text.contains("B.up ->"), "{text}");
    let checked = check_text("local.sa", LOCAL);
    let heights = checked.programs.iter().map(|program| {
        let goal = Goal::from_end(&checked, program, None).unwrap();
        goal.cells.len()
    });
    assert_eq!(heights.collect::<Vec<_>>(), [1, 3]);
    let last = Goal::from_program(&checked, None).unwrap();
    assert_eq!(last.cells.len(), 3);
}

/// Blocks next to a shape that is claimed with `at least` belong to the goal.
#[test]
fn a_weaker_claim_keeps_the_other_blocks() {
    let text = "\
shape tower { layer 1..2 { # } }
assembly a {
    seed plate 3 x 1 { M at (0, 0) N at (2, 0) }
    phase g { M.up -> A  N.up -> B.up -> C }
    phase h { A.up -> D yields at least tower }
}
";
    let checked = check_text("weak.sa", text);
    assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
    let goal = Goal::from_end(&checked, &checked.programs[0], None).unwrap();
    assert_eq!(goal.cells.len(), 4);
    let named = Goal::from_end(&checked, &checked.programs[0], Some("tower")).unwrap();
    assert_eq!(named.cells.len(), 2);
    let (mut goal, structure) = left(text, 1);
    goal.stand_on(&structure, &BTreeSet::new()).unwrap();
    let planned = goal.plan(&[], PlanSearch::default()).unwrap();
    assert!(!planned.text.contains("release"), "{}", planned.text);
}

/// The scene replaces the built-in one, also in the written program.
#[test]
fn a_scene_named_like_a_built_in_one_is_written() {
    let text = "scene hemisphere from hemisphere { free 40 uniform }\n\
         assembly a { shape s { layer 1..2 { # # } } seed plate 2 x 1 { M at (0, 0) N at (1, 0) } phase g { M.up ->> A[1..2] N.up ->> B[1..2] yields s } }\n";
    let goal = Goal::from_program(&check_text("own.sa", text), None).unwrap();
    let planned = goal.plan(&[], PlanSearch::default()).unwrap();
    let scene = check_text("planned.sa", &planned.text).programs[0]
        .scene
        .clone();
    assert_eq!(scene.unwrap().free.count, 40, "{}", planned.text);
}

/// Stops a run of the first program of a text at this tick. Returns its target and the existing
/// structure.
fn left(text: &str, max_ticks: u64) -> (Goal, ExistingStructure) {
    let checked = check_text("run.sa", text);
    let goal = Goal::from_end(&checked, &checked.programs[0], None).unwrap();
    let executable = executable(checked);
    let record = ran(&executable, Model::Rate, Some(max_ticks));
    (
        goal,
        ExistingStructure::from_record(&executable.tables, &record),
    )
}

/// Mast with blocks in the cells of the wall.
const WALL: &str = "\
shape wall { layer 1..3 { # # # # } }
assembly walls {
    seed plate 4 x 2 { A at (0, 0) B at (1, 0) D at (3, 0) S at (2, 1) }
    phase first {
        S.up ->> M[1..3].south -> N
        A.up ->> W[1..3]
        B.up ->> X[1..3]
    }
    phase rest timeout 1 ticks { D.up ->> Z[1..3] }
}
";

#[test]
fn surplus_blocks_are_released_with_their_children() {
    let (_, structure) = left(WALL, 100_000);
    let mut wall = Goal::from_program(&check_text("run.sa", WALL), Some("wall")).unwrap();
    let repair = structure.repair(&wall.cells, &BTreeSet::new()).unwrap();
    let released: Vec<Cell> = repair.released.iter().map(|block| block.cell).collect();
    let mut mast = [(2, 0, 3), (2, 1, 1), (2, 1, 2), (2, 1, 3)].map(|(x, y, z)| Cell::new(x, y, z));
    let mut sorted = released.clone();
    sorted.sort_unstable();
    mast.sort_unstable();
    assert_eq!(sorted, mast);
    assert!(repair.existing.iter().all(|block| block.can_capture));

    // A block cannot be released if a dead block is between it and the plate.
    let dead = BTreeSet::from(["M[2]"]);
    let reason = structure
        .repair(&wall.cells, &dead)
        .unwrap_err()
        .to_string();
    assert!(reason.contains("`M[2]` is dead"), "{reason}");

    wall.stand_on(&structure, &BTreeSet::new()).unwrap();
    let planned = tried(&wall, 10).unwrap();
    assert!(planned.text.contains("phase clear"), "{}", planned.text);
    let record = ran(
        &executable(check_text("rest.sa", &planned.text)),
        Model::Shuffle,
        None,
    );
    assert_eq!(record.outcome, Outcome::Completed);
}

#[test]
fn dead_blocks_stay_and_capture_nothing() {
    let text = "\
assembly comb {
    seed plate 3 x 1 { P at (0, 0) Q at (1, 0) }
    phase one { P.up ->> A[1..4] }
    phase two { Q.up ->> B[1..4] }
}
";
    // Stops the run when the first tower exists and the second one does not.
    let parts = (1000..40_000).step_by(500).map(|ticks| left(text, ticks));
    let mut first = parts.filter(|(_, there)| there.names().any(|name| name == "A[4]"));
    let (mut goal, structure) = first.next().expect("the first tower is built");
    goal.stand_on(&structure, &BTreeSet::from(["A[2]"]))
        .unwrap();
    let planned = tried(&goal, 10).unwrap();
    let (plate, phase) = planned.text.split_once("phase grow").unwrap();
    assert!(plate.contains("P[0, 0].up ->> B[0, 0, 1..4]"), "{plate}");
    for above in 2..=4 {
        assert!(!phase.contains(&format!("B[0, 0, {above}]")), "{phase}");
    }
    let (mut goal, structure) = left(text, 1_000_000);
    let there = goal.stand_on(&structure, &BTreeSet::new());
    assert_eq!(there, Err(NoRepair::Complete));
}

/// Existing blocks that can hold nothing do not help.
#[test]
fn access_paths_contain_no_occupied_cell() {
    let text = "assembly line { seed plate 3 x 3 { M at (1, 1) } phase p { M.up ->> T[1..8] } }\n";
    let parts = (500..40_000).step_by(500).map(|ticks| left(text, ticks));
    let mut first = parts.filter(|(_, there)| there.names().any(|name| name == "T[5]"));
    let (mut goal, structure) = first.next().expect("the fifth block docks");
    goal.stand_on(&structure, &BTreeSet::from(["T[2]"]))
        .unwrap();
    let Err(Unplanned::Refused(TargetError::Loose(parts))) = tried(&goal, 10) else {
        panic!("nothing holds the rest");
    };
    let bridge = parts[0].bridge.as_ref().expect("there is a way around");
    let is_of_line = |cell: &&Cell| (cell.x, cell.y) == (1, 1);
    assert_eq!(bridge.iter().find(is_of_line), None, "{bridge:?}");
    assert!(!bridge.is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// The rest of a run that follows a plan can be built at any time. With dead blocks, it can be
    /// built as far as other blocks reach.
    #[test]
    fn completes_the_rest_of_a_run(
        shape in grown(),
        ticks in 1u64..20_000,
        dead in proptest::collection::vec(any::<prop::sample::Index>(), 0..2),
    ) {
        let goal = Goal::from_cells("grown", shape.clone());
        let planned = tried(&goal, 1).unwrap();
        let checked = check_text("grown.sa", &planned.text);
        let mut goal = Goal::from_end(&checked, &checked.programs[0], None).unwrap();
        let executable = executable(checked);
        let record = ran(&executable, Model::Rate, Some(ticks));
        let structure = ExistingStructure::from_record(&executable.tables, &record);
        let names: Vec<&str> = structure.names().collect();
        let dead: BTreeSet<&str> = if names.is_empty() { BTreeSet::new() } else { dead.iter().map(|index| *index.get(&names)).collect() };
        let there = goal.stand_on(&structure, &dead);
        if record.outcome == Outcome::Completed {
            prop_assert_eq!(there, Err(NoRepair::Complete));
            return Ok(());
        }
        there.unwrap();
        match tried(&goal, 3) {
            Ok(planned) => {
                let whole = check_text("rest.sa", &planned.text);
                prop_assert!(whole.diagnostics.is_empty(), "{:?}\n{}", whole.diagnostics, planned.text);
                assert_times(&planned, &whole, None);
                let record = ran(&self::executable(whole), Model::Shuffle, None);
                prop_assert_eq!(record.outcome, Outcome::Completed);
                prop_assert_eq!(record.blocks_used as usize, shape.len());
            }
            Err(Unplanned::Refused(error)) => prop_assert!(!dead.is_empty(), "{}", error),
            Err(Unplanned::Wrong(checked)) => prop_assert!(false, "{:?}", checked.diagnostics),
        }
    }

    /// A program that stops anywhere in a valid order of its shape can be completed.
    #[test]
    fn completes_a_started_program(shape in grown(), share in 0.0..1.0f64) {
        let goal = Goal::from_cells("grown", shape.clone());
        let planned = tried(&goal, 1).unwrap();
        prop_assume!(planned.plan.dismantling.is_none());
        let count = (share * shape.len() as f64) as usize;
        let (head, body) = planned.text.split_once("phase grow").unwrap();
        let name = |cell: Cell| match cell.z {
            0 => format!("P[{}, {}]", cell.x, cell.y),
            _ => format!("B[{}, {}, {}]", cell.x, cell.y, cell.z),
        };
        let begun = planned.plan.captures[..count].iter().enumerate().map(|(number, capture)| {
            let parent = capture.cell.across(capture.direction.opposite()).unwrap();
            format!("phase p{number} {{ {}.{} -> {} }}\n", name(parent), capture.direction, name(capture.cell))
        });
        let begun: String = begun.collect();
        let text = format!("{head}{begun}phase grow {{ yields grown }} }}");
        prop_assert!(body.contains("yields grown"));
        let planned = completed(&text).map_err(|error| TestCaseError::fail(format!("{error:?}\n{text}")))?;
        let whole = check_text("whole.sa", &planned.text);
        prop_assert!(!whole.has_errors(), "{:?}\n{}", whole.diagnostics, planned.text);
        assert_times(&planned, &whole, Some("grow"));
        let record = ran(&self::executable(whole), Model::Shuffle, None);
        prop_assert_eq!(record.outcome, Outcome::Completed);
        prop_assert_eq!(record.blocks_used as usize, shape.len());
    }
}
