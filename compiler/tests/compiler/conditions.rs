//! Tests conditions and functions of numbers.
use stochc_compiler::diagnostic::{Code, Label};

use super::checked;

/// Returns the names of the blocks that a phase with these statements captures.
fn captured(parameters: &str, statements: &str) -> Vec<String> {
    let checked = checked(&program(parameters, statements));
    assert!(
        !checked.has_errors(),
        "{statements}\n{:#?}",
        checked.diagnostics
    );
    let plan = &checked.programs[0].plan;
    let name = |event: &stochc_compiler::expanded::ExpandedEvent| {
        plan.roles.name(event.role, &checked.symbols).to_string()
    };
    plan.events.iter().map(name).collect()
}

fn program(parameters: &str, statements: &str) -> String {
    format!(
        "assembly a({parameters}) {{
            seed plate 1 x 1 {{ M at (0, 0) }}
            phase p {{ {statements} }}
        }}"
    )
}

/// Returns the codes and titles of the errors of a phase with these statements.
fn errors(statements: &str) -> Vec<(Code, String)> {
    let checked = checked(&program("n = 3", statements));
    let errors = checked.diagnostics.iter().filter(|it| it.is_error());
    errors.map(|it| (it.code, it.title.clone())).collect()
}

#[test]
fn the_first_true_branch_is_used() {
    let statements = "if n > 3 { M.up -> A } else if n > 1 { M.up -> B } else { M.up -> C }";
    for (n, block) in [(4, "A"), (3, "B"), (2, "B"), (1, "C")] {
        assert_eq!(captured(&format!("n = {n}"), statements), [block], "{n}");
    }
}

#[test]
fn comparisons_follow_the_order_of_numbers() {
    let signs = ["<", "<=", "==", "!=", ">=", ">"];
    let holds: [fn(i64, i64) -> bool; 6] = [
        |a, b| a < b,
        |a, b| a <= b,
        |a, b| a == b,
        |a, b| a != b,
        |a, b| a >= b,
        |a, b| a > b,
    ];
    for (sign, holds) in signs.into_iter().zip(holds) {
        for n in -1..=1 {
            let statements = format!("M.up -> A  if n {sign} 0 {{ A.up -> B }}");
            let blocks = captured(&format!("n = {n}"), &statements).len();
            assert_eq!(blocks == 2, holds(n, 0), "{n} {sign} 0");
        }
    }
}

#[test]
fn and_binds_tighter_than_or() {
    for bits in 0..8_i64 {
        let [a, b, c] = [bits & 1, bits >> 1 & 1, bits >> 2];
        let is_true = a == 1 || (b == 1 && c != 1);
        let statements =
            "M.up -> A  if a == 1 or b == 1 and not (c == 1) { A.up -> B } else { A.east -> C }";
        let expected = if is_true { "B" } else { "C" };
        let parameters = format!("a = {a}, b = {b}, c = {c}");
        assert_eq!(captured(&parameters, statements), ["A", expected], "{bits}");
    }
}

#[test]
fn the_right_side_is_evaluated_only_if_it_decides() {
    let statements = "M.up -> A  if n > 0 and 6 / n > 1 { A.up -> B }
        if n == 0 or 6 / n > 1 { A.east -> C }";
    assert_eq!(captured("n = 0", statements), ["A", "C"]);
    assert_eq!(captured("n = 2", statements), ["A", "B", "C"]);
}

#[test]
fn functions_are_known_wherever_a_number_is() {
    let statements = "M.up ->> T[1..min(n, 4, 9)]  T[max(1, n - 5)].east ->> U[abs(-2)..2]";
    let blocks = captured("n = 5", statements);
    assert_eq!(blocks.join(" "), "T[1] T[2] T[3] T[4] U[2]");
}

#[test]
fn phases_and_seeds_may_be_conditional() {
    let text = |n: u32| {
        format!(
            "assembly a(n = {n}) {{
                seed plate n x 1 {{
                    M at (0, 0)
                    if n > 1 {{ N at (n - 1, 0) }}
                }}
                phase p {{ M.up -> A }}
                if n > 1 {{ phase q {{ N.up -> B }} }} else {{ phase r {{ A.up -> C }} }}
            }}"
        )
    };
    for (n, phase) in [(1, "r"), (3, "q")] {
        let checked = checked(&text(n));
        assert!(checked.diagnostics.is_empty(), "{:#?}", checked.diagnostics);
        assert_eq!(checked.programs[0].plan.phases[1].name, phase);
    }
}

#[test]
fn numbers_and_conditions_are_different() {
    let number = (
        Code::WrongKind,
        "a condition is required, not a number".to_owned(),
    );
    let condition = (
        Code::WrongKind,
        "a number is required, not a condition".to_owned(),
    );
    for (statement, expected) in [
        ("if n { M.up -> A }", &number),
        ("if n > 1 and n { M.up -> A }", &number),
        ("if not (n + 1) { M.up -> A }", &number),
        ("if 1 < n < 4 { M.up -> A }", &condition),
        ("if (n > 1) + 1 > 1 { M.up -> A }", &condition),
    ] {
        assert_eq!(
            errors(statement),
            std::slice::from_ref(expected),
            "{statement}"
        );
    }
}

