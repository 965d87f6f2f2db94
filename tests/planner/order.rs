//! What plans promise, held against the graph that the compiler makes of their programs.
use stochc::check_text;
use stochc::ir::graph::{EventGraph, EventId};

use crate::{files, goal, tried};

/// Of each event, all that it waits for, as bits.
fn ancestors(graph: &EventGraph) -> Vec<Vec<u64>> {
    let count = graph.events.len();
    let mut all: Vec<Option<Vec<u64>>> = vec![None; count];
    fn of(id: EventId, graph: &EventGraph, all: &mut Vec<Option<Vec<u64>>>) {
        if all[id.0 as usize].is_some() {
            return;
        }
        let mut bits = vec![0u64; graph.events.len().div_ceil(64)];
        for edge in graph.waits_for(id) {
            of(edge.first, graph, all);
            let first = edge.first.0 as usize;
            bits[first / 64] |= 1 << (first % 64);
            for (bits, more) in bits.iter_mut().zip(all[first].as_ref().unwrap()) {
                *bits |= more;
            }
        }
        all[id.0 as usize] = Some(bits);
    }
    (0..count as u32).for_each(|id| of(EventId(id), graph, &mut all));
    all.into_iter().map(Option::unwrap).collect()
}

#[test]
fn no_three_faces_of_a_square_are_open_together_in_any_order() {
    let mut seen = 0;
    for path in files() {
        let goal = goal(&path);
        if goal.cells.len() > 130 {
            continue;
        }
        let planned = tried(&goal, 6).unwrap();
        let checked = check_text("planned.sa", &planned.text);
        let graph = checked.programs[0].event_graph();
        let before = ancestors(&graph);
        let waits = |a: usize, b: usize| before[a][b / 64] & 1 << (b % 64) != 0;
        let together = |a: usize, b: usize| !waits(a, b) && !waits(b, a);
        let cells: Vec<[i32; 3]> = graph
            .events
            .iter()
            .map(|event| event.cell.unwrap().into())
            .collect();
        let is_square = |three: [usize; 3]| {
            let spread = (0..3).map(|axis| {
                let at = three.map(|event| cells[event][axis]);
                at.iter().max().unwrap() - at.iter().min().unwrap()
            });
            let mut spread: Vec<i32> = spread.collect();
            spread.sort_unstable();
            spread == [0, 1, 1]
        };
        for a in 0..cells.len() {
            for b in a + 1..cells.len() {
                for c in b + 1..cells.len() {
                    if is_square([a, b, c]) {
                        seen += 1;
                        assert!(
                            !(together(a, b) && together(b, c) && together(a, c)),
                            "{}: {:?} {:?} {:?}",
                            goal.name,
                            cells[a],
                            cells[b],
                            cells[c]
                        );
                    }
                }
            }
        }
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn nothing_is_said_that_goes_without_saying() {
    for name in ["five_towers", "table", "hollow_cube_with_door", "blob_60"] {
        let planned = tried(&crate::named(name), 6).unwrap();
        let checked = check_text("planned.sa", &planned.text);
        let graph = checked.programs[0].event_graph();
        let before = ancestors(&graph);
        for id in (0..graph.events.len() as u32).map(EventId) {
            let edges = graph.waits_for(id);
            let afters = edges
                .iter()
                .filter(|edge| edge.why == stochc::ir::graph::Dependency::After);
            for after in afters {
                let bit = after.first.0 as usize;
                let follows = edges.iter().any(|other| {
                    other.first != after.first
                        && before[other.first.0 as usize][bit / 64] & 1 << (bit % 64) != 0
                });
                assert!(
                    !follows,
                    "{name}: {:?} and {:?}",
                    graph.event(id),
                    graph.event(after.first)
                );
            }
        }
    }
}
