//! Programs and scenes of planar worlds.
use std::collections::BTreeSet;
use std::fmt::Write as _;

use proptest::prelude::*;
use stochc_compiler::diagnostic::Code;
use stochc_ir::scene::{Extent, PlanarAccess, PlanarArea, Scene};
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};

use crate::{checked, with_code};

const SCENE: &str = "scene table from hemisphere { world planar free 90 uniform \
    enclosure disc { radius 5m wall 250 N/m } }\n";

fn program(phases: &str) -> String {
    format!("{SCENE}assembly a in table {{ seed plate 5 x 5 {{ M at (0, 0) }} {phases} }}")
}

/// A seed captures with its sides. All blocks are in its layer.
#[test]
fn blocks_of_a_plane_are_in_the_layer_of_the_seeds() {
    let checked = checked(&program(
        "phase p { M.north ->> N[1..2]  M.east -> E.south -> S }",
    ));
    assert_eq!(checked.diagnostics, []);
    let program = &checked.programs[0];
    let cells: Vec<Cell> = program
        .layout
        .cells
        .iter()
        .map(|cell| cell.unwrap())
        .collect();
    let expected = [(0, 1), (0, 2), (1, 0), (1, -1)];
    assert_eq!(cells, expected.map(|(x, y)| Cell::new(x, y, 1)));
    let tables = program.tables.as_ref().unwrap();
    let seeds: Vec<Cell> = tables.seeds().map(|(_, cell)| cell).collect();
    assert_eq!(seeds, [Cell::new(0, 0, 1)]);
    let scene = program.scene.as_ref().unwrap();
    assert_eq!(tables.validate_in(scene), Ok(()));
    // Files may combine other tables with the scene.
    let mut other = scene.clone();
    other.planar = None;
    assert!(tables.validate_in(&other).is_err());
}

#[test]
fn no_block_captures_out_of_the_plane() {
    for face in ["up", "down"] {
        let checked = checked(&program(&format!("phase p {{ M.east -> E.{face} -> T }}")));
        let found = with_code(&checked, Code::OutOfPlane);
        assert_eq!(found.len(), 1, "{:?}", checked.diagnostics);
        let title = format!("`E.{face}` points out of the plane of scene `table`");
        assert_eq!(found[0].title, title);
        assert!(found[0].help.as_deref().unwrap().contains("`E.north`"));
    }
}

/// Checks that blocks around a cell close it, although it is open to the sky.
#[test]
fn a_ring_closes_the_cell_inside() {
    let ring = "M.north -> A.north -> B.east -> C.east -> D.south -> E.south -> F";
    let closed = format!("phase p {{ {ring}.west -> G }} phase q {{ A.east -> CORE }}");
    let found = checked(&program(&closed));
    assert_eq!(with_code(&found, Code::SealedCavity).len(), 1, "{found:?}");
    let open = format!("phase p {{ {ring} }} phase q {{ A.east -> CORE }}");
    let found = checked(&program(&open));
    assert_eq!(with_code(&found, Code::SealedCavity), [] as [&_; 0]);
    assert_eq!(with_code(&found, Code::TightApproach).len(), 1);
    // The seed is one of the walls.
    let corner = "phase p { M.north -> A.north -> B.east -> C.east -> D.south -> E.south -> F.west -> G \
        A.east -> CORE after G }";
    let found = checked(&program(corner));
    assert_eq!(with_code(&found, Code::SealedCavity).len(), 1);
}

#[test]
fn a_capture_on_a_seed_is_rejected() {
    let text = "assembly a in table { seed plate 5 x 5 { M at (0, 0) N at (1, 0) } phase p { M.east -> A } }";
    let found = checked(&format!("{SCENE}{text}"));
    assert_eq!(with_code(&found, Code::OccupiedCell).len(), 1);
}

#[test]
fn a_structure_must_lie_inside_a_disc_or_a_rectangle() {
    let flat = "rectangle { length 1.4m  width 1m  wall 25 N/m }";
    for (enclosure, expected) in [
        (
            "disc { radius 1.2m  wall 25 N/m }",
            "reaches 1.30 m from the axis, the radius is 1.20 m",
        ),
        (
            flat,
            "reaches 0.70 m from the middle, half of the width is 0.50 m",
        ),
    ] {
        let text = |count: u32| {
            format!(
                "scene w from hemisphere {{ world planar free 9 uniform enclosure {enclosure} }}
                assembly a in w {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.north ->> T[1..{count}] }} }}"
            )
        };
        let count = if enclosure == flat { 3 } else { 6 };
        let found = checked(&text(count));
        let outside = with_code(&found, Code::OutsideEnclosure);
        assert!(outside[0].labels[0].text.contains(expected), "{outside:?}");
        assert_eq!(
            with_code(&checked(&text(count - 1)), Code::OutsideEnclosure),
            [] as [&_; 0]
        );
    }
}

