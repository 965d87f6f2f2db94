//! Compares the proof that every cell stays reachable with a search through all orders of events.
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fmt::Write as _;

use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use proptest::prelude::*;
use stochc_compiler::diagnostic::{Code, Diagnostic, Fix, TextChange};
use stochc_compiler::expanded::{EventId, EventKind, ExpandedEvent};
use stochc_compiler::face_turns::is_ready;
use stochc_compiler::{Checked, FileId, Limits, Program};
use stochc_ir::{Cell, Face};

use crate::{checked, checked_within};

/// Box of cells for random programs.
#[derive(Clone, Copy)]
struct Room {
    edge: i32,
    height: i32,
    captures: usize,
    phases: usize,
}

/// Box that is small enough for a search through all orders.
const SMALL: Room = Room {
    edge: 3,
    height: 3,
    captures: 4,
    phases: 2,
};
/// Box that is large enough for caves.
const LARGE: Room = Room {
    edge: 6,
    height: 4,
    captures: 20,
    phases: 4,
};

/// Returns the same program for blocks that magnetize several faces at a time.
fn with_faces(text: &str, faces: u8) -> String {
    let scene = format!(
        "scene s from hemisphere {{ block cube {{ side 20cm mass 1kg faces {faces} }} }}\n"
    );
    scene + &text.replacen("assembly random {", "assembly random in s {", 1)
}

/// Returns whether a cell is part of the wall around the middle.
fn is_wall(room: Room, cell: Cell) -> bool {
    if room.edge != 3 {
        // The walls form a box inside the box.
        let border = |at: i32, far: i32| at == 1 || at == far;
        return border(cell.x, room.edge - 2)
            || border(cell.y, room.edge - 2)
            || cell.z == room.height;
    }
    let sides = (cell.x - 1).abs() + (cell.y - 1).abs();
    sides == 1 && cell.z < room.height || sides == 0 && cell.z == room.height
}

/// Returns a program in a box of cells. Each number is one choice.
fn program(choices: &[u32], room: Room, releases: bool) -> String {
    let mut choices = choices.iter();
    let mut choose = |most: usize| {
        let choice = choices.next().copied().unwrap_or(0);
        choice as usize % most.max(1)
    };
    let Room { edge, height, .. } = room;
    let mut text = format!("assembly random {{\n    seed plate {edge} x {edge} {{\n");
    // Name, cell, parent, face of the parent.
    let mut blocks: Vec<(String, Cell, Option<String>, Face)> = Vec::new();
    for y in 0..edge {
        for x in 0..edge {
            let name = format!("S{x}{y}");
            let _ = writeln!(text, "        {name} at ({x}, {y})");
            blocks.push((name, Cell::new(x, y, 0), None, Face::Up));
        }
    }
    text.push_str("    }\n");
    let mut names = 0;
    for phase in 0..=choose(room.phases) {
        let _ = writeln!(text, "    phase p{phase} {{");
        let standing: BTreeSet<String> = blocks.iter().map(|block| block.0.clone()).collect();
        let mut busy: BTreeSet<String> = BTreeSet::new();
        let mut events: Vec<String> = Vec::new();
        for _ in 0..(room.captures + choose(2 * room.captures + 1)) {
            let mut after = String::new();
            if !events.is_empty() && choose(5) == 0 {
                after = format!(" after {}", events[choose(events.len())]);
            }
            if releases && choose(4) == 0 {
                let leaves: Vec<usize> = (0..blocks.len())
                    .filter(|&i| blocks[i].2.is_some() && standing.contains(&blocks[i].0))
                    .filter(|&i| !busy.contains(&blocks[i].0))
                    .filter(|&i| {
                        blocks
                            .iter()
                            .all(|block| block.2.as_ref() != Some(&blocks[i].0))
                    })
                    .collect();
                if !leaves.is_empty() {
                    let (name, ..) = blocks.remove(leaves[choose(leaves.len())]);
                    let _ = writeln!(text, "        release {name}{after}");
                    events.push(format!("release {name}"));
                    continue;
                }
            }
            let mut open: Vec<(usize, Face, Cell)> = Vec::new();
            for (i, (_, cell, parent, face)) in blocks.iter().enumerate() {
                for by in Face::ALL {
                    let next = cell.across(by).unwrap();
                    let fits = (0..edge).contains(&next.x)
                        && (0..edge).contains(&next.y)
                        && (1..=height).contains(&next.z);
                    let shows = if parent.is_some() {
                        by != face.opposite()
                    } else {
                        by == Face::Up
                    };
                    if fits && shows && blocks.iter().all(|block| block.1 != next) {
                        open.push((i, by, next));
                    }
                }
            }
            // Often the walls are built first, so that some of them close.
            if choose(4) > 0 && open.iter().any(|&(.., cell)| is_wall(room, cell)) {
                open.retain(|&(.., cell)| is_wall(room, cell));
            }
            let Some(&(parent, by, cell)) = open.get(choose(open.len())) else {
                continue;
            };
            names += 1;
            let name = format!("N{names}");
            let parent = blocks[parent].0.clone();
            let _ = writeln!(text, "        {parent}.{by} -> {name}{after}");
            busy.insert(parent.clone());
            events.push(name.clone());
            blocks.push((name, cell, Some(parent), by));
        }
        text.push_str("    }\n");
    }
    text.push_str("}\n");
    text
}

/// Returns whether a block can reach a cell from outside.
fn is_open(room: Room, target: Cell, full: &BTreeMap<Cell, EventId>) -> bool {
    let mut found = BTreeSet::from([target]);
    let mut open = vec![target];
    while let Some(cell) = open.pop() {
        let inside = (0..room.edge).contains(&cell.x)
            && (0..room.edge).contains(&cell.y)
            && cell.z <= room.height;
        if !inside {
            return true;
        }
        for face in Face::ALL {
            let next = cell.across(face).unwrap();
            if next.z >= 1 && !full.contains_key(&next) && found.insert(next) {
                open.push(next);
            }
        }
    }
    false
}

/// Outcome of a phase over all orders.
struct Orders {
    /// Whether at least one order stops before all events have happened.
    can_get_stuck: bool,
    /// Events that happen in at least one order.
    reached: BTreeSet<EventId>,
}

/// Tries every order of the events of a phase.
fn orders(
    program: &Program,
    events: std::ops::Range<u32>,
    start: &BTreeMap<Cell, EventId>,
) -> Orders {
    let mut seen: HashSet<u32> = HashSet::new();
    let mut open = vec![0u32];
    let mut can_get_stuck = false;
    let mut reached = BTreeSet::new();
    let room = Room {
        edge: program.plan.plate.width as i32,
        ..SMALL
    };
    while let Some(done) = open.pop() {
        let bit = |id: EventId| 1u32 << (id.0 - events.start);
        let mut full = start.clone();
        let happened = || {
            events
                .clone()
                .map(EventId)
                .filter(|&id| done & bit(id) != 0)
        };
        for id in happened() {
            if program.plan.event(id).kind == EventKind::Release {
                let on = program.layout.parents[id.0 as usize].unwrap();
                let cell = program.layout.cells[id.0 as usize].unwrap();
                if full.get(&cell) == Some(&on.capture) {
                    full.remove(&cell);
                }
            }
        }
        for id in happened() {
            if program.plan.event(id).kind != EventKind::Release {
                full.insert(program.layout.cells[id.0 as usize].unwrap(), id);
            }
        }
        let mut moved = false;
        let mut is_over = true;
        for id in events
            .clone()
            .map(EventId)
            .filter(|&id| done & bit(id) == 0)
        {
            is_over = false;
            let waits = !is_ready(&program.graph, id, |first| done & bit(first) != 0);
            let cell = program.layout.cells[id.0 as usize].unwrap();
            let is_release = program.plan.event(id).kind == EventKind::Release;
            if !waits && (is_release || is_open(room, cell, &full)) {
                moved = true;
                reached.insert(id);
                if seen.insert(done | bit(id)) {
                    open.push(done | bit(id));
                }
            }
        }
        can_get_stuck |= !moved && !is_over;
    }
    Orders {
        can_get_stuck,
        reached,
    }
}

