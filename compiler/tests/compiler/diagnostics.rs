//! Checks the examples on every page of `stochc explain`.
use std::collections::BTreeMap;
use std::fmt::Write as _;

use stochc_compiler::diagnostic::{Code, Diagnostic, TextChange};
use stochc_compiler::{Checked, FileId, Limits, check};

/// Pages without an invalid program, with the reason.
const WITHOUT: [(Code, &str); 11] = [
    (Code::NotUtf8, "a page is UTF-8 itself"),
    (Code::FileTooLarge, "4 GiB are too many for a test as well"),
    (Code::TooDeep, "a hundred braces do not fit on a page"),
    (Code::StatementTooLong, "a statement of 4 MiB"),
    (Code::TooManyErrors, "a hundred errors"),
    (Code::TooManyWarnings, "a thousand warnings"),
    (Code::ReachUndecided, "a hall of a million blocks"),
    (
        Code::InternalError,
        "the compiler is not known to make this mistake",
    ),
    (Code::ImportMissing, "the example has only one file"),
    (Code::ImportOutside, "a fence has no folder"),
    (Code::ImportCycle, "the example has only one file"),
];

#[test]
fn every_page_has_a_title_of_one_line() {
    for &code in Code::ALL {
        let title = code.page().lines().next().unwrap_or_default();
        let meaning = title
            .strip_prefix(&format!("# {code}: "))
            .unwrap_or_default();
        assert!(!meaning.is_empty(), "`{title}`");
        assert!(meaning.len() <= 80 && !meaning.ends_with('.'), "`{title}`");
        assert!(!meaning.starts_with(char::is_uppercase), "`{title}`");
        assert!(code.page().ends_with('\n') && !code.page().ends_with("\n\n"));
    }
}

#[test]
fn every_wrong_program_of_a_page_has_only_its_diagnostic() {
    for &code in Code::ALL {
        let Some(program) = fence(code.page(), "Wrong:") else {
            assert!(
                WITHOUT.iter().any(|(without, _)| *without == code),
                "the page of `{code}` has no wrong program"
            );
            continue;
        };
        let codes = codes(&text(program));
        assert_eq!(codes, [code], "the wrong program of `{code}`");
    }
}

#[test]
fn every_right_program_of_a_page_has_no_diagnostic() {
    for &code in Code::ALL {
        let program = fence(code.page(), "Right:");
        assert_eq!(
            program.is_some(),
            fence(code.page(), "Wrong:").is_some() || code == Code::TooDeep,
            "the page of `{code}`"
        );
        if let Some(program) = program {
            // Small programs are crowded, and a narrow gap is not the topic of the page.
            let mut codes = codes(&text(program));
            let of_space = [Code::TightApproach, Code::CrowdedCaptures];
            codes.retain(|&found| !of_space.contains(&found) || code == found);
            assert_eq!(codes, [], "the right program of `{code}`");
        }
    }
}

#[test]
fn bytes_that_are_not_text() {
    let mut reader = |_: &str| Ok(b"let n = 3 // caf\xe9".to_vec());
    assert_eq!(codes(&checked("a.sa", &mut reader)), [Code::NotUtf8]);
}

#[test]
fn braces_and_parentheses_too_deep() {
    let braces = "for i in 1..1 {".repeat(200);
    let program = format!("assembly a {{ phase p {{ {braces}");
    assert!(codes(&text(&program)).contains(&Code::TooDeep));
    let nested = |depth: usize| {
        let sum = format!("{}1{}", "(".repeat(depth), ")".repeat(depth));
        codes(&text(&format!("let n = {sum}")))
    };
    assert!(!nested(100).contains(&Code::TooDeep));
    for depth in [101, 120] {
        assert_eq!(nested(depth), [Code::TooDeep]);
    }
}

#[test]
fn patterns_too_deep() {
    let mut program = String::new();
    for depth in 0..300 {
        let next = depth + 1;
        program.push_str(&format!(
            "pattern p{depth}(base) {{ base.up -> T p{next}(T) }}\n"
        ));
    }
    program.push_str("pattern p300(base) { base.up -> T }\n");
    program.push_str("assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { p0(M) } }");
    assert!(codes(&text(&program)).contains(&Code::TooDeep));
}

#[test]
fn a_statement_too_long() {
    let mut program = "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M".to_owned();
    let mut number = 0;
    while program.len() < 9 << 20 {
        number += 1;
        program.push_str(&format!(".up -> T{number}"));
    }
    program.push_str(" } }");
    assert!(codes(&text(&program)).contains(&Code::StatementTooLong));
}

#[test]
fn too_many_errors() {
    let codes = codes(&text(&format!("let n = 1\n{}", "?\n".repeat(200))));
    assert_eq!(codes.len(), 101);
    assert_eq!(codes.last(), Some(&Code::TooManyErrors));
}

