//! Compares the claims of plans with the graphs that the compiler builds for their programs.
use stochc_compiler::check_text;
use stochc_ir::graph::{EventAction, EventGraph, EventId, GraphEvent};
use stochc_ir::{Cell, Face};
use stochc_planner::Goal;

use crate::{files, goal, named, tried};

/// Returns, for each event, all events that it waits for, as bits.
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

/// Captures of a planned program, and which of them can wait at the same time.
struct Captures {
    cells: Vec<Cell>,
    directions: Vec<Face>,
    before: Vec<Vec<u64>>,
}

impl Captures {
    fn new(goal: &Goal) -> Captures {
        let planned = tried(goal, 6).unwrap();
        let checked = check_text("planned.sa", &planned.text);
        let graph = checked.programs[0].event_graph();
        let direction = |event: &GraphEvent| match event.action {
            EventAction::Capture { face, .. } => face,
            EventAction::Release { .. } => panic!("there are no scaffolds"),
        };
        Captures {
            cells: (graph.events.iter().map(|event| event.cell.unwrap())).collect(),
            directions: graph.events.iter().map(direction).collect(),
            before: ancestors(&graph),
        }
    }

    fn are_together(&self, a: usize, b: usize) -> bool {
        let waits = |a: usize, b: usize| self.before[a][b / 64] & 1 << (b % 64) != 0;
        !waits(a, b) && !waits(b, a)
    }

    /// Returns pairs of cells with these distances along the three axes, in any order of the axes.
    fn pairs(&self, spread: [u32; 3]) -> Vec<(usize, usize)> {
        let count = self.cells.len();
        let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        let is_so_far = |&(a, b): &(usize, usize)| {
            let [a, b] = [a, b].map(|event| <[i32; 3]>::from(self.cells[event]));
            let mut far: [u32; 3] = std::array::from_fn(|axis| a[axis].abs_diff(b[axis]));
            far.sort_unstable();
            far == spread
        };
        all.filter(is_so_far).collect()
    }

    /// Returns the cells that share a face with both cells of a pair across a corner.
    fn between(&self, (a, b): (usize, usize)) -> Vec<usize> {
        let is_beside =
            |of: Cell, cell: Cell| Face::ALL.iter().any(|f| of.across(*f) == Some(cell));
        let [a, b] = [a, b].map(|event| self.cells[event]);
        let all = (0..self.cells.len()).map(|event| (event, self.cells[event]));
        let between = all.filter(|&(_, cell)| is_beside(a, cell) && is_beside(b, cell));
        between.map(|(event, _)| event).collect()
    }
}

fn goals() -> impl Iterator<Item = Goal> {
    let goals = files().into_iter().map(|path| goal(&path));
    goals.filter(|goal| goal.cells.len() <= 130)
}

#[test]
fn no_three_faces_of_a_square_are_open_together_in_any_order() {
    let (mut seen, mut open) = (0, 0);
    for goal in goals() {
        let captures = Captures::new(&goal);
        for (a, b) in captures.pairs([0, 1, 1]) {
            let are_open = captures.are_together(a, b);
            open += usize::from(are_open);
            for other in captures.between((a, b)) {
                seen += 1;
                let together = |event| captures.are_together(event, other);
                assert!(
                    !(are_open && together(a) && together(b)),
                    "{}: {:?}",
                    goal.name,
                    [a, b, other].map(|event| captures.cells[event])
                );
            }
        }
    }
    // In the default scene, two faces across a corner may be open together.
    assert!(seen > 1000 && open > 100, "{seen}, {open}");
}

#[test]
fn where_corners_jam_no_two_faces_across_one_are_open_together_in_any_order() {
    let mut seen = 0;
    for mut goal in goals() {
        goal.scene = Some("hemisphere_soft".to_owned());
        let captures = Captures::new(&goal);
        for (a, b) in captures.pairs([0, 1, 1]) {
            if !captures.between((a, b)).is_empty() {
                seen += 1;
                assert!(!captures.are_together(a, b), "{:?}", captures.cells[a]);
            }
        }
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn no_two_faces_of_the_plate_side_by_side_are_open_together_in_any_order() {
    let mut seen = 0;
    for goal in goals() {
        let captures = Captures::new(&goal);
        let is_of_plate =
            |event: usize| captures.cells[event].z == 1 && captures.directions[event] == Face::Up;
        for (a, b) in captures.pairs([0, 0, 1]) {
            if is_of_plate(a) && is_of_plate(b) {
                seen += 1;
                assert!(!captures.are_together(a, b), "{}", goal.name);
            }
        }
    }
    assert!(seen > 20, "{seen}");
}

#[test]
fn implied_waits_are_not_written() {
    for name in ["five_towers", "table", "hollow_cube_with_door", "blob_60"] {
        let planned = tried(&crate::named(name), 6).unwrap();
        let checked = check_text("planned.sa", &planned.text);
        let graph = checked.programs[0].event_graph();
        let before = ancestors(&graph);
        for id in (0..graph.events.len() as u32).map(EventId) {
            let edges = graph.waits_for(id);
            let afters = edges
                .iter()
                .filter(|edge| edge.why == stochc_ir::graph::Dependency::After);
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

/// The waiting times of a plan equal those of `check --cost` for its program.
#[test]
fn waits_match_the_program() {
    let planned = tried(&named("five_towers"), 20).unwrap();
    let checked = stochc_compiler::check_text("planned.sa", &planned.text);
    let program = &checked.programs[0];
    let rates = stochc_estimate::Rates::built_in(program.scene.as_ref().unwrap());
    let cost = program.estimate(rates).unwrap();
    assert_eq!(cost.captures.len(), planned.plan.captures.len());
    for known in &cost.captures {
        let cell = program.layout.cells[known.event.0 as usize].unwrap();
        let mut captures = planned.plan.captures.iter();
        let capture = captures.find(|it| it.cell == cell).unwrap();
        assert!((capture.wait - known.wait).abs() < 1e-9, "{cell}");
    }
}