/// Returns the result of the search for all phases. Each phase starts as if the previous phases had
/// completed.
fn all_orders(program: &Program) -> Orders {
    let mut full: BTreeMap<Cell, EventId> = BTreeMap::new();
    let mut result = Orders {
        can_get_stuck: false,
        reached: BTreeSet::new(),
    };
    for (phase, (emptied, _)) in program.plan.phases.iter().zip(&program.layout.changes) {
        let mut orders = orders(program, phase.events.clone(), &full);
        result.can_get_stuck |= orders.can_get_stuck;
        result.reached.append(&mut orders.reached);
        for cell in emptied {
            full.remove(cell);
        }
        for id in phase.events.clone().map(EventId) {
            if program.plan.event(id).kind != EventKind::Release {
                full.insert(program.layout.cells[id.0 as usize].unwrap(), id);
            }
        }
    }
    result
}

fn can_get_stuck(program: &Program) -> bool {
    all_orders(program).can_get_stuck
}

/// Returns an event and all events that it waits for.
fn all_before(program: &Program, id: EventId) -> BTreeSet<EventId> {
    let mut found = BTreeSet::from([id]);
    let mut open = vec![id];
    while let Some(id) = open.pop() {
        for first in (program.graph).neighbors_directed(NodeIndex::new(id.0 as usize), Incoming) {
            if found.insert(program.graph[first]) {
                open.push(program.graph[first]);
            }
        }
    }
    found
}

fn is_never(diagnostic: &Diagnostic) -> bool {
    diagnostic.title.ends_with(" can never be reached")
}

/// Returns every capture with its phase and the cells that are full in its worst case, directly
/// from the definition.
fn worst_cases(program: &Program) -> Vec<(usize, EventId, BTreeMap<Cell, EventId>)> {
    let mut full: BTreeMap<Cell, EventId> = BTreeMap::new();
    let mut cases = Vec::new();
    for (number, phase) in program.plan.phases.iter().enumerate() {
        for id in phase.events.clone().map(EventId) {
            let mut following = BTreeSet::from([id]);
            let mut open = vec![id];
            while let Some(id) = open.pop() {
                for next in program.graph.neighbors(NodeIndex::new(id.0 as usize)) {
                    if following.insert(program.graph[next]) {
                        open.push(program.graph[next]);
                    }
                }
            }
            let mut worst = full.clone();
            for other in phase.events.clone().map(EventId) {
                if !following.contains(&other) {
                    worst.insert(program.layout.cells[other.0 as usize].unwrap(), other);
                }
            }
            cases.push((number, id, worst));
        }
        for id in phase.events.clone().map(EventId) {
            full.insert(program.layout.cells[id.0 as usize].unwrap(), id);
        }
    }
    cases
}

/// Returns whether a capture has no access path in its worst case.
fn has_sealed_capture(room: Room, program: &Program) -> bool {
    worst_cases(program)
        .into_iter()
        .any(|(_, id, worst)| !is_open(room, program.layout.cells[id.0 as usize].unwrap(), &worst))
}

/// Returns the cells of a cube of two.
fn cube(low: Cell) -> impl Iterator<Item = Cell> {
    (0..8).map(move |i| Cell::new(low.x + (i & 1), low.y + (i >> 1 & 1), low.z + (i >> 2)))
}

/// Returns whether a cube of two cells can bring a block to a cell. For a gap along `direction` on
/// free ground, the cell next to it suffices.
fn is_wide(room: Room, target: Cell, direction: Face, full: &BTreeMap<Cell, EventId>) -> bool {
    let aside = || {
        let faces = Face::ALL.into_iter();
        let faces = faces.filter(|&face| face != direction && face != direction.opposite());
        faces.map(|face| target.across(face).unwrap())
    };
    let is_gap = aside().all(|beside| beside.z < 1 || !full.contains_key(&beside));
    let is_beside_gap = |low: Cell| {
        let holds = |cell: Cell| cube(low).any(|it| it == cell);
        is_gap && !holds(target) && aside().any(holds)
    };
    let is_free = |low: Cell| low.z >= 1 && cube(low).all(|cell| !full.contains_key(&cell));
    let around = (0..64).map(|i| {
        Cell::new(
            target.x - 2 + i % 4,
            target.y - 2 + i / 4 % 4,
            target.z - 2 + i / 16,
        )
    });
    let mut open: Vec<Cell> = around
        .filter(|&low| cube(low).any(|cell| cell == target) || is_beside_gap(low))
        .filter(|&low| is_free(low))
        .collect();
    let mut found: BTreeSet<Cell> = open.iter().copied().collect();
    while let Some(low) = open.pop() {
        let inside = (-1..room.edge).contains(&low.x)
            && (-1..room.edge).contains(&low.y)
            && low.z <= room.height;
        if !inside {
            return true;
        }
        for face in Face::ALL {
            let next = low.across(face).unwrap();
            if is_free(next) && found.insert(next) {
                open.push(next);
            }
        }
    }
    false
}

fn sealed(checked: &Checked) -> Vec<&Diagnostic> {
    (checked.diagnostics.iter())
        .filter(|diagnostic| diagnostic.code == Code::SealedCavity)
        .collect()
}

/// Returns the captures that diagnostics report. The captures of a statement in a loop are merged.
fn sealed_captures(diagnostics: &[&Diagnostic]) -> usize {
    diagnostics
        .iter()
        .map(|diagnostic| 1 + diagnostic.others.count)
        .sum()
}

/// Returns the first event of a diagnostic.
fn diagnostic_event(program: &Program, diagnostic: &Diagnostic) -> u32 {
    let location = diagnostic.labels[0].location;
    (program.plan.events.iter())
        .position(|event| event.location == location)
        .unwrap() as u32
}

/// Returns the text after a fix.
fn after_fix(text: &str, diagnostic: &Diagnostic) -> Option<String> {
    Some(changed(text, diagnostic.fix.as_ref()?))
}

