//! Limits on work and diagnostics, and the reports about them.
use std::fmt::Write as _;

use stochc_compiler::Limits;
use stochc_compiler::diagnostic::Code;

use crate::{checked, checked_within, with_code};

const VAST: &str = "scene w from hemisphere { free 10000000 uniform \
    enclosure hemisphere { radius 1e7 m wall 250 N/m } }\n";

/// Returns chimneys whose lid may dock before their core, written as loops.
fn chimneys(edge: usize) -> String {
    let last = edge - 1;
    let plate = 4 * edge;
    format!(
        "{VAST}assembly a in w {{ seed plate {plate} x {plate} {{ for i in 0..{last} {{ for j in 0..{last} {{
        W[i, j] at (4*i, 4*j+1)  E[i, j] at (4*i+2, 4*j+1)  S[i, j] at (4*i+1, 4*j)
        N[i, j] at (4*i+1, 4*j+2)  M[i, j] at (4*i+1, 4*j+1) }} }} }}
        phase p {{ for i in 0..{last} {{ for j in 0..{last} {{
        W[i, j].up -> W1[i, j].up -> W2[i, j]
        E[i, j].up -> E1[i, j]
        S[i, j].up -> S1[i, j]
        N[i, j].up -> N1[i, j]
        W2[i, j].east -> LID[i, j]
        M[i, j].up -> CORE[i, j] }} }} }} }}"
    )
}

/// Returns the same chimneys as separate statements.
fn written_out(count: usize) -> String {
    let (mut seeds, mut phase) = (String::new(), String::new());
    for i in 0..count {
        let x = 4 * i;
        let [middle, east] = [x + 1, x + 2];
        let _ = writeln!(
            seeds,
            "W{i} at ({x}, 1) E{i} at ({east}, 1) S{i} at ({middle}, 0) N{i} at ({middle}, 2) M{i} at ({middle}, 1)"
        );
        let _ = writeln!(
            phase,
            "W{i}.up -> W1_{i}.up -> W2_{i}\nE{i}.up -> E1_{i}\nS{i}.up -> S1_{i}\nN{i}.up -> N1_{i}\n\
             W2_{i}.east -> LID{i}\nM{i}.up -> CORE{i}"
        );
    }
    let plate = 4 * count;
    format!(
        "{VAST}assembly a in w {{ seed plate {plate} x 3 {{\n{seeds}}}\nphase p {{\n{phase}}} }}"
    )
}

#[test]
fn every_sealed_cavity_is_counted() {
    let checked = checked(&chimneys(11));
    let sealed = with_code(&checked, Code::SealedCavity);
    let counted: usize = (sealed.iter())
        .map(|diagnostic| match diagnostic.title.split_once(" further") {
            Some((count, _)) => count.parse::<usize>().unwrap(),
            None => 1 + diagnostic.others.count,
        })
        .sum();
    assert_eq!(counted, 121, "{sealed:#?}");
}

#[test]
fn an_after_that_helps_every_iteration_comes_first() {
    let checked = checked(&chimneys(2));
    let [sealed] = with_code(&checked, Code::SealedCavity)[..] else {
        panic!("{:#?}", checked.diagnostics);
    };
    let help = sealed.help.as_ref().unwrap();
    assert!(help.contains(" after CORE[i, j]`"), "{help}");
    assert!(!help.contains("for `"), "{help}");
    assert!(sealed.fix.is_some());
}

#[test]
fn a_lone_statement_is_not_split_again() {
    // This is more than the number of tried fixes.
    let checked = checked(&written_out(100));
    let sealed = with_code(&checked, Code::SealedCavity);
    assert_eq!(sealed.len(), 100);
    for diagnostic in sealed {
        let help = diagnostic.help.as_ref().unwrap();
        assert!(!help.contains("of its own"), "{help}");
        assert!(help.contains("after"), "{help}");
    }
}