#[test]
fn wrong_functions_and_lone_branches_are_reported() {
    let unknown = |title: &str| (Code::UnknownName, title.to_owned());
    let found = errors("if mid(n, 2) > 1 { M.up -> A }");
    assert_eq!(found, [unknown("cannot find function `mid`")]);
    let found = errors("if abs(n, 2) > 1 { M.up -> A }");
    assert_eq!(found, [unknown("`abs` has one argument")]);
    let found = errors("else { M.up -> A }");
    assert_eq!(found[0].0, Code::Misplaced);
    let found = errors("if n > 1 { M.up -> A } else { M.up -> B } else { M.up -> C }");
    assert_eq!(found[0].0, Code::Misplaced);
}

#[test]
fn an_unknown_condition_causes_no_further_errors() {
    let found = errors("if unknown > 1 { M.up -> A }  A.up -> B");
    assert_eq!(
        found,
        [(Code::UnknownName, "cannot find number `unknown`".to_owned())]
    );
}

/// Returns the labels of the first diagnostic that are about branches, with their source.
fn branches(text: &str) -> Vec<(String, String)> {
    let checked = checked(text);
    let labels = checked.diagnostics[0].labels.iter();
    let branches = labels.filter(|label| label.text.contains("branch"));
    let source = |label: &Label| checked.sources.text(label.location).to_owned();
    branches
        .map(|label| (source(label), label.text.clone()))
        .collect()
}

#[test]
fn diagnostics_point_at_the_branches_around_them() {
    for (parameters, statements, expected) in [
        (
            "n = 3",
            "if n > 1 { X.up -> A }",
            &[("n > 1", "because `n` is 3")][..],
        ),
        (
            "n = 3, m = 2",
            "if n > 3 { } else if m + n > 4 { X.up -> A }",
            &[("m + n > 4", "because `n` is 3 and `m` is 2")],
        ),
        (
            "n = 3",
            "if n > 3 { } else { X.up -> A }",
            &[("else", "because `n` is 3")],
        ),
        (
            "n = 3",
            "if n > 1 { for i in 1..9 { if i > n { X.up -> A[i] } } }",
            &[
                (
                    "i > n",
                    "when `i` is 4, 5, 6 or another number and `n` is 3",
                ),
                ("n > 1", "because `n` is 3"),
            ],
        ),
        ("n = 3", "if n > 1 { } X.up -> A", &[]),
        ("n = 3", "if 2 > 1 { X.up -> A }", &[]),
        ("n = 3", "if X > 1 { M.up -> A }", &[]),
    ] {
        let expected: Vec<_> = (expected.iter())
            .map(|(source, reason)| {
                let text = format!("this branch is taken {reason}");
                ((*source).to_owned(), text)
            })
            .collect();
        let found = branches(&program(parameters, statements));
        assert_eq!(found, expected, "{statements}");
    }
}

/// Later stages find these errors, after the expansion.
#[test]
fn errors_in_cells_and_order_point_at_their_branch() {
    for statements in [
        "M.up -> A.up -> B  if n > 1 { A.up -> C }",
        "M.up -> A.up -> B  if n > 1 { release A }",
        "if n > 1 { M.up -> A after B  A.up -> B }",
    ] {
        let found = branches(&program("n = 3", statements));
        let expected = "this branch is taken because `n` is 3";
        assert_eq!(found, [("n > 1".to_owned(), expected.to_owned())]);
    }
}

#[test]
fn branches_of_patterns_are_shown_in_the_pattern() {
    let text = "pattern tower(base, height) {
            if height > 2 { base.up -> T } else { base.up -> T  X.up -> U }
        }
        assembly a {
            seed plate 1 x 1 { M at (0, 0) }
            phase p { tower(M, 2) as t  tower(t.T, 3) }
        }";
    let expected = "this branch is taken because `height` is 2";
    assert_eq!(branches(text), [("else".to_owned(), expected.to_owned())]);
}

#[test]
fn names_in_a_skipped_branch_are_shown() {
    let label = "captured or declared in a branch that is not taken";
    for (statements, expected) in [
        ("if n > 3 { M.up -> A }  A.up -> B", &[("A", label)][..]),
        (
            "if n > 3 { for i in 1..2 { M.up -> A[i] } }  A[1].up -> B",
            &[("A[i]", label)],
        ),
        (
            "if n < 9 { M.up -> B } else { M.up -> A }  A.up -> C",
            &[("A", label)],
        ),
        ("if n > 3 { release A }  A.up -> B", &[]),
        (
            "for i in 1..2 { if i > 1 { M.up -> A[i] } }  A[1].up -> B",
            &[],
        ),
    ] {
        let expected: Vec<_> = (expected.iter())
            .map(|(source, text)| ((*source).to_owned(), (*text).to_owned()))
            .collect();
        assert_eq!(
            branches(&program("n = 3", statements)),
            expected,
            "{statements}"
        );
    }
}