#[test]
fn a_text_that_is_not_a_program() {
    let prose =
        "# Notes\n\nThis text, and its lists, are not a program.\n- one\n- two\n- three\n- four\n";
    let program =
        "assembly a {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase p { M.up -> A }\n}\n";
    let title = |text: &str| {
        Some(
            files(&[("notes.md", text)], "notes.md")
                .diagnostics
                .first()?
                .title
                .clone(),
        )
    };
    for text in [prose.to_owned(), format!("{prose}\n```sa\n{program}```\n")] {
        let checked = files(&[("notes.md", &text)], "notes.md");
        assert_eq!(codes(&checked), [Code::Syntax], "{text}");
        assert_eq!(
            title(&text).unwrap(),
            "`notes.md` does not look like a program"
        );
    }
    // A program with errors has all its diagnostics.
    let broken = format!("{program}{prose}");
    assert!(codes(&text(&broken)).len() > 4);
}

#[test]
fn a_file_that_is_missing() {
    assert_eq!(
        codes(&files(&[("x/a.sa", "import \"../b.sa\"")], "x/a.sa")),
        [Code::ImportMissing]
    );
    assert_eq!(codes(&files(&[], "a.sa")), [Code::ImportMissing]);
}

#[test]
fn files_that_import_each_other() {
    let circle = [
        ("a.sa", "import \"x/b.sa\""),
        ("x/b.sa", "import \"../c.sa\""),
        ("c.sa", "import \"./a.sa\""),
    ];
    let checked = files(&circle, "a.sa");
    assert_eq!(codes(&checked), [Code::ImportCycle]);
    assert_eq!(checked.diagnostics[0].labels.len(), 3);
    assert_eq!(
        codes(&files(&[("a.sa", "import \"a.sa\"")], "a.sa")),
        [Code::ImportCycle]
    );
}

#[test]
fn a_program_that_grows_too_large() {
    let limits = Limits {
        events: 100,
        steps: 10_000,
        ..Limits::default()
    };
    let program = |statements: &str| {
        let mut reader = |_: &str| {
            Ok(format!(
                "assembly a {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ {statements} }} }}"
            )
            .into_bytes())
        };
        codes(&check("a.sa", &mut reader, limits))
    };
    assert_eq!(program("M.up ->> T[1..13]"), []);
    assert_eq!(program("M.up ->> T[1..130]"), [Code::ExpansionLimit]);
    assert!(program("for i in 1..200 { M.up -> T[i] }").contains(&Code::ExpansionLimit));
    assert_eq!(
        program("M.up -> A for i in 1..100000 { }"),
        [Code::ExpansionLimit]
    );
}

#[test]
fn equal_diagnostics_in_two_places_are_not_merged() {
    let program = "scene a from hemisphere { tick 1m }\nscene b from hemisphere { tick 1m }";
    assert_eq!(codes(&text(program)), [Code::WrongDimension; 2]);
}

#[test]
fn misplaced_seeds_have_one_diagnostic() {
    let no_plate = "assembly a { phase p { A at (0, 0) } }";
    assert!(codes(&text(no_plate)).contains(&Code::Misplaced));
    let release_first = "assembly a {
        seed plate 2 x 1 { M at (0, 0)  M.up -> X  release X  N at (1, 0) }
        phase p { M.up -> N }
    }";
    assert!(codes(&text(release_first)).contains(&Code::Misplaced));
    // A pre-attached block may be between seeds and does not change which blocks are seeds.
    let captured_twice = "assembly a {
        seed plate 2 x 1 { M at (0, 0)  M.up -> X  N at (1, 0) }
        phase p { X.up -> N }
    }";
    let found = codes(&text(captured_twice));
    assert_eq!(found, [Code::CapturedTwice]);
}

#[test]
fn misplaced_phases_and_plates_have_one_diagnostic() {
    let in_pattern = "pattern t(b) {
        seed plate 1 x 1 { N at (0, 0) }
        phase inner { b.up -> X }
    }
    assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { t(M) as k } phase q { k.X.up -> Y } }";
    assert_eq!(codes(&text(in_pattern)), [Code::Misplaced; 2]);
    let in_phase = "assembly a {
        seed plate 1 x 1 { M at (0, 0) }
        phase p { M.up -> X  phase q { X.up -> Y }  Y.up -> Z }
        phase r { Z.up -> W }
    }";
    assert_eq!(codes(&text(in_phase)), [Code::Misplaced]);
}