fn others(checked: &Checked) -> Vec<&Diagnostic> {
    (checked.diagnostics.iter())
        .filter(|diagnostic| diagnostic.is_error() && diagnostic.code != Code::SealedCavity)
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1500,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn without_releases_the_verdict_is_exact(
        choices in prop::collection::vec(any::<u32>(), 10..120),
    ) {
        let text = program(&choices, SMALL, false);
        let checked = checked(&text);
        prop_assert!(others(&checked).is_empty(), "{text}\n{:#?}", others(&checked));
        let verdict = !sealed(&checked).is_empty();
        prop_assert_eq!(verdict, can_get_stuck(&checked.programs[0]), "{}", text);
    }

    /// Any capture of a block may leave a face free for the cell.
    #[test]
    fn choices_of_faces_leave_the_verdict_exact(
        choices in prop::collection::vec(any::<u32>(), 10..120),
        faces in 2u8..=4,
        releases: bool,
    ) {
        let text = with_faces(&program(&choices, SMALL, releases), faces);
        let checked = checked(&text);
        prop_assert!(others(&checked).is_empty(), "{text}\n{:#?}", others(&checked));
        let verdict = !sealed(&checked).is_empty();
        let is_stuck = can_get_stuck(&checked.programs[0]);
        prop_assert!(verdict || !is_stuck, "{}", text);
        prop_assert!(releases || verdict == is_stuck, "{}", text);
    }

    #[test]
    fn caves_are_searched_completely(
        choices in prop::collection::vec(any::<u32>(), 200..500),
    ) {
        let text = program(&choices, LARGE, false);
        // The limit suffices for the verdicts. Other tests check the fixes.
        let limits = Limits { search: 500_000, ..Limits::default() };
        let checked = checked_within(&text, limits);
        prop_assert!(others(&checked).is_empty(), "{text}\n{:#?}", others(&checked));
        let verdict = !sealed(&checked).is_empty();
        let program = &checked.programs[0];
        prop_assert_eq!(verdict, has_sealed_capture(LARGE, program), "{}", text);
        if verdict {
            return Ok(());
        }
        for (number, phase) in program.plan.phases.iter().enumerate() {
            let tight: Vec<EventId> = (worst_cases(program).into_iter())
                .filter(|&(of, ..)| of == number)
                .filter(|(_, id, worst)| {
                    let EventKind::Capture { face, .. } = program.plan.event(*id).kind else {
                        return false;
                    };
                    let cell = program.layout.cells[id.0 as usize].unwrap();
                    !is_wide(LARGE, cell, face, worst)
                })
                .map(|(_, id, _)| id)
                .collect();
            let reported = (checked.diagnostics.iter())
                .filter(|diagnostic| diagnostic.code == Code::TightApproach)
                .find(|diagnostic| phase.events.contains(&diagnostic_event(program, diagnostic)))
                .map(|diagnostic| diagnostic.title.split(' ').next().unwrap().parse().unwrap_or(1));
            prop_assert_eq!(reported.unwrap_or(0), tight.len(), "phase {}\n{}", number, text);
        }
    }

    #[test]
    fn with_releases_no_cavity_is_missed(
        choices in prop::collection::vec(any::<u32>(), 10..120),
    ) {
        let text = program(&choices, SMALL, true);
        let checked = checked(&text);
        prop_assert!(others(&checked).is_empty(), "{text}\n{:#?}", others(&checked));
        if can_get_stuck(&checked.programs[0]) {
            prop_assert!(!sealed(&checked).is_empty(), "{}", text);
        }
    }

    #[test]
    fn never_is_reported_if_no_order_reaches_a_cell(
        choices in prop::collection::vec(any::<u32>(), 10..120),
        faces in 1u8..=4,
        releases: bool,
    ) {
        let text = with_faces(&program(&choices, SMALL, releases), faces);
        let checked = checked(&text);
        prop_assert!(others(&checked).is_empty(), "{text}\n{:#?}", others(&checked));
        let program = &checked.programs[0];
        let reached = all_orders(program).reached;
        let mut reported = BTreeSet::new();
        for diagnostic in sealed(&checked) {
            let id = EventId(diagnostic_event(program, diagnostic));
            reported.insert(id);
            let is_reached = reached.contains(&id);
            prop_assert!(!is_never(diagnostic) || !is_reached, "{text}\n{}", diagnostic.title);
            // If faces are chosen, the verdict may be open.
            let is_open = releases || (faces > 1 && diagnostic.title.contains(" may become "));
            prop_assert!(is_open || is_never(diagnostic) || is_reached, "{text}\n{}", diagnostic.title);
        }
        for id in (0..program.plan.events.len() as u32).map(EventId) {
            let is_reported = all_before(program, id).iter().any(|id| reported.contains(id));
            prop_assert!(is_reported || reached.contains(&id), "{text}\n{id:?}");
        }
    }

    #[test]
    fn remedies_work_in_loops_and_patterns(
        choices in prop::collection::vec(any::<u32>(), 100..400),
    ) {
        apply_remedies(&looped(&choices));
    }

    #[test]
    fn the_order_shown_is_possible_and_closes_the_cell(
        choices in prop::collection::vec(any::<u32>(), 10..120),
        faces in 1u8..=4,
    ) {
        let text = with_faces(&program(&choices, SMALL, false), faces);
        let checked = checked(&text);
        for diagnostic in sealed(&checked) {
            prop_assert!(follow(&checked, diagnostic).is_none_or(|closes| closes), "{text}\n{diagnostic:#?}");
        }
    }

    #[test]
    fn remedies_work(
        choices in prop::collection::vec(any::<u32>(), 10..120),
        faces in 1u8..=3,
    ) {
        let mut text = with_faces(&program(&choices, SMALL, false), faces);
        // Each fix resolves its own capture. The others follow one at a time.
        for _ in 0..20 {
            let now = checked(&text);
            prop_assert!(others(&now).is_empty(), "{text}\n{:#?}", others(&now));
            let Some(better) = sealed(&now).into_iter().find_map(|diagnostic| after_fix(&text, diagnostic))
            else {
                break;
            };
            let then = checked(&better);
            prop_assert!(sealed(&then).len() < sealed(&now).len(), "{text}\n{better}");
            text = better;
        }
        // The expanded program has blocks with one face at a time.
        if faces == 1 {
            apply_remedies(&text);
        }
    }
}

/// Follows the order of a diagnostic. Returns whether each event can happen in its turn and the
/// cell is closed at the end. Returns `None` if the diagnostic shows no order or only its start.
fn follow(checked: &Checked, diagnostic: &Diagnostic) -> Option<bool> {
    let program = &checked.programs[0];
    let plan = &program.plan;
    let help = diagnostic.help.as_deref()?;
    let order = (help.lines()).find_map(|line| line.strip_prefix("one order that blocks it: "))?;
    let target = diagnostic_event(program, diagnostic);
    let mut phases = plan.phases.iter();
    let phase = phases.find(|phase| phase.events.contains(&target))?;
    let cell = |id: EventId| program.layout.cells[id.0 as usize].unwrap();
    // The program has no releases.
    let mut full: BTreeMap<Cell, EventId> = (0..phase.events.start)
        .map(|id| (cell(EventId(id)), EventId(id)))
        .collect();
    let mut done: BTreeSet<EventId> = BTreeSet::new();
    for text in order.split(", ") {
        if text.starts_with("and ") {
            return None;
        }
        let mut events = phase.events.clone().map(EventId);
        let Some(id) = events.find(|&id| plan.describe(id, &checked.symbols) == text) else {
            return Some(false);
        };
        let is_ready = is_ready(&program.graph, id, |first| done.contains(&first));
        if id.0 == target || !is_ready || !is_open(SMALL, cell(id), &full) {
            return Some(false);
        }
        done.insert(id);
        full.insert(cell(id), id);
    }
    Some(!is_open(SMALL, cell(EventId(target)), &full))
}