/// Checks the terms that a planar world needs, and those that it rejects.
#[test]
fn scenes_of_planar_worlds_are_consistent() {
    let title = |clauses: &str| {
        let found = checked(&format!("scene s from hemisphere {{ {clauses} }}"));
        let errors = found.diagnostics.iter().filter(|it| it.is_error());
        errors.map(|it| it.title.clone()).collect::<Vec<_>>()
    };
    let disc = "enclosure disc { radius 5m wall 25 N/m }";
    let none: [String; 0] = [];
    assert_eq!(title(&format!("world planar {disc}")), none);
    assert_eq!(
        title(&format!(
            "world planar friction 0.1 gravity 9.81 m/s^2 {disc}"
        )),
        none
    );
    for (clauses, expected) in [
        (
            format!("world planar friction 0.1 {disc}"),
            "friction with the table needs gravity",
        ),
        (
            "world planar".to_owned(),
            "a planar world needs a flat enclosure",
        ),
        (disc.to_owned(), "a flat enclosure needs a planar world"),
        (
            format!(
                "world planar {disc} bond reject {{ hold 2 N depth 2cm within 15cm impulse 0.1 N s anchor centres 5mm }}"
            ),
            "this bond is not supported in a planar world",
        ),
    ] {
        assert_eq!(title(&clauses), [expected], "{clauses}");
    }
}

/// Returns a planar scene with blocks of 20 cm.
fn scene(enclosure: &str) -> Scene {
    let text = format!(
        "scene w from hemisphere {{ world planar free 9 uniform enclosure {enclosure} }}
        assembly a in w {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.north -> T }} }}"
    );
    checked(&text).programs.remove(0).scene.unwrap()
}

const PLATE: Plate = Plate { width: 4, depth: 5 };

fn area(enclosure: &str) -> PlanarArea {
    PlanarArea::from_scene(&scene(enclosure), &PLATE).unwrap()
}

fn cell(x: i32, y: i32) -> Cell {
    Cell::new(x, y, 1)
}

/// Compares each cell with the extents that `outside-enclosure` tests.
#[test]
fn the_area_contains_the_cells_that_do_not_leave_the_enclosure() {
    for enclosure in [
        "disc { radius 1.4m  wall 25 N/m }",
        "rectangle { length 1.6m  width 2.2m  wall 25 N/m }",
    ] {
        let (area, scene) = (area(enclosure), scene(enclosure));
        let mut inside = 0;
        for (x, y) in (-10..15).flat_map(|x| (-10..15).map(move |y| (x, y))) {
            let enclosure = scene.enclosure.as_ref().unwrap();
            let extents = enclosure.extents(cell(x, y), &PLATE, scene.block.side);
            let is_outside = extents.iter().any(Extent::is_outside);
            assert_eq!(area.contains(cell(x, y)), !is_outside, "{x} {y}");
            inside += usize::from(!is_outside);
        }
        assert!((80..200).contains(&inside), "{enclosure:?}: {inside}");
    }
    let space = Scene {
        planar: None,
        ..scene("disc { radius 1.4m  wall 25 N/m }")
    };
    assert_eq!(PlanarArea::from_scene(&space, &PLATE), None);
}

/// Checks the side of a structure that free blocks come from. Without room, walls are ignored.
#[test]
fn blocks_come_from_the_side_with_the_most_room() {
    let side = |area: PlanarArea, cells: &[Cell]| {
        let access = area.access(cells);
        let walls = access.area.has_walls();
        walls.then_some((access.side, access.row))
    };
    let rectangle = area("rectangle { length 4m  width 4m  wall 25 N/m }");
    for (cells, expected) in [
        (vec![cell(1, 2), cell(2, 2)], Some((Face::North, 3))),
        (vec![cell(1, 9)], Some((Face::South, 8))),
        (vec![cell(0, -7), cell(-6, 11)], Some((Face::East, 1))),
        (vec![cell(9, -7), cell(2, 11)], Some((Face::West, 1))),
        (vec![cell(-7, -7), cell(10, 11)], None),
        (vec![cell(1, 2), cell(1, 20)], None),
        (vec![], None),
    ] {
        assert_eq!(side(rectangle, &cells), expected, "{cells:?}");
    }
    let disc = area("disc { radius 80cm  wall 25 N/m }");
    for (rows, expected) in [
        (2..=2, Some((Face::North, 3))),
        (3..=3, Some((Face::South, 2))),
        (0..=4, None),
    ] {
        let cells = rows.flat_map(|y| (-1..=4).map(move |x| cell(x, y)));
        let cells: Vec<Cell> = cells.collect();
        assert_eq!(side(disc, &cells), expected, "{cells:?}");
    }
}