#[test]
fn a_face_used_as_a_name_is_reported_once_per_use() {
    let seeds = "seed plate 1 x 1 { M at (0, 0) }";
    let pattern = "pattern t(base) { base.up -> T }";
    for (text, expected) in [
        (
            format!("assembly a {{ {seeds} phase down {{ M.up -> A }} }}"),
            1,
        ),
        (
            "assembly a { seed plate 1 x 1 { up at (0, 0) } phase p { up.up -> A } }".to_owned(),
            2,
        ),
        (
            format!("{pattern} assembly a {{ {seeds} phase p {{ t(M) as up }} }}"),
            1,
        ),
        (
            format!("assembly a {{ {seeds} phase p {{ M.up -> down[1] }} }}"),
            1,
        ),
    ] {
        let found = codes(&self::text(&text));
        assert_eq!(found, vec![Code::ReservedWord; expected], "{text}");
    }
    for text in [
        format!("assembly a {{ {seeds} phase p {{ up.M -> A }} }}"),
        format!("assembly a {{ {seeds} phase p.up {{ M.up -> A }} }}"),
        format!("assembly a {{ {seeds} phase p {{ M.up.up -> A }} }}"),
    ] {
        assert_eq!(codes(&self::text(&text)), [Code::FaceMisused], "{text}");
    }
}

#[test]
fn a_missing_statement_may_use_a_seed() {
    let found = codes(&text(
        "shape gate { layer 1 {\n # #\n} }
        assembly keep { seed plate 2 x 1 { A at (0, 0) B at (1, 0) } phase rest { A.up -> L yields gate } }",
    ));
    assert_eq!(found, [Code::ShapeMismatch]);
}

#[test]
fn a_structure_contains_a_shape() {
    for (claim, row, expected) in [
        ("yields gate", "# #", &[][..]),
        ("yields at least gate", "# #", &[]),
        ("yields at least gate", "# .", &[]),
        ("yields gate", "# .", &[Code::ShapeMismatch]),
        ("yields at least gate", "# # #", &[Code::ShapeMismatch]),
        (
            "yields gate yields at least gate",
            ". #",
            &[Code::ShapeMismatch],
        ),
        ("yields at least other", "# #", &[Code::UnknownName]),
    ] {
        let text = format!(
            "shape gate {{ layer 1 {{\n {row}\n}} }}
            assembly a {{
                seed plate 2 x 1 {{ A at (0, 0) B at (1, 0) }}
                phase grow {{ A.up -> L B.up -> R {claim} }}
            }}"
        );
        assert_eq!(codes(&self::text(&text)), expected, "{text}");
    }
}

#[test]
fn a_shape_can_have_any_name() {
    let text = "shape least { layer 1 {\n #\n} }
        assembly a {
            seed plate 1 x 1 { A at (0, 0) }
            phase grow { A.up -> L yields least yields at least least }
        }";
    assert_eq!(codes(&self::text(text)), []);
}

#[test]
fn an_after_needed_in_one_iteration_is_not_redundant() {
    let program = |rounds: &str| {
        codes(&text(&format!(
            "assembly m {{
                seed plate 7 x 1 {{ for i in 0..3 {{ A[i] at (2 * i, 0) }} }}
                phase p {{ A[0].up -> X[0] A[3].up -> X[3] }}
                phase r {{ for i in {rounds} {{ A[i].up -> X[i] after X[i - 1] }} }}
            }}"
        )))
    };
    // The second round does not use its seed there.
    assert_eq!(program("1..2"), []);
    assert_eq!(program("1..1"), [Code::UnusedSeed, Code::RedundantAfter]);
}

#[test]
fn angles_are_limited_to_a_right_angle() {
    let scene = |degrees: &str| {
        codes(&text(&format!(
            "scene s from hemisphere {{
                bond attract {{ pull 1 N within 1m  anchor gap 1mm tilt {degrees} deg }}
            }}"
        )))
    };
    assert_eq!(scene("90"), []);
    assert_eq!(scene("90.001"), [Code::WrongValue]);
}

#[test]
fn tiny_probabilities_are_out_of_range() {
    let scene = |dead: &str| {
        codes(&text(&format!(
            "scene s from hemisphere {{ faults {{ dead {dead} }} }}"
        )))
    };
    assert_eq!(scene("0"), []);
    assert_eq!(scene("1e-60"), [Code::WrongValue]);
    assert_eq!(scene("1e60"), [Code::WrongValue]);
}

/// Returns the program after a line of a page, such as `Wrong:`.
fn fence<'a>(page: &'a str, title: &str) -> Option<&'a str> {
    let (_, rest) = page.split_once(&format!("\n{title}\n\n```sa\n"))?;
    rest.split_once("```").map(|(program, _)| program)
}

fn codes(checked: &Checked) -> Vec<Code> {
    checked
        .diagnostics
        .iter()
        .map(|diagnostic| diagnostic.code)
        .collect()
}