/// Numbers of fixes of a program. They count changes of the source, advice to be written by hand,
/// diagnostics without a fix, and merged diagnostics with different fixes.
#[derive(Debug, Default)]
struct Remedies {
    changes: usize,
    written_out: usize,
    none: usize,
    several: usize,
    never: usize,
}

/// Applies every proposed fix and checks that the error disappears and no other error appears. If a
/// part of a fix is left out, the diagnostic must stay.
fn apply_remedies(text: &str) -> Remedies {
    let now = checked(text);
    let mut remedies = Remedies::default();
    for diagnostic in sealed(&now) {
        let help = diagnostic.help.as_deref().unwrap();
        if is_never(diagnostic) {
            remedies.never += 1;
            assert_eq!(diagnostic.fix, None, "{text}");
        } else if let Some(fix) = &diagnostic.fix {
            remedies.changes += 1;
            assert!(
                is_resolved(&now, &checked(&changed(text, fix)), diagnostic),
                "{text}\n{fix:?}"
            );
            for (i, edit) in fix.edits.iter().enumerate() {
                let at = edit.text.rfind(" after ").or_else(|| edit.text.rfind(", "));
                // The rest of a chain on a separate line does not wait.
                let Some(at) = at.filter(|_| !edit.text.contains('\n')) else {
                    continue;
                };
                let mut fewer = fix.clone();
                fewer.edits[i].text.truncate(at);
                let then = checked(&changed(text, &fewer));
                assert!(
                    !is_resolved(&now, &then, diagnostic),
                    "{text}\nneeds less than {fix:?}"
                );
            }
        } else if help.contains(" of its own") || help.contains(" of their own") {
            remedies.written_out += 1;
            let plain = written_out(&now, &BTreeMap::new());
            let waits: Vec<(&str, &str)> =
                (help.lines().find(|line| line.contains(" own")).unwrap())
                    .split('`')
                    .filter_map(|part| part.split_once(" after "))
                    .collect();
            for left_out in 0..=waits.len() {
                let mut added = BTreeMap::new();
                for (i, &(statement, name)) in waits.iter().enumerate() {
                    if i + 1 != left_out {
                        added.insert(statement.to_owned(), name.to_owned());
                    }
                }
                let then = checked(&written_out(&now, &added));
                let event = diagnostic_named(&now, diagnostic);
                let reported = |checked: &Checked| -> BTreeSet<u32> {
                    let of = |diagnostic: &&Diagnostic| {
                        diagnostic_event(&checked.programs[0], diagnostic)
                    };
                    sealed(checked).iter().map(of).collect()
                };
                let mut rest = reported(&checked(&plain));
                assert!(rest.remove(&event), "{text}\n{plain}");
                assert!(others(&then).is_empty(), "{text}\n{:#?}", others(&then));
                let resolved = !reported(&then).contains(&event);
                assert_eq!(resolved, left_out == 0, "{text}\n{help}");
                assert!(
                    !resolved || reported(&then).is_subset(&rest),
                    "{text}\n{help}"
                );
            }
        } else if diagnostic.others.count > 0 && help.starts_with("write `") {
            // Each capture of the statement has its own fix.
            remedies.several += 1;
        } else {
            remedies.none += 1;
            assert!(help.contains("leave an opening: no "), "{help}\n{text}");
        }
    }
    remedies
}

fn changed(text: &str, fix: &Fix) -> String {
    let mut change = TextChange::new(FileId(0), text);
    assert!(change.add(fix), "{fix:?}");
    change.text()
}

/// Returns whether all events of a diagnostic are resolved and no new diagnostics appear.
///
/// Diagnostics of one place are merged, so each event needs its own place here.
fn is_resolved(before: &Checked, after: &Checked, diagnostic: &Diagnostic) -> bool {
    if !others(after).is_empty() {
        return false;
    }
    let plain = |checked: &Checked| checked_plain(&written_out(checked, &BTreeMap::new()));
    let (then, now) = (plain(before), plain(after));
    let program = &before.programs[0];
    let first = diagnostic_named(before, diagnostic);
    let at_its_place = |reported: &BTreeSet<u32>| {
        let events = reported.iter().map(|&id| program.plan.event(EventId(id)));
        let here = events.filter(|event| event.location == diagnostic.labels[0].location);
        here.count()
    };
    !now.contains(&first)
        && now.is_subset(&then)
        && at_its_place(&now) + diagnostic.others.count < at_its_place(&then)
}

/// Returns the reported events of a program with one place per event.
fn checked_plain(text: &str) -> BTreeSet<u32> {
    let checked = checked(text);
    assert!(
        others(&checked).is_empty(),
        "{text}\n{:#?}",
        others(&checked)
    );
    let of = |diagnostic: &&Diagnostic| diagnostic_event(&checked.programs[0], diagnostic);
    sealed(&checked).iter().map(of).collect()
}

/// Returns the event that the title of a diagnostic names. One place of the source can stand for
/// many events.
fn diagnostic_named(checked: &Checked, diagnostic: &Diagnostic) -> u32 {
    let plan = &checked.programs[0].plan;
    let name = diagnostic.title.split('`').nth(1).unwrap();
    let is_it = |event: &ExpandedEvent| plan.roles.name(event.role, &checked.symbols) == name;
    plan.events.iter().position(is_it).unwrap() as u32
}

/// A fix cannot wait for a block of an unnamed instance. The instance has to be named first.
#[test]
fn a_remedy_that_waits_for_an_unnamed_instance_asks_for_its_name() {
    let text = "pattern cap(base, side) { base.up -> C.side -> D }
        assembly looped {
            seed plate 3 x 3 { for x in 0..2 { for y in 0..2 { B[x, y, 0] at (x, y) } } }
            phase p0 {
                for x in 0..2 { B[x, 0, 0].up -> B[x, 0, 1] }
                for x in 0..2 { B[x, 0, 1].up -> B[x, 0, 2] }
                B[2, 1, 0].up -> B[2, 1, 1]
                cap(B[0, 1, 0], east)
                for x in 0..2 { B[x, 2, 0].up -> B[x, 2, 1] }
                for x in 0..2 { B[x, 0, 2].north -> B[x, 1, 2] }
            }
        }";
    let remedies = apply_remedies(text);
    assert!(remedies.written_out > 0, "{remedies:?}");
    let now = checked(text);
    let asks =
        |it: &&Diagnostic| (it.help.as_deref()).is_some_and(|help| help.contains("... as a"));
    assert!(sealed(&now).iter().any(asks));
}