/// Checks a cell in a corner of the enclosure, and a passage along the wall.
#[test]
fn walls_close_cells_and_passages() {
    let program = |wall: &str, phases: &str| {
        format!(
            "scene w from hemisphere {{ world planar free 9 uniform enclosure {wall} }}
            assembly a in w {{ seed plate 6 x 6 {{ M at (1, 0) }} {phases} }}"
        )
    };
    let near = "rectangle { length 1.2m  width 1.2m  wall 250 N/m }";
    let far = "rectangle { length 1.7m  width 1.7m  wall 250 N/m }";
    let corner = "phase p { M.north -> N.west -> W } phase q { M.west -> CORE }";
    let passage =
        "phase p { M.west -> A  M.north -> B.north -> C.west -> D } phase q { A.north -> E }";
    let (sealed, tight) = (Code::SealedCavity, Code::TightApproach);
    for (wall, phases, expected) in [
        (near, corner, vec![sealed, tight]),
        (far, corner, vec![tight]),
        (near, passage, vec![sealed, tight]),
        (far, passage, vec![tight]),
        (near, "phase p { M.west -> A  M.north -> B }", vec![tight]),
        (near, "phase p { M.east -> A  M.north -> B }", vec![]),
    ] {
        let found = checked(&program(wall, phases));
        let codes: BTreeSet<Code> = found.diagnostics.iter().map(|it| it.code).collect();
        let expected = expected.into_iter().collect();
        assert_eq!(codes, expected, "{phases}: {:?}", found.diagnostics);
    }
    let found = checked(&program(near, corner));
    let help = with_code(&found, sealed)[0].help.as_deref().unwrap();
    assert!(help.contains("by then, or the wall\n"), "{help}");
    assert!(
        help.contains("# # # # @ # . . .   (y = 0)\n# # # # # # # # #"),
        "{help}"
    );
}

/// Checks that nothing is proved about access without room next to the structure. A wall closes
/// one of the cells.
#[test]
fn ignored_walls_prove_no_access() {
    let proof = |phases: &str| {
        let text = format!(
            "scene w from hemisphere {{
                world planar free 9 uniform
                enclosure rectangle {{ length 1.2m  width 1.2m  wall 250 N/m }}
            }}
            assembly a in w {{ seed plate 6 x 6 {{ M at (1, 0) }} {phases} }}"
        );
        checked(&text).proof(0)
    };
    let corner = "phase p { M.north -> N.west -> W } phase q { M.west -> CORE }";
    assert_eq!(proof(corner), None);
    let full = format!("{corner} phase r {{ N.east ->> T[1..3]  T[3].north ->> U[1..3] }}");
    let expected = "proved: no cell is used twice\n\
        not proved: completes in every order\n  \
        because no side of the structure has room for two rows of blocks, so the proof ignores walls\n";
    let found = proof(&full).unwrap();
    assert_eq!(found.to_string(), expected);
    assert!(!found.completes && !found.no_cell_blocked);
    let roomy = proof("phase p { M.east -> A  M.north -> B }").unwrap();
    assert!(roomy.completes && roomy.no_cell_blocked);
}

/// Returns a program with one capture per phase, and the cells in their order. Each number is one
/// choice. The cells are in a square, so that many of them are closed.
fn walk(choices: &[u32]) -> (String, Vec<Cell>) {
    let (text, cells) = phases(choices, |face| face);
    (program(&text), cells)
}

/// Returns the phases of `walk`, with faces turned by `turn`.
fn phases(choices: &[u32], turn: impl Fn(Face) -> Face) -> (String, Vec<Cell>) {
    let mut built = vec![("M".to_owned(), Cell::new(0, 0, 1))];
    let mut text = String::new();
    for pair in choices.chunks_exact(2) {
        let (name, cell) = built[pair[0] as usize % built.len()].clone();
        let face = Face::SIDES[pair[1] as usize % 4];
        let next = cell.across(face).unwrap();
        let face = turn(face);
        let is_inside = (0..4).contains(&next.x) && (0..4).contains(&next.y);
        if !is_inside || built.iter().any(|(_, cell)| *cell == next) {
            continue;
        }
        let number = built.len();
        let _ = write!(text, "phase p{number} {{ {name}.{face} -> B{number} }} ");
        built.push((format!("B{number}"), next));
    }
    let cells = built.into_iter().skip(1).map(|(_, cell)| cell).collect();
    (text, cells)
}