fn text(program: &str) -> Checked {
    files(&[("page.sa", program)], "page.sa")
}

/// Checks one of several files that exist only in memory.
fn files(files: &[(&str, &str)], path: &str) -> Checked {
    let files: BTreeMap<&str, &str> = files.iter().copied().collect();
    let mut reader = |path: &str| {
        let text = files.get(path).ok_or(std::io::ErrorKind::NotFound)?;
        Ok(text.as_bytes().to_vec())
    };
    checked(path, &mut reader)
}

fn checked(path: &str, reader: &mut dyn FnMut(&str) -> std::io::Result<Vec<u8>>) -> Checked {
    check(path, &mut |path: &str| reader(path), Limits::default())
}

#[test]
fn a_program_without_a_bond_can_capture_nothing() {
    let text = "scene s { tick 1 s block cube { side 1 m mass 1 kg } free 3 uniform \
                enclosure hemisphere { radius 1 km wall 1 N/m } }\n\
                assembly a in s { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> N } }";
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let checked = stochc_compiler::check("a.sa", &mut reader, Default::default());
    let codes: Vec<_> = checked
        .diagnostics
        .iter()
        .map(|diagnostic| diagnostic.code.name())
        .collect();
    assert_eq!(codes, ["missing-term"]);
}

#[test]
fn missing_clauses_are_one_diagnostic_with_a_template_that_can_be_pasted() {
    let program = |clauses: &str| {
        let text = format!(
            "scene s {{ {clauses} bond attract {{ pull 15 N within 20 cm  anchor centres 1 mm }} }}\n\
             assembly a in s {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> N }} }}"
        );
        self::text(&text).diagnostics
    };
    for (clauses, title) in [
        (
            "",
            "scene `s` lacks `tick`, `block`, `free` and `enclosure`",
        ),
        (
            "tick 1 s free 5 uniform",
            "scene `s` lacks `block` and `enclosure`",
        ),
    ] {
        let found = program(clauses);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].title, title);
        let help = found[0].help.as_deref().unwrap();
        let template = help.lines().filter_map(|line| line.strip_prefix("    "));
        let template: Vec<&str> = template.collect();
        let found = program(&format!("{clauses} {}", template.join(" ")));
        let errors = found.iter().filter(|it| it.code.name() == "missing-term");
        assert_eq!(errors.count(), 0, "{found:?}");
    }
    let found = program("tick 1 s block cube { } free 5 uniform enclosure hemisphere { }");
    let titles: Vec<&str> = found.iter().map(|it| it.title.as_str()).collect();
    assert_eq!(
        titles,
        [
            "`block` lacks `side` and `mass`",
            "`enclosure` lacks `radius` and `wall`"
        ]
    );
}

#[test]
fn a_statement_with_repeated_mistakes_is_reported_once() {
    let program = |seeds: &str, statement: &str| {
        let text = format!(
            "assembly a {{ seed plate 20 x 1 {{ {seeds} }} phase p {{ S.up -> B {statement} }} }}"
        );
        let diagnostics = self::text(&text).diagnostics;
        diagnostics
            .iter()
            .map(|diagnostic| diagnostic.message())
            .collect::<Vec<_>>()
    };
    let seed = "S at (19, 0)";
    let rest = "; the same for `T[3]`, `T[4]` and 399997 more";
    let all = program(seed, "for i in 1..400000 { S.up -> T[i + 1] }");
    assert_eq!(
        all,
        [format!("`B` and `T[2]` both take cell (19, 0, 1){rest}")]
    );
    assert_eq!(
        program(
            seed,
            "for i in 1..500 { X[i].up -> Y[i] }  B.up -> C after D[1..500]"
        ),
        [
            "cannot find block `X[1]`; the same for `X[2]`, `X[3]` and 497 more",
            "cannot find block `D[1]`; the same for `D[2]`, `D[3]` and 497 more",
        ]
    );
    assert_eq!(
        program(&format!("for i in 0..11 {{ M[i] at (i, 0) }} {seed}"), ""),
        ["seed `M[0]` is never used; the same for `M[1]`, `M[2]` and 9 more"]
    );
    assert_eq!(
        program(&format!("for i in 18..22 {{ M[i] at (i, 0) }} {seed}"), "")[0],
        "position (20, 0) is not on the plate; the same for (21, 0) and (22, 0)"
    );
}

#[test]
fn a_statement_with_repeated_mistakes_hides_no_other() {
    let text = text(
        "assembly a { seed plate 1 x 1 { M at (0, 0) }
        phase p { M.up -> A  for i in 1..100000 { X[i].up -> Y[i] } }
        phase q { A.up -> B  for i in 1..100000 { A.up -> T[i] } C.up -> D } }",
    );
    assert_eq!(
        codes(&text),
        [Code::UnknownName, Code::OccupiedCell, Code::UnknownName]
    );
}