/// Returns a program event by event, without loops and patterns. `added` maps waiting events to the
/// events that they additionally wait for.
fn written_out(checked: &Checked, added: &BTreeMap<String, String>) -> String {
    let plan = &checked.programs[0].plan;
    let (width, depth) = (plan.plate.width, plan.plate.depth);
    let mut text = format!("assembly plain {{ seed plate {width} x {depth} {{\n");
    for seed in &plan.seeds {
        let _ = writeln!(
            text,
            "N{} at ({}, {})",
            seed.role.0, seed.cell.x, seed.cell.y
        );
    }
    text.push_str("}\n");
    for (number, phase) in plan.phases.iter().enumerate() {
        let _ = writeln!(text, "phase p{number} {{");
        for id in plan.events_of(phase) {
            let event = plan.event(id);
            match event.kind {
                EventKind::Capture { parent, face } => {
                    let _ = write!(text, "N{}.{face} -> N{}", parent.0, event.role.0);
                }
                EventKind::Release => {
                    let _ = write!(text, "release N{}", event.role.0);
                }
            }
            let afters = plan.afters.iter().filter(|after| after.event == id);
            let mut waits: Vec<String> = afters
                .map(|after| {
                    format!(
                        "{}N{}",
                        if after.release { "release " } else { "" },
                        after.role.0
                    )
                })
                .collect();
            if let Some(name) = added.get(&plan.describe(id, &checked.symbols)) {
                let is_it =
                    |event: &&ExpandedEvent| plan.roles.name(event.role, &checked.symbols) == *name;
                waits.push(format!(
                    "N{}",
                    plan.events.iter().find(is_it).unwrap().role.0
                ));
            }
            if !waits.is_empty() {
                let _ = write!(text, " after {}", waits.join(", "));
            }
            text.push('\n');
        }
        text.push_str("}\n");
    }
    text.push_str("}\n");
    text
}

/// Returns the captures of one row or layer of the grid, with loops if it has several blocks.
fn row_statement(
    (x0, x1): (i32, i32),
    (y0, y1): (i32, i32),
    z: i32,
    face: Face,
    after: &str,
) -> String {
    let index = |counter: char, range: (i32, i32), by: i32| match (range.0 == range.1, by) {
        (true, _) => (range.0 + by).to_string(),
        (false, 0) => counter.to_string(),
        (false, 1..) => format!("{counter} + {by}"),
        (false, _) => format!("{counter} - {}", -by),
    };
    let step = Cell::new(0, 0, 5).across(face).unwrap();
    let place = |by: Cell| {
        let (x, y) = (index('x', (x0, x1), by.x), index('y', (y0, y1), by.y));
        format!("B[{x}, {y}, {}]", z + by.z - 5)
    };
    let statement = format!(
        "{}.{face} -> {}{after}",
        place(Cell::new(0, 0, 5)),
        place(step)
    );
    let statement = if y0 == y1 {
        statement
    } else {
        format!("for y in {y0}..{y1} {{ {statement} }}")
    };
    if x0 == x1 {
        statement
    } else {
        format!("for x in {x0}..{x1} {{ {statement} }}")
    }
}

/// Returns a program of loops, rows and patterns over a grid. The name of a block is its cell.
fn looped(choices: &[u32]) -> String {
    const EDGE: i32 = 3;
    let mut choices = choices.iter();
    let mut choose = |most: usize| {
        let choice = choices.next().copied().unwrap_or(0);
        choice as usize % most.max(1)
    };
    let mut text = "pattern cap(base, side) { base.up -> C.side -> D }\n\
                    assembly looped {\n    seed plate 3 x 3 { for x in 0..2 { for y in 0..2 { B[x, y, 0] at (x, y) } } }\n"
        .to_owned();
    let mut full: BTreeSet<Cell> = (0..EDGE)
        .flat_map(|x| (0..EDGE).map(move |y| Cell::new(x, y, 0)))
        .collect();
    let mut caps: BTreeSet<Cell> = BTreeSet::new();
    for phase in 0..=choose(2) {
        let _ = writeln!(text, "    phase p{phase} {{");
        let mut names: Vec<String> = Vec::new();
        for _ in 0..20 + choose(30) {
            let after = match names.len() {
                0 => String::new(),
                _ if choose(5) > 0 => String::new(),
                count => format!(" after {}", names[choose(count)]),
            };
            let z = choose(3) as i32;
            // Sometimes the whole grid, usually one place.
            let mut corner = || match choose(if z == 0 { 2 } else { 5 }) {
                0 => (0, EDGE - 1),
                1 if z > 0 => {
                    let (a, b) = (choose(3) as i32, choose(3) as i32);
                    (a.min(b), a.max(b))
                }
                _ => [(0, 0), (1, 1), (2, 2)][choose(3)],
            };
            let ((x0, x1), (y0, y1)) = (corner(), corner());
            let face = match z {
                0 => Face::Up,
                // Sideways, to build lids.
                _ if choose(3) > 0 => Face::SIDES[choose(4)],
                _ => Face::Up,
            };
            let parents: Vec<Cell> = (x0..=x1)
                .flat_map(|x| (y0..=y1).map(move |y| Cell::new(x, y, z)))
                .collect();
            let children: BTreeSet<Cell> = parents
                .iter()
                .map(|cell| cell.across(face).unwrap())
                .collect();
            let fits = |cell: &Cell| {
                (0..EDGE).contains(&cell.x)
                    && (0..EDGE).contains(&cell.y)
                    && (1..=3).contains(&cell.z)
            };
            let is_there = |cell: &Cell| full.contains(cell) && !caps.contains(cell);
            // The middle is usually left to lids.
            let is_middle = |cell: &Cell| (cell.x, cell.y) == (1, 1) && cell.z > 0;
            if face == Face::Up && parents.iter().any(is_middle) && choose(8) > 0 {
                continue;
            }
            let is_right = parents.iter().all(is_there)
                && children
                    .iter()
                    .all(|cell| fits(cell) && !full.contains(cell))
                && parents.iter().all(|cell| !children.contains(cell));
            if !is_right {
                continue;
            }
            let side = Face::SIDES[choose(4)];
            let end = children.iter().next().unwrap().across(side).unwrap();
            if parents.len() == 1
                && face == Face::Up
                && choose(3) == 0
                && fits(&end)
                && !full.contains(&end)
            {
                let alias = match choose(2) {
                    0 => String::new(),
                    _ => format!(" as c[{x0}, {y0}, {z}]"),
                };
                let _ = writeln!(text, "        cap(B[{x0}, {y0}, {z}], {side}){alias}");
                caps.extend(children.iter().copied().chain([end]));
                full.extend(children.iter().copied().chain([end]));
                continue;
            }
            names.extend(
                children
                    .iter()
                    .map(|cell| format!("B[{}, {}, {}]", cell.x, cell.y, cell.z)),
            );
            full.extend(&children);
            let statement = row_statement((x0, x1), (y0, y1), z, face, &after);
            let _ = writeln!(text, "        {statement}");
        }
        text.push_str("    }\n");
    }
    text.push_str("}\n");
    text
}