/// Returns whether a path of free cells leads out of the square of `walk`. With `has_walls`, it can
/// lead out only to the north.
fn is_open(start: Cell, built: &[Cell], has_walls: bool) -> bool {
    let mut seen = BTreeSet::from([start]);
    let mut open = vec![start];
    while let Some(cell) = open.pop() {
        if cell.y > 3 {
            return true;
        }
        if cell.x.min(cell.y) < 0 || cell.x > 3 {
            if has_walls {
                continue;
            }
            return true;
        }
        for next in Face::SIDES.into_iter().filter_map(|face| cell.across(face)) {
            let is_free = !built.contains(&next) && next != Cell::new(0, 0, 1);
            if is_free && seen.insert(next) {
                open.push(next);
            }
        }
    }
    false
}

/// Returns whether a path of free cells inside the walls leads to the rows beyond the structure.
fn is_open_in(access: &PlanarAccess, start: Cell, built: &[Cell]) -> bool {
    let [dx, dy, _] = access.side.normal();
    let is_beyond = |at: Cell| dx * at.x + dy * at.y >= (dx + dy) * access.row;
    let mut seen = BTreeSet::from([start]);
    let mut open = vec![start];
    while let Some(at) = open.pop() {
        if is_beyond(at) {
            return true;
        }
        for next in Face::SIDES.into_iter().filter_map(|face| at.across(face)) {
            let is_free = access.area.contains(next) && !built.contains(&next);
            if is_free && seen.insert(next) {
                open.push(next);
            }
        }
    }
    false
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Compares the proof with a search for a path before each capture.
    #[test]
    fn the_proof_agrees_with_a_search_in_the_plane(choices in prop::collection::vec(any::<u32>(), 80)) {
        let (text, cells) = walk(&choices);
        let closed = (0..cells.len()).any(|i| !is_open(cells[i], &cells[..i], false));
        let found = checked(&text);
        let errors: Vec<_> = found.diagnostics.iter().filter(|it| it.is_error()).collect();
        prop_assert!(errors.iter().all(|it| it.code == Code::SealedCavity), "{text}\n{errors:?}");
        prop_assert_eq!(!errors.is_empty(), closed, "{}", text);
    }

    /// Compares the proof with a search between walls in the west, east and south. The table is
    /// turned by quarter turns.
    #[test]
    fn the_proof_agrees_with_a_search_between_walls(
        choices in prop::collection::vec(any::<u32>(), 80),
        turns in 0..4usize,
    ) {
        let (text, cells) = phases(&choices, |face| face.turned(turns as u8).unwrap());
        let closed = (0..cells.len()).any(|i| !is_open(cells[i], &cells[..i], true));
        let (seed, [width, depth]) = [
            ((0, 0), [4, 6]),
            ((5, 0), [6, 4]),
            ((3, 5), [4, 6]),
            ((0, 3), [6, 4]),
        ][turns];
        let text = format!(
            "scene w from hemisphere {{
                world planar free 20 uniform
                enclosure rectangle {{ length {}cm  width {}cm  wall 25 N/m }}
            }}
            assembly a in w {{ seed plate {width} x {depth} {{ M at {seed:?} }} {text} }}",
            20 * width,
            20 * depth
        );
        let found = checked(&text);
        let errors: Vec<_> = found.diagnostics.iter().filter(|it| it.is_error()).collect();
        prop_assert!(errors.iter().all(|it| it.code == Code::SealedCavity), "{text}\n{errors:?}");
        prop_assert_eq!(!errors.is_empty(), closed, "{}", text);
    }

    /// Compares the proof with a search inside a disc. The square of `walk` is near the wall.
    #[test]
    fn the_proof_agrees_with_a_search_in_a_disc(
        choices in prop::collection::vec(any::<u32>(), 80),
        (x, y) in (0..6, 0..6),
        radius in 86..110_u32,
    ) {
        let (text, cells) = phases(&choices, |face| face);
        let enclosure = format!("disc {{ radius {radius}cm wall 25 N/m }}");
        let plate = Plate { width: 6, depth: 6 };
        let area = PlanarArea::from_scene(&scene(&enclosure), &plate).unwrap();
        let seed = cell(x, y);
        let moved = cells.iter().map(|it| cell(x + it.x, y + it.y));
        let all: Vec<Cell> = [seed].into_iter().chain(moved).collect();
        prop_assume!(all.iter().all(|&cell| area.contains(cell)));
        let access = area.access(&all);
        prop_assume!(!access.ignores_walls);
        let closed = (1..all.len()).any(|i| !is_open_in(&access, all[i], &all[..i]));
        let text = format!(
            "scene w from hemisphere {{ world planar free 20 uniform enclosure {enclosure} }}
            assembly a in w {{ seed plate 6 x 6 {{ M at ({x}, {y}) }} {text} }}"
        );
        let found = checked(&text);
        let errors: Vec<_> = found.diagnostics.iter().filter(|it| it.is_error()).collect();
        prop_assert!(errors.iter().all(|it| it.code == Code::SealedCavity), "{text}\n{errors:?}");
        prop_assert_eq!(!errors.is_empty(), closed, "{}", text);
    }
}