/// Returns the title, help and labels of the only diagnostic of a program with a seed M.
fn only(declarations: &str, phase: &str) -> (String, String, Vec<String>) {
    let text = text(&format!(
        "{declarations} assembly a {{ seed plate 2 x 1 {{ M at (0, 0)  N at (1, 0) }}
        phase p {{ {phase} }} }}"
    ));
    let [diagnostic] = &text.diagnostics[..] else {
        panic!("{:#?}", text.diagnostics);
    };
    let labels = diagnostic.labels.iter().map(|label| {
        let place = text.sources.text(label.location);
        format!("{place}: {}", label.text)
    });
    let help = diagnostic.help.clone().unwrap_or_default();
    (diagnostic.message(), help, labels.collect())
}

const TOWER: &str = "pattern tower(base, height) { base.up ->> T[1..height] }";

const LONG_ARM: &str = "pattern arm(base, side, length) { base.side ->> T[1..length] }";
const ARM: &str = "pattern arm(base, side) { base.side -> T }";

/// Mistakes with names and arguments: patterns and numbers, and a phase with one mistake.
const NAMES_AND_ARGUMENTS: [(&str, &str); 24] = [
    // Swapped arguments. An argument in parentheses moves as a whole.
    (TOWER, "tower(3, M)  N.up -> A"),
    (TOWER, "tower((1 + 0) * 3, M)  N.up -> A"),
    (TOWER, "tower(-(1 - 4), M)  N.up -> A"),
    (TOWER, "tower(3 * (0 + 1), M)  N.up -> A"),
    (TOWER, "tower((((3))), M)  N.up -> A"),
    // One argument happens to be valid, or another pattern uses it, or there are three arguments.
    (
        "pattern tower(base, spare) { base.up -> T }",
        "tower(3, M)  N.up -> A",
    ),
    (
        "pattern tower(base, height) { base.up ->> T[1..height] } pattern outer(h, b) { tower(b, h) }",
        "outer(M, 3)  N.up -> A",
    ),
    (LONG_ARM, "arm(2, M, up)  N.up -> A"),
    // Arguments of the wrong kind. An unknown name is misspelt.
    (TOWER, "tower(M, N)"),
    (TOWER, "tower(up, 3) M.up -> A N.up -> B"),
    (
        "pattern tower(base, height) { base.up ->> T[1..height] } let length = 3",
        "tower(M, lenght)  N.up ->> A[1..length]",
    ),
    (ARM, "arm(M, top)  N.up -> A"),
    (ARM, "arm(M, N)"),
    // Members of a range.
    ("", "M.up ->> T[1..3]  N.up -> A T[4].up -> X"),
    ("", "M.up ->> T[1..3]  N.up -> A T.up -> X"),
    ("", "M.up ->> T[1..3]  N.up -> A A[1].up -> X"),
    (
        "",
        "M.up ->> T[1..3]  N.up -> A for i in 3..6 { T[i].east -> U[i] }",
    ),
    (
        TOWER,
        "for i in 1..1 { tower(M, 2) as t[i] tower(N, 2) as t[3] }  t[2].T[1].east -> X",
    ),
    // Names that a pattern cannot use: a block, a block of the outer pattern, a counter, an
    // instance.
    (
        "pattern arm(base, n) { base.up -> T[n]  M.up -> V }",
        "arm(N, 2) as x",
    ),
    ("pattern arm() { T[1].up -> V }", "N.up -> T[1]  arm()"),
    (
        "pattern inner(b) { b.up -> U  T.up -> V } pattern outer(b) { b.up -> T  inner(T) }",
        "outer(M)  N.up -> A",
    ),
    (
        "pattern tower(base, height) { base.up ->> T[1..k] }",
        "for k in 1..1 { tower(M, k) }",
    ),
    (
        "pattern tower(base, height) { base.up ->> T[1..height] } pattern on(b) { b.up -> U  x.T[1].east -> V }",
        "tower(M, 2) as x  on(N)",
    ),
    // A name in an instance does not refer to a block outside of it.
    (TOWER, "tower(M, 2) as x  x.N.up -> A"),
];

#[test]
fn messages_about_names_and_arguments_are_unchanged() {
    let mut all = String::new();
    for (declarations, phase) in NAMES_AND_ARGUMENTS {
        let (message, help, labels) = only(declarations, phase);
        let labels = labels.join("\n  ");
        writeln!(
            all,
            "{declarations}\nphase p {{ {phase} }}\n{message}\n  {labels}\n{help}\n"
        )
        .unwrap();
    }
    insta::assert_snapshot!(all);
}

