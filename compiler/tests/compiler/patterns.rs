//! Tests patterns with seeds and phases, default values, faces as values, and frames of instances.
use std::collections::BTreeMap;

use stochc_compiler::diagnostic::Code;
use stochc_ir::Cell;

use super::checked;

/// Returns the cells of the blocks above the plate at the end of a program.
fn structure(text: &str) -> BTreeMap<String, (i32, i32, i32)> {
    let checked = checked(text);
    assert!(!checked.has_errors(), "{text}\n{:#?}", checked.diagnostics);
    let program = &checked.programs[0];
    let layout = program.layout.cells.iter().zip(&program.plan.events);
    let cells = layout.filter_map(|(cell, event)| {
        let Cell { x, y, z } = (*cell)?;
        let name = program.plan.roles.name(event.role, &checked.symbols);
        Some((name, (x, y, z)))
    });
    cells.collect()
}

fn errors(text: &str) -> Vec<(Code, String)> {
    let checked = checked(text);
    let errors = checked.diagnostics.iter().filter(|it| it.is_error());
    errors.map(|it| (it.code, it.title.clone())).collect()
}

/// Returns a program with this phase on a plate of one seed.
fn on_one_seed(patterns: &str, statements: &str) -> String {
    format!(
        "{patterns} assembly a {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A {statements} }} }}"
    )
}

#[test]
fn a_parameter_without_an_argument_has_its_default_value() {
    let arm = "pattern arm(base, length = 2, side = east, tip = length) {
        base.side ->> T[1..tip]
    }";
    let blocks = |call: &str| -> Vec<_> {
        let text = on_one_seed(arm, &format!("arm({call}) as a"));
        structure(&text)
            .into_values()
            .filter(|cell| cell.0 != 0 || cell.1 != 0)
            .collect()
    };
    assert_eq!(blocks("A"), [(1, 0, 1), (2, 0, 1)]);
    assert_eq!(blocks("A, 1"), [(1, 0, 1)]);
    assert_eq!(blocks("A, side = north"), [(0, 1, 1), (0, 2, 1)]);
    assert_eq!(blocks("side = south, tip = 1, base = A"), [(0, -1, 1)]);
}

#[test]
fn faces_are_values() {
    let arm = "pattern arm(base, side) {
        let back = opposite(side)
        base.side -> F
        base.back -> B
        turned_arm(base, left(side)) as l
        turned_arm(base, right(side)) as r
    }
    pattern turned_arm(base, side) { base.side -> T }";
    let cells = structure(&on_one_seed(arm, "arm(A, north) as a"));
    assert_eq!(cells["a.F"], (0, 1, 1));
    assert_eq!(cells["a.B"], (0, -1, 1));
    assert_eq!(cells["a.l.T"], (-1, 0, 1));
    assert_eq!(cells["a.r.T"], (1, 0, 1));
}

#[test]
fn an_instance_can_be_mirrored_and_turned() {
    let hook = "pattern hook(base) { base.east -> T.north -> U.up -> V }";
    let ends = |frame: &str| {
        let cells = structure(&on_one_seed(hook, &format!("hook(A) {frame} as h")));
        (cells["h.T"], cells["h.V"])
    };
    assert_eq!(ends(""), ((1, 0, 1), (1, 1, 2)));
    assert_eq!(ends("turned 90"), ((0, 1, 1), (-1, 1, 2)));
    assert_eq!(ends("turned 2 * 90"), ((-1, 0, 1), (-1, -1, 2)));
    assert_eq!(ends("turned -90"), ((0, -1, 1), (1, -1, 2)));
    assert_eq!(ends("mirrored"), ((-1, 0, 1), (-1, 1, 2)));
    assert_eq!(ends("mirrored turned 90"), ((0, -1, 1), (-1, -1, 2)));
}

const TOWER: &str = "pattern tower(height = 2) {
    M at (0, 0)
    N at (1, 0)
    N.up -> P
    phase grow { M.up ->> T[1..height]  P.up -> Q }
}";

#[test]
fn a_pattern_can_contain_seeds_and_phases() {
    let text = format!(
        "{TOWER} assembly a {{
            seed plate 4 x 4 {{
                tower() at (0, 0) as a
                tower(3) turned 90 at (3, 1) as b
                tower(1) mirrored at (1, 3)
            }}
            phase roof {{ a.T[2].up -> R }}
        }}"
    );
    let cells = structure(&text);
    assert_eq!(cells["a.P"], (1, 0, 1));
    assert_eq!(cells["a.T[2]"], (0, 0, 2));
    assert_eq!(cells["b.P"], (3, 2, 1));
    assert_eq!(cells["b.T[3]"], (3, 1, 3));
    assert_eq!(cells["tower#1.Q"], (0, 3, 2));
    assert_eq!(cells["R"], (0, 0, 3));
    let checked = checked(&text);
    let phases = checked.programs[0].plan.phases.iter();
    let phases: Vec<&str> = phases.map(|phase| &phase.name[..]).collect();
    assert_eq!(phases, ["seed", "a.grow", "b.grow", "tower#1.grow", "roof"]);
}