/// Checks that random programs with choices of faces have cavities: shown orders, `never`, and open
/// cases.
#[test]
fn many_random_programs_with_choices_have_cavities() {
    let mut draws = 1u64;
    let mut next = || {
        draws = draws
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (draws >> 33) as u32
    };
    let (mut shown, mut never, mut open) = (0, 0, 0);
    for _ in 0..400 {
        let choices: Vec<u32> = (0..100).map(|_| next()).collect();
        let checked = checked(&with_faces(&program(&choices, SMALL, false), 2));
        if !stochc_compiler::face_turns::has_choice(&checked.programs[0].graph) {
            continue;
        }
        for diagnostic in sealed(&checked) {
            shown += usize::from(follow(&checked, diagnostic).is_some());
            never += usize::from(is_never(diagnostic));
            open += usize::from(diagnostic.title.contains(" may become "));
        }
    }
    println!("of 400 programs with choices: {shown} orders shown, {never} never, {open} left open");
    assert!(
        shown > 10 && never > 0 && open < shown,
        "{shown} {never} {open}"
    );
}

/// Checks that the generator makes cavities. Otherwise the properties above would be trivial.
#[test]
fn many_random_programs_have_cavities() {
    let mut draws = 1u64;
    let mut next = || {
        draws = draws
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (draws >> 33) as u32
    };
    let mut counts = [0; 4];
    for _ in 0..400 {
        let choices: Vec<u32> = (0..100).map(|_| next()).collect();
        for (i, releases) in [false, true].into_iter().enumerate() {
            let checked = checked(&program(&choices, SMALL, releases));
            counts[i] += usize::from(!sealed(&checked).is_empty());
            counts[2 + i] += usize::from(can_get_stuck(&checked.programs[0]));
        }
    }
    println!(
        "of 400 programs: sealed {}, with releases {}; stuck {}, with releases {}",
        counts[0], counts[1], counts[2], counts[3]
    );
    let caves = (0..100).filter(|_| {
        let choices: Vec<u32> = (0..500).map(|_| next()).collect();
        !sealed(&checked(&program(&choices, LARGE, false))).is_empty()
    });
    let caves = caves.count();
    println!("of 100 large programs: sealed {caves}");
    assert!(caves > 10 && caves < 90, "{caves}");
    assert!(counts[2] > 40 && counts[3] > 20, "{counts:?}");
}

/// Checks that looped programs have cavities, and that all kinds of fixes occur.
#[test]
fn many_looped_programs_have_cavities() {
    let mut draws = 1u64;
    let mut next = || {
        draws = draws
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (draws >> 33) as u32
    };
    let mut all = Remedies::default();
    for _ in 0..1500 {
        let choices: Vec<u32> = (0..400).map(|_| next()).collect();
        let text = looped(&choices);
        assert!(
            others(&checked(&text)).is_empty(),
            "{text}\n{:#?}",
            others(&checked(&text))
        );
        let remedies = apply_remedies(&text);
        all.changes += remedies.changes;
        all.written_out += remedies.written_out;
        all.none += remedies.none;
        all.several += remedies.several;
        all.never += remedies.never;
    }
    println!("of 1500 programs with loops and patterns: {all:?}");
    assert!(all.changes > 30 && all.written_out > 10, "{all:?}");
}

/// Returns a hall with a separate tower inside. The door is as high as the wall.
fn hall(edge: i32, door: bool, inner_first: bool) -> String {
    let last = edge - 1;
    let middle = edge / 2;
    let mut text = format!(
        "scene wide from hemisphere {{ free 5000000 uniform enclosure hemisphere {{ radius 2000m wall 25 N/m }} }}\n\
         assembly hall in wide {{ seed plate {edge} x {edge} {{\n\
         for i in 0..{last} {{ R[i, 0] at (i, 0) R[i, {last}] at (i, {last}) }}\n\
         for i in 1..{} {{ R[0, i] at (0, i) R[{last}, i] at ({last}, i) }}\n\
         M at ({middle}, {middle}) }}\n",
        last - 1
    );
    let tower = "phase tower { M.up ->> T[1..2] }\n";
    if inner_first {
        text.push_str(tower);
    }
    text.push_str("phase shell {\n");
    let border: BTreeSet<(i32, i32)> = (0..edge)
        .flat_map(|i| [(i, 0), (i, last), (0, i), (last, i)])
        .filter(|&at| !(door && at == (middle, 0)))
        .collect();
    for (x, y) in border {
        let _ = writeln!(text, "R[{x}, {y}].up ->> W[1..4, {x}, {y}]");
    }
    for y in 1..last {
        let _ = writeln!(text, "W[4, 0, {y}].east ->> L[1..{}, {y}]", last - 1);
    }
    if door {
        let _ = writeln!(text, "W[4, {}, 0].east -> L[0, 0]", middle - 1);
    }
    text.push_str("}\n");
    if !inner_first {
        text.push_str(tower);
    }
    text.push_str("}\n");
    text
}

#[test]
fn halls_are_reached_only_through_doors() {
    for (edge, door, inner_first, expected) in [
        (7, false, true, 0),
        (7, true, true, 0),
        (7, true, false, 0),
        (7, false, false, 1),
        (60, true, false, 0),
        (60, false, false, 1),
    ] {
        let checked = checked(&hall(edge, door, inner_first));
        assert!(others(&checked).is_empty(), "{:#?}", others(&checked));
        let found = sealed(&checked).len();
        assert_eq!(
            found.min(1),
            expected,
            "edge {edge}, door {door}, inner first {inner_first}"
        );
    }
}

/// Hall in one phase. The roof waits for its walls, the pillars do not wait, and the lamps wait for
/// the roof.
const LAMPS: &str = "\
assembly hall {
    seed plate 7 x 7 {
        for i in 0..6 { R[i, 0] at (i, 0) R[i, 6] at (i, 6) }
        for i in 1..5 { R[0, i] at (0, i) R[6, i] at (6, i) }
        for x in 1..5 { for y in 1..5 { M[x, y] at (x, y) } }
    }
    phase all {
        for i in 0..6 { R[i, 0].up ->> W[i, 0, 1..5] R[i, 6].up ->> W[i, 6, 1..5] }
        for i in 1..5 { R[0, i].up ->> W[0, i, 1..5] R[6, i].up ->> W[6, i, 1..5] }
        for y in 1..5 { W[0, y, 5].east ->> L[1..5, y] after W[0..6, 0, 5], W[0..6, 6, 5], W[6, 1..5, 5] }
        for x in 1..5 { for y in 1..5 { M[x, y].up ->> T[x, y, 1..3] } }
        L[2, 2].down -> H[1].east -> H[2].east -> H[3].north -> H[4].north -> H[5].west -> H[6].west -> H[7].south -> H[8]
            after L[1..5, 1..5]
    }
}
";

#[test]
fn in_a_roofed_hall_only_hanging_blocks_are_never_reached() {
    let checked = checked(LAMPS);
    assert!(others(&checked).is_empty(), "{:#?}", others(&checked));
    let never: BTreeSet<&str> = (sealed(&checked).into_iter())
        .filter(|diagnostic| is_never(diagnostic))
        .map(|diagnostic| diagnostic.title.split('`').nth(1).unwrap())
        .collect();
    let lamps = (1..=8).map(|i| format!("H[{i}]"));
    assert!(never.into_iter().eq(lamps), "{:#?}", sealed(&checked));
    // The blocks of the pillars can enter until the roof is closed.
    let mut pillars = sealed(&checked);
    pillars.retain(|diagnostic| !is_never(diagnostic));
    assert_eq!(sealed_captures(&pillars), 75);
    for diagnostic in pillars {
        assert!(diagnostic.title.ends_with("can become unreachable"));
    }
    let first = sealed(&checked)[0];
    // Each capture of the statement has its own fix. The first one is shown, without a change for
    // all.
    assert_eq!(first.fix, None);
    let (late, wait) = ("R[0, i].up ->> W[0, i, 1..5]", "after T[i, i, 1]");
    let remedy = format!("write `{late} {wait}`\n");
    assert!(
        first.help.as_deref().unwrap().contains(&remedy),
        "{first:#?}"
    );
    let then = self::checked(&LAMPS.replace(late, &format!("{late} {wait}")));
    assert!(others(&then).is_empty(), "{:#?}", others(&then));
    let plain = |checked: &Checked| checked_plain(&written_out(checked, &BTreeMap::new()));
    let mut rest = plain(&checked);
    assert!(rest.remove(&diagnostic_named(&checked, first)));
    assert!(plain(&then).is_subset(&rest));
}