#[test]
fn parameters_of_unclear_kind_accept_anything() {
    let free = "pattern free(base, spare) { base.up -> T }";
    let codes = |text: &str| self::codes(&self::text(text));
    let program = |pattern: &str, phase: &str| {
        format!(
            "{pattern} assembly a {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ {phase} }} }}"
        )
    };
    for spare in ["3", "M", "up", "nothing"] {
        assert_eq!(codes(&program(free, &format!("free(M, {spare})"))), []);
    }
    let both = "pattern both(x) { x.up ->> T[1..x] }";
    assert_eq!(codes(&program(both, "both(M)")), [Code::WrongKind]);
    // A counter or a local number is not a parameter.
    let hidden = "pattern hidden(x, y) { x.up -> A for y in 1..1 { A.up -> B[y] } let x = 1 B[x].up -> C y.up -> D }";
    assert_eq!(
        codes(&program(hidden, "M.up -> N M.up -> N")),
        [Code::CapturedTwice]
    );
}

#[test]
fn children_of_a_wrong_instance_are_not_reported() {
    for wrong in ["tower(3, M)", "tower(M)", "tower(M, N)", "tower(M, 3, 3)"] {
        let text = text(&format!(
            "{TOWER} assembly a {{ seed plate 2 x 1 {{ M at (0, 0)  N at (1, 0) }}
            phase p {{ {wrong} as t }} phase q {{ t.T[1].up -> A after t.T[2]  release t.T[3] }} }}"
        ));
        assert_eq!(text.diagnostics.len(), 1, "{:#?}", text.diagnostics);
    }
}

#[test]
fn a_number_is_defined_after_its_let() {
    let below = |text: &str, name: &str| {
        let checked = self::text(text);
        let diagnostic = &checked.diagnostics[0];
        assert_eq!(
            diagnostic.message(),
            format!("`{name}` is used before its `let`"),
            "{text}"
        );
        diagnostic.labels.last().map(|label| label.text.clone())
    };
    let known = Some("declared here".to_owned());
    let plate = "seed plate 1 x 1 { M at (0, 0) }";
    let phase = format!("assembly a {{ {plate} phase p {{ M.up ->> T[1..n] let n = 3 }} }}");
    assert_eq!(below(&phase, "n"), known);
    let own = format!("assembly a {{ {plate} phase p {{ M.up ->> T[1..n] }} let n = 3 }}");
    assert_eq!(below(&own, "n"), known);
    let file =
        format!("let m = n let n = 3 assembly a {{ {plate} phase p {{ M.up ->> T[1..m] }} }}");
    assert_eq!(below(&file, "n"), known);
    let pattern = format!(
        "pattern t(b) {{ b.up ->> T[1..n] }} assembly a {{ {plate} phase p {{ t(M) }} let n = 3 }}"
    );
    assert_eq!(below(&pattern, "n"), known);
    let itself = format!("let n = n + 1 assembly a {{ {plate} phase p {{ M.up ->> T[1..n] }} }}");
    assert_eq!(
        below(&itself, "n"),
        Some("it is part of its own value".to_owned())
    );
}

#[test]
fn a_scene_may_override_the_built_in_one() {
    let program = "scene hemisphere from hemisphere { free 5 uniform }
        assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up ->> A[1..6] } }";
    assert_eq!(codes(&text(program)), [Code::TooFewBlocks]);
    let program = "scene other from other { free 5 uniform }";
    assert_eq!(codes(&text(program)), [Code::UnknownScene]);
}

/// Changes in helps that are not fixes: the old and the new source. The help names the new source.
const FOLLOWED: [(Code, &str, &str); 12] = [
    (Code::OutOfPlane, "M.up", "M.north"),
    (
        Code::NumberTooLarge,
        "10000000000000000000",
        "9223372036854775807",
    ),
    (Code::TooFewBlocks, "free 10 uniform", "free 13 uniform"),
    (Code::CannotAggregate, "pair to", "pair in magnet_tank to"),
    (
        Code::MissingPlate,
        "assembly tower {",
        "assembly tower { seed plate 3 x 3 { M at (1, 1) }",
    ),
    (Code::ShapeMalformed, "layer 0..1", "layer 1..2"),
    (Code::UnusedShape, "T[1..3] }", "T[1..2] yields pair }"),
    (
        Code::UnusedScene,
        "assembly tower",
        "assembly tower in crowded",
    ),
    (
        Code::UnplannedBond,
        "seed plate",
        "allow unplanned-bond \"reason\" seed plate",
    ),
    (Code::BlockedRelease, "release B", "release C  release B"),
    (Code::NoAgitation, "0 .. 0 m/s", "0 .. 0.8 m/s"),
    (Code::ShortTimeout, "300 ticks", "3700 ticks"),
];

