//! The proof that every cell stays within reach, against a search through every order of events.
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fmt::Write as _;

use petgraph::graph::NodeIndex;
use proptest::prelude::*;
use stochc_compiler::finding::{Code, Finding, mended};
use stochc_compiler::plan::{Deed, EventId};
use stochc_compiler::turns::is_ready;
use stochc_compiler::{Cell, Checked, Face, FileId, Program, check};

/// Cells of the box in which random programs build.
#[derive(Clone, Copy)]
struct Room {
    edge: i32,
    height: i32,
    captures: usize,
    phases: usize,
}

/// Small enough for a search through every order.
const SMALL: Room = Room {
    edge: 3,
    height: 3,
    captures: 4,
    phases: 2,
};
/// Large enough for caves.
const LARGE: Room = Room {
    edge: 6,
    height: 4,
    captures: 20,
    phases: 4,
};

fn checked(text: &str) -> Checked {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    check("random.sa", &mut reader, Default::default())
}

/// The same program for blocks that magnetize several faces at a time.
fn with_faces(text: &str, faces: u8) -> String {
    let scene = format!(
        "scene s from hemisphere {{ block cube {{ side 20cm mass 1kg faces {faces} }} }}\n"
    );
    scene + &text.replacen("assembly random {", "assembly random in s {", 1)
}

/// Whether a cell closes in one of the two in the middle.
fn is_wall(room: Room, cell: Cell) -> bool {
    if room.edge != 3 {
        // A box inside the box.
        let border = |at: i32, far: i32| at == 1 || at == far;
        return border(cell.x, room.edge - 2)
            || border(cell.y, room.edge - 2)
            || cell.z == room.height;
    }
    let sides = (cell.x - 1).abs() + (cell.y - 1).abs();
    sides == 1 && cell.z < room.height || sides == 0 && cell.z == room.height
}

/// A program in a box of 3 x 3 x 3 cells; each number is one choice.
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
            // Walls first, so that they close now and then.
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

/// Whether a block can come from outside to a cell.
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

/// The captures of a phase that are left over where it comes to a stand, in any order.
fn stuck(
    program: &Program,
    events: std::ops::Range<u32>,
    start: &BTreeMap<Cell, EventId>,
) -> Option<Vec<EventId>> {
    let mut seen: HashSet<u32> = HashSet::new();
    let mut open = vec![0u32];
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
            if program.plan.event(id).deed == Deed::Release {
                let on = program.layout.parents[id.0 as usize].unwrap();
                let cell = program.layout.cells[id.0 as usize].unwrap();
                if full.get(&cell) == Some(&on.capture) {
                    full.remove(&cell);
                }
            }
        }
        for id in happened() {
            if program.plan.event(id).deed != Deed::Release {
                full.insert(program.layout.cells[id.0 as usize].unwrap(), id);
            }
        }
        let mut moved = false;
        let mut left = Vec::new();
        for id in events
            .clone()
            .map(EventId)
            .filter(|&id| done & bit(id) == 0)
        {
            left.push(id);
            let waits = !is_ready(&program.graph, id, |first| done & bit(first) != 0);
            let cell = program.layout.cells[id.0 as usize].unwrap();
            let is_release = program.plan.event(id).deed == Deed::Release;
            if !waits && (is_release || is_open(SMALL, cell, &full)) {
                moved = true;
                if seen.insert(done | bit(id)) {
                    open.push(done | bit(id));
                }
            }
        }
        if !moved && !left.is_empty() {
            return Some(left);
        }
    }
    None
}

/// The verdict of the search for every phase together.
fn can_get_stuck(program: &Program) -> bool {
    let mut full: BTreeMap<Cell, EventId> = BTreeMap::new();
    let mut result = false;
    for (phase, (emptied, _)) in program.plan.phases.iter().zip(&program.layout.changes) {
        result |= stuck(program, phase.events.clone(), &full).is_some();
        for cell in emptied {
            full.remove(cell);
        }
        for id in phase.events.clone().map(EventId) {
            if program.plan.event(id).deed != Deed::Release {
                full.insert(program.layout.cells[id.0 as usize].unwrap(), id);
            }
        }
    }
    result
}