#[test]
fn a_fix_is_safe_with_a_narrow_access_path() {
    let text = "\
assembly well {
    seed plate 3 x 3 { W at (0, 1) E at (2, 1) S at (1, 0) N at (1, 2) M at (1, 1) }
    phase all {
        W.up -> W1 E.up -> E1 S.up -> S1 N.up -> N1
        M.up -> CORE
        W1.up -> W2.east -> LID
    }
}
";
    let now = checked(text);
    let fix = sealed(&now)[0].fix.as_ref().unwrap();
    assert!(fix.safe, "{fix:#?}");
    let then = checked(&changed(text, fix));
    let codes: Vec<Code> = then
        .diagnostics
        .iter()
        .map(|diagnostic| diagnostic.code)
        .collect();
    assert_eq!(codes, [Code::CrowdedCaptures, Code::TightApproach]);
}

/// Returns the titles of diagnostics about simultaneous captures, for an assembly on a plate of 3 x
/// 3. The names of the seeds are their positions.
fn crowded(phase: &str) -> Vec<String> {
    let mut seeds = String::new();
    for (x, y) in (0..3).flat_map(|x| (0..3).map(move |y| (x, y))) {
        let _ = write!(seeds, "M[{x}, {y}] at ({x}, {y}) ");
    }
    let text = format!(
        "allow unused-seed \"blocks of the plate have names by their places\"\nassembly all {{ seed plate 3 x 3 {{ {seeds}}} {phase} }}"
    );
    let found = checked(&text);
    assert!(!found.has_errors(), "{:#?}", found.diagnostics);
    let of_crowds = found.diagnostics.into_iter();
    let of_crowds = of_crowds.filter(|it| it.code == Code::CrowdedCaptures);
    of_crowds.map(|it| it.title).collect()
}

#[test]
fn three_open_faces_of_a_square_are_reported() {
    let foot = |x: i32, y: i32| format!("M[{x}, {y}].up -> A[{x}, {y}] ");
    let grow = |feet: &str| format!("phase grow {{ {feet} }}");
    let corner = foot(0, 0) + &foot(1, 0) + &foot(0, 1);
    assert_eq!(
        crowded(&grow(&corner)),
        ["the blocks for `A[0, 0]`, `A[1, 0]` and `A[0, 1]` may jam each other"]
    );
    // The same without the cell that would be the lowest of its square.
    let other = foot(1, 0) + &foot(0, 1) + &foot(1, 1);
    assert_eq!(crowded(&grow(&other)).len(), 1);
    // A row, a diagonal and two captures cause no warning.
    for few in [
        foot(0, 0) + &foot(1, 0) + &foot(2, 0),
        foot(0, 0) + &foot(1, 1) + &foot(2, 2),
        foot(0, 0) + &foot(1, 0) + &foot(0, 2),
    ] {
        assert_eq!(crowded(&grow(&few)), [""; 0], "{few}");
    }
    // Three captures do not warn if one waits, by `after`, in a chain or for its phase.
    let waits = foot(0, 0) + &foot(1, 0) + "M[0, 1].up -> A[0, 1] after A[1, 0]";
    assert_eq!(crowded(&grow(&waits)), [""; 0]);
    let chain = foot(0, 0) + "A[0, 0].up -> B " + "B.east -> C " + "M[1, 0].up -> D after B";
    assert_eq!(crowded(&grow(&chain)), [""; 0]);
    let phases = grow(&(foot(0, 0) + &foot(1, 0))) + &format!("phase later {{ {} }}", foot(0, 1));
    assert_eq!(crowded(&phases), [""; 0]);
}

/// Two wells with separately written walls. One loop captures the core of each.
#[test]
fn iterations_that_need_different_fixes_are_listed() {
    let wells = |count: i32| {
        let well = |k: i32| {
            let (west, east) = (4 * k, 4 * k + 2);
            format!(
                "M[{west}, 1].up -> W[{k}].up -> V[{k}].east -> LID[{k}] M[{east}, 1].up -> E[{k}]
                 M[{0}, 0].up -> S[{k}] M[{0}, 2].up -> N[{k}]\n",
                west + 1
            )
        };
        format!(
            "assembly wells {{ seed plate {width} x 3 {{ for i in 0..{width} - 1 {{ for j in 0..2 {{ M[i, j] at (i, j) }} }} }}
             phase p {{ for k in 0..{last} {{ M[4 * k + 1, 1].up -> CORE[k] }}\n{} }} }}",
            (0..count).map(well).collect::<String>(),
            width = 4 * count,
            last = count - 1,
        )
    };
    let help = |text: &str| {
        let now = checked(text);
        let found = sealed(&now);
        assert_eq!(found.len(), 1, "{found:#?}");
        assert_eq!(found[0].fix, None, "it would fix one of them");
        found[0].help.clone().unwrap()
    };
    let remedy = |k: i32| {
        let east = 4 * k + 2;
        format!("write `M[{east}, 1].up -> E[{k}] after CORE[{k}]`\n")
    };
    let two = help(&wells(2));
    let reported = format!("{}for `CORE[1]`, {}", remedy(0), remedy(1));
    assert!(two.contains(&reported), "{two}");
    let four = help(&wells(4));
    let reported = format!(
        "{reported}for `CORE[2]`, {}others need changes of their own\n",
        remedy(2)
    );
    assert!(four.contains(&reported), "{four}");
    // The reported fix works.
    let resolved = |text: String, k: i32| {
        let wall = format!("M[{}, 1].up -> E[{k}]", 4 * k + 2);
        text.replace(&wall, &format!("{wall} after CORE[{k}]"))
    };
    assert!(sealed(&checked(&(0..2).fold(wells(2), resolved))).is_empty());
}

/// Grid whose core and one wall are captured by the same statement. An `after` there would be a
/// cycle.
const GRID: &str = "\
assembly grid {
    seed plate 3 x 3 { for x in 0..2 { for y in 0..2 { M[x, y] at (x, y) } } }
    phase all {
        for x in 0..2 { for y in 0..2 { M[x, y].up -> W[x, y] } }
        W[0, 1].up -> V.east -> LID
    }
}
";

#[test]
fn waits_that_a_loop_cannot_express_are_fixed_elsewhere() {
    let now = checked(GRID);
    let found = sealed(&now);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(
        found[0]
            .title
            .starts_with("`W[1, 1]` can become unreachable")
    );
    let help = found[0].help.as_deref().unwrap();
    assert!(
        help.contains("write `V.east -> LID after W[1, 1]`"),
        "{help}"
    );
    assert_eq!(apply_remedies(GRID).changes, 1);
}

