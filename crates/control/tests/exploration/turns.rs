//! Tests blocks that magnetize several faces at a time. Compares order, chains and tables with a
//! simulation in rounds.
use std::fmt::Write as _;

use proptest::prelude::*;
use stochc_compiler::diagnostic::Code;
use stochc_compiler::order::Order;
use stochc_compiler::{Checked, check};
use stochc_control::explore::ExplorationVerdict;

use crate::programs::explore;

/// Faces of a block on the plate that can capture.
const FACES: [&str; 5] = ["up", "north", "east", "south", "west"];

/// Returns a program with one block that captures through five faces in some order. Capture i waits
/// for `afters[i]`.
fn program(faces: u8, order: &[usize], afters: &[Vec<usize>]) -> String {
    let mut text = format!(
        "scene s from hemisphere {{ block cube {{ side 20cm mass 1kg faces {faces} }} }}\n\
         assembly star in s {{\n    seed plate 1 x 1 {{ M at (0, 0) }}\n    \
         phase foot {{ M.up -> T.up -> A }}\n    phase arms {{\n"
    );
    for (&face, after) in order.iter().zip(afters) {
        let _ = write!(text, "        A.{} -> B[{face}]", FACES[face]);
        let names: Vec<String> = after.iter().map(|&i| format!("B[{}]", order[i])).collect();
        if !names.is_empty() {
            let _ = write!(text, " after {}", names.join(", "));
        }
        text.push('\n');
    }
    text.push_str("    }\n}\n");
    text
}

fn checked(text: &str) -> Checked {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    check("star.sa", &mut reader, Default::default())
}

/// Returns the number of rounds until everything has docked, if every possible docking happens in
/// each round. Returns `None` if that never happens.
///
/// A capture may begin when fewer than `faces` of the captures before it are unfinished.
fn rounds(faces: usize, afters: &[Vec<usize>]) -> Option<usize> {
    let mut docked = vec![false; afters.len()];
    for round in 0.. {
        if docked.iter().all(|docked| *docked) {
            return Some(round);
        }
        let may = |i: usize| {
            let before = docked[..i].iter().filter(|docked| !**docked).count();
            before < faces && afters[i].iter().all(|&first| docked[first])
        };
        let next: Vec<usize> = (0..afters.len())
            .filter(|&i| !docked[i] && may(i))
            .collect();
        if next.is_empty() {
            return None;
        }
        next.into_iter().for_each(|i| docked[i] = true);
    }
    None
}

fn is_circle(checked: &Checked) -> bool {
    checked
        .diagnostics
        .iter()
        .any(|diagnostic| diagnostic.code == Code::Cycle)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn turns_match_cycles_chains_and_tables(
        faces in 1u8..=5,
        order in Just(vec![0usize, 1, 2, 3, 4]).prop_shuffle(),
        links in prop::collection::vec((0usize..5, 0usize..5), 0..5),
    ) {
        let mut afters = vec![Vec::new(); 5];
        for (event, first) in links {
            if event != first && !afters[event].contains(&first) {
                afters[event].push(first);
            }
        }
        let text = program(faces, &order, &afters);
        let checked = checked(&text);
        let rounds = rounds(faces.into(), &afters);
        prop_assert_eq!(is_circle(&checked), rounds.is_none(), "{}\n{:#?}", text, checked.diagnostics);
        let program = &checked.programs[0];
        if let (Some(rounds), Some(order)) = (rounds, &program.order) {
            prop_assert_eq!(Order::length(&program.plan, &order.chains[1]), rounds, "{}", text);
        }
        let tables = program.tables.as_ref().or(program.stuck.as_ref()).unwrap();
        let holds = explore(tables).verdict == ExplorationVerdict::Holds;
        prop_assert_eq!(holds, rounds.is_some(), "{}", text);
    }
}

#[test]
fn a_capture_waits_for_any_earlier_one() {
    // The third capture begins after any first docking, and the fourth after the next one. The
    // `after` of the fourth is not a cycle, because the first capture may dock last.
    let afters = [vec![3], vec![], vec![], vec![]];
    let text = program(2, &[0, 1, 2, 3], &afters);
    let checked = checked(&text);
    assert!(!is_circle(&checked), "{:#?}", checked.diagnostics);
    let program = &checked.programs[0];
    let order = program.order.as_ref().unwrap();
    assert_eq!(Order::length(&program.plan, &order.chains[1]), 4);
    let tables = program.tables.as_ref().unwrap();
    let table = stochc_ir::emit::table_text(tables).to_string();
    let rules: Vec<&str> = (table.lines())
        .skip_while(|line| !line.contains("at the start of arms"))
        .skip(1)
        .take(4)
        .map(str::trim)
        .collect();
    assert_eq!(
        rules,
        [
            "once B[3] has docked: magnetize up for B[0] at (0, 0, 3)",
            "magnetize north for B[1] at (0, 1, 2)",
            "once 1 of B[0], B[1] has docked: magnetize east for B[2] at (1, 0, 2)",
            "once 2 of B[0], B[1], B[2] have docked: magnetize south for B[3] at (0, -1, 2)",
        ]
    );
    assert_eq!(explore(tables).verdict, ExplorationVerdict::Holds);
}