#[test]
fn instances_without_names_keep_their_seeds() {
    let cells = structure(
        "pattern cap(b) { b.up -> top }
        pattern tower() {
            base at (0, 0)
            phase grow { base.up -> x  cap(x) }
            phase more { x.east -> y  cap(y) }
        }
        assembly a { seed plate 5 x 1 { tower() at (0, 0)  tower() at (4, 0) } }",
    );
    let tops: Vec<_> = (cells.iter())
        .filter(|(name, _)| name.ends_with(".top"))
        .map(|(_, cell)| *cell)
        .collect();
    assert_eq!(tops.len(), 4);
    for cell in [(0, 0, 2), (1, 0, 2), (4, 0, 2), (5, 0, 2)] {
        assert!(tops.contains(&cell), "{cell:?}");
    }
}

#[test]
fn frames_of_nested_instances_add_up() {
    let text = "pattern foot(x) { M at (x, 0) }
        pattern pair() { foot(1) as near  foot(0) mirrored turned 90 at (0, 2) as far }
        assembly a {
            seed plate 5 x 5 { pair() turned 90 at (4, 1) as p }
            phase grow { p.near.M.up -> A  p.far.M.up -> B }
        }";
    let cells = structure(text);
    assert_eq!(cells["A"], (4, 2, 1));
    assert_eq!(cells["B"], (2, 1, 1));
}

#[test]
fn an_instance_of_phases_can_stand_in_an_assembly() {
    let text = "pattern two(base) { phase one { base.up -> A } phase two { A.up -> B } }
        assembly a { seed plate 1 x 1 { M at (0, 0) } two(M) as t  phase end { t.B.up -> C } }";
    assert_eq!(structure(text)["C"], (0, 0, 3));
}

#[test]
fn statements_of_a_pattern_need_the_right_place() {
    let plate = |pattern: &str| {
        format!(
            "pattern t() {{ M at (0, 0) {pattern} }} assembly a {{ seed plate 1 x 1 {{ t() as t }} phase p {{ t.M.up -> A }} }}"
        )
    };
    let phase = |pattern: &str| on_one_seed(&format!("pattern t(b) {{ {pattern} }}"), "t(A)");
    let expected = [
        (
            plate("release M"),
            "a release of a pattern is outside of a phase",
        ),
        (
            plate("M.up -> X after M"),
            "an `after` of a pattern is outside of a phase",
        ),
        (
            phase("S at (0, 0)"),
            "a seed of a pattern is outside of a seed plate",
        ),
        (
            phase("phase q { b.up -> X }"),
            "a phase of a pattern is outside of an assembly or a seed plate",
        ),
    ];
    for (text, title) in expected {
        assert_eq!(
            errors(&text),
            [(Code::Misplaced, title.to_owned())],
            "{text}"
        );
    }
    let text = "pattern t(b) { b.up -> X }
        assembly a { seed plate 1 x 1 { M at (0, 0) } t(M) phase p { M.up -> A } }";
    let title = "a capture of a pattern is outside of a phase";
    assert_eq!(errors(text), [(Code::Misplaced, title.to_owned())]);
}

#[test]
fn wrong_arguments_and_frames_are_reported_once() {
    let arm = "pattern arm(base, length = 2, side = east) { base.side ->> T[1..length] }";
    let expected = [
        (
            "arm()",
            Code::WrongArguments,
            "`arm` takes 1 to 3 arguments, not 0",
        ),
        (
            "arm(A, 1, up, 2)",
            Code::WrongArguments,
            "`arm` takes 1 to 3 arguments, not 4",
        ),
        (
            "arm(A, 1, length = 2)",
            Code::WrongArguments,
            "parameter `length` has two arguments",
        ),
        (
            "arm(length = 2)",
            Code::WrongArguments,
            "an argument of `arm` is missing",
        ),
        (
            "arm(A, length = 1, up)",
            Code::WrongArguments,
            "an argument without a name follows an argument with a name",
        ),
        (
            "arm(A, lenght = 1)",
            Code::UnknownName,
            "pattern `arm` has no parameter `lenght`",
        ),
        (
            "arm(A, side = 1)",
            Code::WrongKind,
            "`side` of `arm` is a face, not a number",
        ),
        (
            "arm(A, left(up))",
            Code::WrongValue,
            "`left` of `up` does not exist",
        ),
        (
            "arm(A, length = up)",
            Code::WrongKind,
            "`length` of `arm` is a number, not a face",
        ),
        (
            "arm(A) turned 45",
            Code::WrongValue,
            "an instance cannot be turned by 45 degrees",
        ),
        (
            "arm(A) at (1, 0)",
            Code::Misplaced,
            "an instance outside of a seed plate has no position",
        ),
        (
            "let n = up + 1",
            Code::WrongKind,
            "expected a number, found a face",
        ),
    ];
    for (statement, code, title) in expected {
        let text = on_one_seed(arm, statement);
        assert_eq!(errors(&text), [(code, title.to_owned())], "{statement}");
    }
}

#[test]
fn errors_in_a_seed_plate_with_instances_are_reported_once() {
    let text = "pattern t() { M at (0, n) }
        assembly a { seed plate 1 x 1 { t() as t  for i in 0..m { } } phase p { t.M.up -> A } }";
    let titles = ["cannot find number `n`", "cannot find number `m`"];
    let expected = titles.map(|title| (Code::UnknownName, title.to_owned()));
    assert_eq!(errors(text), expected);
}