/// Codes whose help is not a change of the source, with the reason.
const ADVICE: [(Code, &str); 28] = [
    (
        Code::InvalidHandler,
        "what the phase should do after a timeout is not known",
    ),
    (Code::WrongKind, "either of two things may be renamed"),
    (Code::WrongArguments, "the argument is not known"),
    (Code::Arithmetic, "the intention is not known"),
    (Code::RecursivePattern, "the intention is not known"),
    (Code::ExpansionLimit, "the intention is not known"),
    (
        Code::SeedOutsidePlate,
        "the seed or the plate may be meant otherwise",
    ),
    (Code::AbsentBlock, "where to capture it is not known"),
    (Code::BelowPlate, "the structure is another one"),
    (Code::ShapeMismatch, "a picture of the difference"),
    (
        Code::OutsideEnclosure,
        "the structure or the scene may change",
    ),
    (
        Code::TooManyBlocks,
        "the blocks or the enclosure may change",
    ),
    (Code::MissingTerm, "how large the side is, is not known"),
    (Code::DuplicateTerm, "either of the two may go"),
    (Code::ConflictingTerms, "either of the two may go"),
    (Code::WrongDimension, "the value is not known"),
    (Code::WrongValue, "the value is not known"),
    (Code::Misplaced, "a phase needs a name"),
    (Code::OccupiedCell, "the intention is not known"),
    (Code::TightApproach, "the order of phases is the author's"),
    (Code::CrowdedCaptures, "the order of phases is the author's"),
    (Code::EmptyPhase, "a loop or the phase may be wrong"),
    (Code::BuoyantBlocks, "the scene is the author's"),
    (Code::CoarseStep, "steps are an option of a run"),
    (Code::SoftContact, "the scene is the author's"),
    (
        Code::OverloadedBond,
        "the structure or the scene may change",
    ),
    (Code::WrongClaim, "the intention is not known"),
    (Code::StokesDrag, "the density of the fluid is not known"),
];

/// Returns a text with the change of one of its diagnostics.
fn followed(checked: &Checked, diagnostic: &Diagnostic) -> Option<String> {
    let text = &checked.sources.files()[0].text;
    let mut change = TextChange::new(FileId(0), text);
    let fix = diagnostic.fix.as_ref()?;
    assert!(change.add(fix), "{fix:?}");
    // Every unclosed block needs its own brace.
    let others = checked.diagnostics.iter().filter(|it| *it != diagnostic);
    let others = others.filter(|it| it.code == Code::UnclosedBrace && it.code == diagnostic.code);
    others.filter_map(|it| it.fix.as_ref()).for_each(|fix| {
        change.add(fix);
    });
    Some(change.text())
}

/// Checks that the change of each diagnostic resolves it and breaks no valid part of the program.
fn assert_changes_hold(program: &str) {
    let checked = text(program);
    for diagnostic in &checked.diagnostics {
        let Some(changed) = followed(&checked, diagnostic) else {
            continue;
        };
        let after = text(&changed);
        // Another mistake of the same line may appear.
        let count = |checked: &Checked| {
            let alike = checked.diagnostics.iter();
            let alike = alike.filter(|it| it.code == diagnostic.code);
            let alike = alike.filter(|it| it.message() == diagnostic.message());
            alike.count()
        };
        let context = format!(
            "{}: {:?}\n{changed}\n{:#?}",
            diagnostic.code,
            diagnostic.help,
            codes(&after)
        );
        assert!(count(&after) < count(&checked), "{context}");
        let syntax = |checked: &Checked| {
            codes(checked)
                .iter()
                .filter(|&&it| it == Code::Syntax)
                .count()
        };
        assert!(syntax(&after) <= syntax(&checked), "{context}");
    }
}

/// Checks that every code has a page. Applies the help of its invalid program, which is a fix or a
/// change in `FOLLOWED`.
#[test]
#[allow(
    clippy::disallowed_methods,
    reason = "it reads the programs of tests/findings"
)]
fn fixes_of_helps_work() {
    for &code in Code::ALL {
        let Some(program) = fence(code.page(), "Wrong:") else {
            continue;
        };
        assert_changes_hold(program);
        let checked = text(program);
        let diagnostic = &checked.diagnostics[0];
        let manual = FOLLOWED.iter().find(|(of, ..)| *of == code);
        let is_advice = ADVICE.iter().any(|(of, _)| *of == code);
        let is_tried = diagnostic.fix.is_some() || manual.is_some();
        assert!(is_tried != is_advice, "{code}: {:?}", diagnostic.help);
        if let Some(changed) = followed(&checked, diagnostic) {
            assert!(!codes(&text(&changed)).contains(&code), "{code}: {changed}");
        }
        if let Some((_, old, new)) = manual {
            let help = diagnostic.help.as_deref().unwrap();
            // The shape determines the length of a row.
            let is_new = |word: &&str| !program.contains(word) && !word.starts_with("T[");
            let words = new.split_whitespace().filter(is_new);
            words.for_each(|word| assert!(help.contains(word), "{code}: `{word}` in `{help}`"));
            assert!(program.contains(old), "{code}");
            let after = codes(&text(&program.replacen(old, new, 1)));
            assert!(!after.contains(&code), "{code}: {after:?}");
        }
    }
    for file in std::fs::read_dir("../tests/findings").unwrap() {
        let path = file.unwrap().path();
        assert_changes_hold(&std::fs::read_to_string(path).unwrap());
    }
}