#[test]
fn a_separate_statement_is_the_last_resort() {
    let text = GRID.replace(
        "        W[0, 1].up -> V.east -> LID\n",
        "        for x in 0..2 { W[x, 0].up -> V[x] } V[1].north -> LID.north -> END\n",
    );
    let one = text.replace("W[x, y] } }", "W[x, y] } }\n").replace(
        "for x in 0..2 { W[x, 0].up -> V[x] } V[1].north -> LID.north -> END",
        "for y in 0..1 { W[0, y].up -> V[0, y] } for y in 0..1 { V[0, y].east -> V[1, y] } for x in 0..1 { V[x, 1].up -> E[x] }",
    );
    for text in [text, one] {
        let now = checked(&text);
        assert_eq!(sealed(&now).len(), 1, "{text}\n{:#?}", now.diagnostics);
        let remedies = apply_remedies(&text);
        assert_eq!(
            remedies.changes + remedies.written_out,
            1,
            "{text}\n{:#?}",
            now.diagnostics
        );
    }
}

#[test]
fn loop_counters_name_the_wait_of_each_iteration() {
    let text = "\
assembly wells {
    seed plate 12 x 3 {
        for i in 0..3 { W[i] at (3 * i, 1) E[i] at (3 * i + 2, 1) S[i] at (3 * i + 1, 0) N[i] at (3 * i + 1, 2) M[i] at (3 * i + 1, 1) }
    }
    phase all {
        for i in 0..3 { S[i].up -> S1[i] N[i].up -> N1[i] E[i].up -> E1[i] }
        for i in 0..3 { M[i].up -> CORE[i] }
        for i in 0..3 { W[i].up -> W1[i].up -> W2[i].east -> LID[i] }
    }
}
";
    let now = checked(text);
    assert_eq!(sealed_captures(&sealed(&now)), 4, "{:#?}", now.diagnostics);
    let fix = sealed(&now)[0].fix.as_ref().unwrap();
    assert!(fix.title.contains("CORE[i]"), "{fix:#?}");
    assert!(sealed(&checked(&changed(text, fix))).is_empty());
    apply_remedies(text);
}

/// Two pockets. Each is closed by the block that has to dock before the core of the other one.
#[test]
fn two_mutually_closing_cells_are_not_never_reached() {
    let pocket = |x: i32| {
        let (middle, end) = (x + 1, x + 2);
        format!(
            "W[{x}] at ({x}, 1) E[{x}] at ({end}, 1) S[{x}] at ({middle}, 0) N[{x}] at ({middle}, 2) M[{x}] at ({middle}, 1)"
        )
    };
    let text = format!(
        "assembly both {{ seed plate 7 x 3 {{ {} {} }}
         phase walls {{ for i in 0..1 {{ W[4 * i].up -> A[i].up -> B[i] E[4 * i].up -> C[i] S[4 * i].up -> D[i] N[4 * i].up -> F[i] }} }}
         phase lids {{
             for i in 0..1 {{ B[i].east -> LID[i] M[4 * i].up -> CORE[i] after LID[1 - i] }}
             LID[0].up -> TOP after CORE[0], CORE[1]
         }} }}",
        pocket(0),
        pocket(4),
    );
    let now = checked(&text);
    assert!(others(&now).is_empty(), "{:#?}", others(&now));
    let found = sealed(&now);
    assert_eq!(sealed_captures(&found), 2, "{found:#?}");
    for diagnostic in found {
        assert!(
            diagnostic.title.contains("can become unreachable"),
            "{diagnostic:#?}"
        );
        let help = diagnostic.help.as_deref().unwrap();
        assert!(
            help.contains("no order of the phase reaches all of its cells"),
            "{help}"
        );
        assert_eq!(diagnostic.fix, None);
    }
    assert_eq!(
        all_orders(&now.programs[0]).reached.len(),
        now.programs[0].plan.events.len() - 1
    );
}

/// The middle of a beam has no wide path. A block that is handed over needs none if it is captured
/// at once.
#[test]
fn handed_over_blocks_stay_in_place() {
    let codes = |hand_over: &str| {
        let text = format!(
            "assembly beam in hemisphere_soft {{
                allow soft-contact \"its walls are soft\"
                allow coarse-step \"it is not simulated\"
                seed plate 3 x 1 {{ A at (0, 0)   B at (2, 0) }}
                phase grow {{
                    A.up ->> T[1..2].east -> X
                    B.up -> U[1]
                    U[1].up -> U[2] after X
                }}
                phase hand_over {{ {hand_over} }}
            }}"
        );
        let found = checked(&text).diagnostics;
        found.iter().map(|it| it.code.name()).collect::<Vec<_>>()
    };
    let none: [&str; 0] = [];
    assert_eq!(codes("release X   U[2].west -> Y"), none);
    assert_eq!(codes("release X   U[2].west -> X"), none);
    assert_eq!(
        codes("T[2].up -> Z   release X after Z   U[2].west -> Y after Z"),
        none
    );
    // Another block may have moved in between.
    assert_eq!(
        codes("T[2].up -> Z   release X   U[2].west -> Y after Z"),
        ["tight-approach"]
    );
    assert_eq!(
        codes("U[2].up -> Z   release X   U[2].west -> Y"),
        ["tight-approach"]
    );
    assert_eq!(codes("release X   U[2].west -> Y   U[2].up -> Z"), none);
}

/// The rule applies only to scenes with such rates, and only along the normal of the face.
#[test]
fn the_default_scene_passes_gaps_ahead_of_a_face() {
    let codes = |scene: &str, walls: &str, capture: &str| {
        let text = format!(
            "assembly beam in {scene} {{
                seed plate 3 x 3 {{
                    A at (0, 1)   B at (2, 1)   M at (1, 1)   N at (1, 2)   S at (1, 0)
                }}
                phase grow {{ A.up ->> T[1..2]   B.up ->> U[1..2]   {walls} }}
                phase close {{ {capture} }}
            }}"
        );
        let found = checked(&text).diagnostics;
        let of_x = found.iter().filter(|it| it.title.contains("`X`"));
        of_x.map(|it| it.code.name()).collect::<Vec<_>>()
    };
    let none: [&str; 0] = [];
    let tight = ["tight-approach"];
    let close = "T[2].east -> X";
    assert_eq!(codes("hemisphere", "", close), none);
    assert_eq!(codes("hemisphere_soft", "", close), tight);
    assert_eq!(codes("hemisphere_2005", "", close), tight);
    // The gap is on a floor, or next to a wall.
    assert_eq!(codes("hemisphere", "M.up -> F", close), tight);
    let wall = "N.up ->> V[1..2]";
    assert_eq!(codes("hemisphere", wall, close), tight);
    assert_eq!(codes("hemisphere", "N.up -> V[1]", close), none);
    // The gap is perpendicular to the normal of the face.
    assert_eq!(codes("hemisphere", "", "M.up -> X"), tight);
    assert_eq!(codes("hemisphere", wall, "M.up -> X"), tight);
}