/// Returns a pit. Phases capture and release a block at its bottom.
fn pit(depth: usize, phases: usize) -> String {
    format!(
        "{VAST}assembly a in w {{ seed plate 3 x 3 {{
        for x in 0..2 {{ for y in 0..2 {{ P[x, y] at (x, y) }} }}
        for x in 0..2 {{ P[x, 0].up ->> A[x, 1..{depth}]  P[x, 2].up ->> C[x, 1..{depth}] }}
        P[0, 1].up ->> B[0, 1..{depth}]  P[2, 1].up ->> B[2, 1..{depth}] }}
        for i in 1..{phases} {{ phase a[i] {{ P[1, 1].up -> T }}  phase b[i] {{ release T }} }} }}"
    )
}

#[test]
fn measuring_gaps_counts_toward_the_search_limit() {
    let limits = Limits {
        search: 10,
        ..Limits::default()
    };
    // Each of the 8 x 500 captures counts 10. The gap of one phase is measured, the gaps of 200
    // phases are not.
    let few = checked_within(&pit(500, 2), limits);
    assert_eq!(with_code(&few, Code::ReachUndecided).len(), 0);
    assert_eq!(with_code(&few, Code::TightApproach).len(), 1);
    let many = checked_within(&pit(500, 200), limits);
    let undecided = with_code(&many, Code::ReachUndecided);
    assert_eq!(undecided.len(), 1, "{undecided:#?}");
}

#[test]
fn claimed_shapes_share_one_limit() {
    let shapes: String = (0..3)
        .map(|i| format!("shape s{i} {{ layer 1..2000000 {{ # }} }}\n"))
        .collect();
    let phases = "phase q0 { yields s0 } phase q1 { yields s1 } phase q2 { yields s2 }";
    let checked = checked(&format!(
        "{shapes}assembly a {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> T }} {phases} }}"
    ));
    assert_eq!(with_code(&checked, Code::ShapeMismatch).len(), 2);
    assert_eq!(with_code(&checked, Code::ExpansionLimit).len(), 1);
}

#[test]
fn a_plate_must_lie_inside_the_enclosure() {
    let outside = |enclosure: &str, plate: usize| {
        let checked = checked(&format!(
            "scene w from hemisphere {{ free 3 uniform enclosure {enclosure} {{ radius 1 m wall 25 N/m }} }}
            assembly a in w {{ seed plate {plate} x {plate} {{ M at ({0}, {0}) }} phase p {{ M.up -> T }} }}",
            plate / 2
        ));
        with_code(&checked, Code::OutsideEnclosure).len()
    };
    // Blocks have 20 cm. A plate of 7 has its corners at 0.99 m, a plate of 8 at 1.13 m.
    for enclosure in ["hemisphere", "sphere"] {
        assert_eq!(outside(enclosure, 7), 0, "{enclosure}");
        assert_eq!(outside(enclosure, 8), 1, "{enclosure}");
        assert_eq!(outside(enclosure, 9_000), 1, "{enclosure}");
    }
}