/// Returns the help and the changed source for the only diagnostic of a phase with the seeds M and
/// N.
fn help_tried(phase: &str) -> (String, String) {
    let program = |phase: &str| {
        format!(
            "assembly a {{ seed plate 2 x 1 {{ M at (0, 0)  N at (1, 0) }} phase p {{ {phase} }} }}"
        )
    };
    let whole = program(phase);
    assert_changes_hold(&whole);
    let checked = text(&whole);
    let [diagnostic] = &checked.diagnostics[..] else {
        panic!("{:#?}", checked.diagnostics);
    };
    let changed = followed(&checked, diagnostic).unwrap_or_default();
    (diagnostic.help.clone().unwrap_or_default(), changed)
}

/// Phases with one mistake whose help is a change of the source or advice.
const HELPED: [&str; 11] = [
    // A seed cannot be captured. The block gets a free name.
    "M.up -> N",
    "M.up -> A N.up -> A A.up -> A_2",
    "M.up -> A for i in 1..2 { N.up -> B }",
    // Rounds that fill the same cell are rewritten as a row. Other loops are not.
    "N.up -> A for i in 1..3 { M.up -> L[i] }",
    "N.up -> A for i in 1..3 { M.up -> L[2 * i] }",
    // The `after` of a chain applies to its first capture.
    "N.up -> X M.up -> C.up -> D after C",
    "N.up -> X M.up -> A after A",
    "M.up -> A after B  N.up -> B after A",
    // A timeout is part of a phase.
    "N.up -> X M.up -> A timeout 50 s",
    "N.up -> X M.up -> A timeout 60s",
    "N.up -> X M.up -> A timeout 2500 ticks",
];

#[test]
fn offered_changes_are_unchanged_and_work() {
    let mut all = String::new();
    for phase in HELPED {
        let (help, changed) = help_tried(phase);
        let left: Vec<_> = codes(&text(&changed))
            .iter()
            .map(|code| code.name())
            .collect();
        writeln!(all, "{phase}\n{help}\n{changed}\nleft: {left:?}\n").unwrap();
    }
    insta::assert_snapshot!(all);
}

#[test]
fn a_loop_outside_of_phases_is_reported_with_its_place() {
    let text = text(
        "assembly a { seed plate 3 x 1 { for i in 0..2 { M[i] at (i, 0) } }
        for i in 0..2 { M[i].up -> A[i] }
        phase p { } }",
    );
    let diagnostic = &text.diagnostics[0];
    assert_eq!(
        diagnostic.title,
        "a capture must be inside a phase or a pattern"
    );
    assert_eq!(
        diagnostic.help.as_deref(),
        Some("move the loop into a phase or a pattern")
    );
}

#[test]
fn distances_are_shown_with_differing_digits() {
    let page = fence(Code::OutsideEnclosure.page(), "Wrong:").unwrap();
    let label = text(page).diagnostics[0].labels[0].text.clone();
    let (_, distances) = label.split_once(" reaches ").unwrap();
    let (reached, limit) = distances
        .split_once(" m from the centre, the radius is ")
        .unwrap();
    let metres = |text: &str| text.trim_end_matches(" m").parse::<f64>().unwrap();
    assert!(metres(reached) > metres(limit), "{label}");
}

/// The title names the block, and the help closes it at the end of the indentation.
#[test]
fn an_unclosed_brace_is_named() {
    let program = "assembly one {
    seed plate 1 x 1 { M at (0, 0) }
    phase p { M.up -> A }

assembly two {
    seed plate 1 x 1 { M at (0, 0) }
    phase p { M.up -> A }
}
";
    let checked = text(program);
    let unclosed = checked
        .diagnostics
        .iter()
        .find(|it| it.code == Code::UnclosedBrace);
    let unclosed = unclosed.unwrap();
    assert_eq!(unclosed.title, "missing `}` for `assembly one`");
    let changed = followed(&checked, unclosed).unwrap();
    assert_eq!(codes(&text(&changed)), [], "{changed}");
}
