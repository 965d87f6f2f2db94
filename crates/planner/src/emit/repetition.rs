//! Statements that repeat at equal distances are written once, in a loop.
use rustc_hash::FxHashMap;
use stochc_ir::Cell;

use super::loop_nest::{LoopNest, joined, runs};
use super::statement::Statement;

/// Statement and its repetitions.
#[derive(Debug)]
pub struct Repeated<'a> {
    /// Statement nearest to the origin.
    pub first: &'a Statement,
    /// Loops over all repetitions.
    pub nest: LoopNest,
}

/// Returns the positions of all seeds that the statements use, and of `others`, combined in loops.
pub fn seats(statements: &[Statement], others: &[(i32, i32)]) -> Vec<LoopNest> {
    let seeds = statements.iter().filter_map(Statement::seed);
    let mut nests: Vec<LoopNest> = seeds
        .chain(others.iter().copied())
        .map(|(x, y)| LoopNest::new(Cell::new(x, y, 0)))
        .collect();
    nests.sort_by_key(|nest| (nest.base.y, nest.base.x));
    for axis in 0..2 {
        let mut is_merged = vec![false; nests.len()];
        for run in runs(axis, nests.iter().map(|nest| (0, nest))) {
            nests[run[0]] = joined(axis, &run, |i| &nests[i]);
            run[1..].iter().for_each(|&other| is_merged[other] = true);
        }
        nests = remaining(nests, &is_merged);
    }
    nests
}

/// Equal statements that become one statement in nested loops.
struct RepeatedItem {
    /// Index of the first of these statements in the text.
    at: usize,
    /// Number of the statement's content. Statements with equal content have equal numbers.
    kind: usize,
    nest: LoopNest,
    members: Vec<usize>,
}

/// Combines equal statements in loops. Each loop stands at the place of its first statement.
pub fn repeated(statements: &[Statement]) -> Vec<Repeated<'_>> {
    let mut kinds = FxHashMap::default();
    let items = statements.iter().enumerate().map(|(at, statement)| {
        let next = kinds.len();
        RepeatedItem {
            at,
            kind: *kinds.entry(statement.signature()).or_insert(next),
            nest: LoopNest::new(statement.base()),
            members: vec![at],
        }
    });
    let mut items: Vec<RepeatedItem> = items.collect();
    for axis in 0..3 {
        let mut is_merged = vec![false; items.len()];
        for run in runs(axis, items.iter().map(|item| (item.kind, &item.nest))) {
            let at = run
                .iter()
                .map(|&i| items[i].at)
                .min()
                .expect("a run is not empty");
            let members: Vec<usize> = run.iter().flat_map(|&i| items[i].members.clone()).collect();
            // Captures of one parent keep their order: none moves before its predecessor.
            let may_move = |&i: &usize| statements[i].follows.is_none_or(|before| before < at);
            if members.iter().all(may_move) {
                let nest = joined(axis, &run, |i| &items[i].nest);
                let kind = items[run[0]].kind;
                items[run[0]] = RepeatedItem {
                    at,
                    kind,
                    nest,
                    members,
                };
                run[1..].iter().for_each(|&other| is_merged[other] = true);
            }
        }
        items = remaining(items, &is_merged);
    }
    items.sort_by_key(|item| item.at);
    let repeated = items.into_iter().map(|RepeatedItem { nest, members, .. }| {
        let first = members.iter().find(|&&i| statements[i].base() == nest.base);
        Repeated {
            first: &statements[*first.expect("a nest begins at a statement")],
            nest,
        }
    });
    repeated.collect()
}

fn remaining<T>(items: Vec<T>, is_merged: &[bool]) -> Vec<T> {
    let items = items.into_iter().zip(is_merged);
    items
        .filter(|(_, is_merged)| !**is_merged)
        .map(|(item, _)| item)
        .collect()
}