/// Every capture with its phase and the cells that are full in its worst case, word by word.
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

/// Whether a capture without a way out in its worst case exists.
fn has_sealed_capture(room: Room, program: &Program) -> bool {
    worst_cases(program)
        .into_iter()
        .any(|(_, id, worst)| !is_open(room, program.layout.cells[id.0 as usize].unwrap(), &worst))
}

/// Whether a cube of two cells can bring a block to a cell from outside.
fn is_wide(room: Room, target: Cell, full: &BTreeMap<Cell, EventId>) -> bool {
    let cells = |low: Cell| {
        (0..8).map(move |i| Cell::new(low.x + (i & 1), low.y + (i >> 1 & 1), low.z + (i >> 2)))
    };
    let is_free = |low: Cell| low.z >= 1 && cells(low).all(|cell| !full.contains_key(&cell));
    let mut open: Vec<Cell> = cells(Cell::new(target.x - 1, target.y - 1, target.z - 1))
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

fn sealed(checked: &Checked) -> Vec<&Finding> {
    (checked.findings.iter())
        .filter(|finding| finding.code == Code::SealedCavity)
        .collect()
}

/// The event that a finding speaks of first.
fn finding_event(program: &Program, finding: &Finding) -> u32 {
    let site = finding.labels[0].site;
    (program.plan.events.iter())
        .position(|event| event.site == site)
        .unwrap() as u32
}

/// The text after a fix.
fn after_fix(text: &str, finding: &Finding) -> Option<String> {
    Some(mended(text, FileId(0), [finding.fix.as_ref()?]).0)
}

fn others(checked: &Checked) -> Vec<&Finding> {
    (checked.findings.iter())
        .filter(|finding| finding.is_error() && finding.code != Code::SealedCavity)
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

    /// Of the captures of one block any may be the one that leaves it a face.
    #[test]
    fn choices_of_faces_change_nothing_of_that(
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
    fn caves_are_searched_to_their_ends(
        choices in prop::collection::vec(any::<u32>(), 200..500),
    ) {
        let text = program(&choices, LARGE, false);
        let checked = checked(&text);
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
                    !is_wide(LARGE, program.layout.cells[id.0 as usize].unwrap(), worst)
                })
                .map(|(_, id, _)| id)
                .collect();
            let told = (checked.findings.iter())
                .filter(|finding| finding.code == Code::TightApproach)
                .find(|finding| phase.events.contains(&finding_event(program, finding)))
                .map(|finding| finding.title.split(' ').next().unwrap().parse().unwrap_or(1));
            prop_assert_eq!(told.unwrap_or(0), tight.len(), "phase {}\n{}", number, text);
        }
    }

    #[test]
    fn with_releases_nothing_is_passed_over(
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
    fn cures_cure(choices in prop::collection::vec(any::<u32>(), 10..120)) {
        let mut text = program(&choices, SMALL, false);
        // Each fix cures its own capture; the others follow, one at a time.
        for _ in 0..20 {
            let now = checked(&text);
            prop_assert!(others(&now).is_empty(), "{text}\n{:#?}", others(&now));
            let Some(better) = sealed(&now).into_iter().find_map(|finding| after_fix(&text, finding))
            else {
                break;
            };
            let then = checked(&better);
            prop_assert!(sealed(&then).len() < sealed(&now).len(), "{text}\n{better}");
            text = better;
        }
    }
}

/// The generator has to make cavities, or the properties above say nothing.
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

/// A hall with a tower inside that touches no wall; the door is as high as the wall.
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
fn halls_are_open_by_their_doors_alone() {
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