/// Checks the limits of boxes and cylinders in every dimension, at blocks of 20 cm.
#[test]
fn a_structure_must_lie_inside_a_box_or_a_cylinder() {
    let found = |enclosure: &str, plate: &str, path: &str| {
        let checked = checked(&format!(
            "scene w from hemisphere {{ free 9 uniform enclosure {enclosure} }}
            assembly a in w {{ seed plate {plate} {{ M at (0, 0) }} phase p {{ M.up ->> T[1..{path} }} }}",
        ));
        let found = with_code(&checked, Code::OutsideEnclosure);
        let labels = found
            .iter()
            .map(|it| format!("{}; {}", it.labels[0].text, it.help.as_deref().unwrap()));
        labels.collect::<Vec<_>>()
    };
    let flat = "box { length 1.4m  width 1m  height 1.2m  wall 25 N/m }";
    let tube = "cylinder { radius 1m  height 1.2m  wall 25 N/m }";
    for fits in ["1 x 1", "7 x 5"] {
        assert_eq!(found(flat, fits, "6]"), [""; 0]);
    }
    assert_eq!(found(tube, "7 x 7", "6]"), [""; 0]);
    let smaller = "or build a smaller structure";
    let high = format!(
        "the block at (0, 0, 7) reaches 1.40 m above the floor, the height is 1.20 m; \
         write a larger `height` in the scene, {smaller}"
    );
    for enclosure in [flat, tube] {
        assert_eq!(found(enclosure, "1 x 1", "7]"), [&high[..]]);
    }
    let low = "cylinder { radius 1m  height 19cm  wall 25 N/m }";
    assert_eq!(
        found(low, "1 x 1", "1]"),
        [format!(
            "the block at (0, 0, 1) reaches 0.20 m above the floor, the height is 0.19 m; \
             write a larger `height` in the scene, {smaller}"
        )]
    );
    assert_eq!(
        found(flat, "1 x 1", "2].north ->> U[1..3]"),
        [format!(
            "the block at (0, 3, 2) reaches 0.70 m from the middle, half of the width is 0.50 m; \
             write a larger `width` in the scene, {smaller}"
        )]
    );
    assert_eq!(
        found(tube, "1 x 1", "2].north ->> U[1..5]"),
        [format!(
            "the block at (0, 5, 2) reaches 1.10 m from the axis, the radius is 1.00 m; \
             write a larger `radius` in the scene, {smaller}"
        )]
    );
    assert_eq!(
        found(flat, "8 x 5", "2]"),
        [
            "the corners of the 8 x 5 plate are 0.80 m from the middle, half of the length is 0.70 m; \
             write a larger `length` in the scene, or a smaller plate"
        ]
    );
    assert_eq!(
        found(tube, "8 x 8", "2]"),
        [
            "the corners of the 8 x 8 plate are 1.13 m from the axis, the radius is 1.00 m; \
             write a larger `radius` in the scene, or a smaller plate"
        ]
    );
}

/// Checks claims of docs/reference/language.md about empty ranges, `allow`, patterns, shapes and
/// free blocks.
#[test]
fn sentences_of_the_reference_hold() {
    let program = |text: &str| {
        let checked = checked(text);
        assert!(!checked.has_errors(), "{:#?}", checked.diagnostics);
        let program = &checked.programs[0];
        let events = 0..program.plan.events.len() as u32;
        let events = events.map(|id| {
            let id = stochc_compiler::expanded::EventId(id);
            program.plan.describe(id, &checked.symbols)
        });
        (events.collect::<Vec<_>>(), checked.allowed.len())
    };
    let (events, _) = program(
        "assembly a { seed plate 3 x 1 { A at (1, 0) } phase p { A.up -> B.up ->> T[2..1].east -> C } }",
    );
    assert_eq!(events, ["A.up -> B", "B.east -> C"]);
    let (_, allowed) = program(
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A }
        phase q { allow empty-phase \"inside\" } }",
    );
    assert_eq!(allowed, 1);
    let (events, _) = program(
        "let n = 2 assembly a { pattern p(b) { b.up ->> T[1..n] } let n = 3
        seed plate 1 x 1 { M at (0, 0) } phase q { p(M) } }",
    );
    assert_eq!(events.len(), 3);
    let both = checked(&chimneys(1).replace(
        "phase p {",
        "shape q { layer 1 { # } }\nphase p { yields q ",
    ));
    assert_eq!(with_code(&both, Code::SealedCavity).len(), 1);
    assert_eq!(with_code(&both, Code::ShapeMismatch).len(), 1);
    let scarce = |free: u32| {
        let checked = checked(&format!(
            "scene w from hemisphere {{ free {free} uniform }}
            assembly a in w {{ seed plate 3 x 1 {{ A at (0, 0)  B at (1, 0)  C at (2, 0) }}
            phase one {{ A.up -> X }}
            phase two {{ B.up -> Y   release Y after Z   C.up -> Z }} }}"
        ));
        with_code(&checked, Code::TooFewBlocks).len()
    };
    assert_eq!((scarce(2), scarce(3)), (1, 0));
}
