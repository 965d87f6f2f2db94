//! Every page of `stochc explain` shows what it speaks of.
use std::collections::BTreeMap;

use stochc::compiler::finding::Code;
use stochc::compiler::{Checked, Limits, check};

/// Pages without a wrong program, and why.
const WITHOUT: [(Code, &str); 8] = [
    (Code::NotUtf8, "a page is UTF-8 itself"),
    (Code::FileTooLarge, "4 GiB are too many for a test as well"),
    (Code::TooDeep, "a hundred braces on a page help nobody"),
    (Code::StatementTooLong, "a statement of 4 MiB"),
    (Code::TooManyErrors, "a hundred errors"),
    (Code::ReachUndecided, "a hall of a million blocks"),
    (Code::ImportMissing, "a fence has no files beside it"),
    (Code::ImportCycle, "a fence has no files beside it"),
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
fn every_wrong_program_of_a_page_has_its_finding_and_no_other() {
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
fn every_right_program_of_a_page_has_no_finding() {
    for &code in Code::ALL {
        let program = fence(code.page(), "Right:");
        assert_eq!(
            program.is_some(),
            fence(code.page(), "Wrong:").is_some() || code == Code::TooDeep,
            "the page of `{code}`"
        );
        if let Some(program) = program {
            // A small program is a crowded one; a narrow gap is not what the page is about.
            let mut codes = codes(&text(program));
            codes.retain(|&found| found != Code::TightApproach || code == Code::TightApproach);
            assert_eq!(codes, [], "the right program of `{code}`");
        }
    }
}

#[test]
fn bytes_that_are_no_text() {
    let mut reader = |_: &str| Ok(b"let n = 3 // caf\xe9".to_vec());
    assert_eq!(codes(&checked("a.sa", &mut reader)), [Code::NotUtf8]);
}

#[test]
fn braces_and_parentheses_too_deep() {
    let braces = "for i in 1..1 {".repeat(200);
    let program = format!("assembly a {{ phase p {{ {braces}");
    assert!(codes(&text(&program)).contains(&Code::TooDeep));
    let sum = format!("{}1{}", "(".repeat(120), ")".repeat(120));
    assert_eq!(codes(&text(&format!("let n = {sum}"))), [Code::TooDeep]);
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
    let codes = codes(&text(&"?\n".repeat(200)));
    assert_eq!(codes.len(), 101);
    assert_eq!(codes.last(), Some(&Code::TooManyErrors));
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
    assert_eq!(checked.findings[0].labels.len(), 3);
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
fn equal_findings_in_two_places_are_two() {
    let program = "scene a from hemisphere { tick 1m }\nscene b from hemisphere { tick 1m }";
    assert_eq!(codes(&text(program)), [Code::WrongDimension; 2]);
}

#[test]
fn misplaced_seeds_are_misplaced_and_nothing_worse() {
    let no_plate = "assembly a { phase p { A at (0, 0) } }";
    assert!(codes(&text(no_plate)).contains(&Code::Misplaced));
    let release_first = "assembly a {
        seed plate 2 x 1 { M at (0, 0)  M.up -> X  release X  N at (1, 0) }
        phase p { M.up -> N }
    }";
    assert!(codes(&text(release_first)).contains(&Code::Misplaced));
    // A block that is attached by hand may stand between seeds, and does not change who they are.
    let captured_twice = "assembly a {
        seed plate 2 x 1 { M at (0, 0)  M.up -> X  N at (1, 0) }
        phase p { X.up -> N }
    }";
    let found = codes(&text(captured_twice));
    assert_eq!(found, [Code::UnusedSeed, Code::CapturedTwice]);
}

#[test]
fn phases_and_plates_in_patterns_and_phases_are_misplaced_and_nothing_worse() {
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
fn degrees_reach_a_right_angle() {
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

/// The program behind a line of a page, such as `Wrong:`.
fn fence<'a>(page: &'a str, title: &str) -> Option<&'a str> {
    let (_, rest) = page.split_once(&format!("\n{title}\n\n```sa\n"))?;
    rest.split_once("```").map(|(program, _)| program)
}

fn codes(checked: &Checked) -> Vec<Code> {
    checked
        .findings
        .iter()
        .map(|finding| finding.code)
        .collect()
}

fn text(program: &str) -> Checked {
    files(&[("page.sa", program)], "page.sa")
}

/// Checks one of several files that exist in memory only.
fn files(files: &[(&str, &str)], path: &str) -> Checked {
    let files: BTreeMap<&str, &str> = files.iter().copied().collect();
    let mut reader = |path: &str| {
        let text = files.get(path).ok_or("no such file")?;
        Ok(text.as_bytes().to_vec())
    };
    checked(path, &mut reader)
}

fn checked(path: &str, reader: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>) -> Checked {
    check(path, &mut |path: &str| reader(path), Limits::default())
}

#[test]
fn a_program_without_a_bond_can_capture_nothing() {
    let text = "scene s { tick 1 s block cube { side 1 m mass 1 kg } free 3 uniform \
                enclosure hemisphere { radius 1 km wall 1 N/m } }\n\
                assembly a in s { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> N } }";
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let checked = stochc::compiler::check("a.sa", &mut reader, Default::default());
    let codes: Vec<_> = checked
        .findings
        .iter()
        .map(|finding| finding.code.name())
        .collect();
    assert_eq!(codes, ["missing-term"]);
}

#[test]
fn a_million_equal_mistakes_are_told_a_thousand_times() {
    let text = "assembly a { seed plate 1 x 1 { M at (0, 0) } \
                phase p { for i in 1..1000000 { M.up -> T[i] } } }";
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let checked = stochc::compiler::check("a.sa", &mut reader, Default::default());
    assert_eq!(checked.findings.len(), 1001);
}

#[test]
fn a_wrong_argument_is_told_once_for_each_instance() {
    let program = "pattern t(b, n) { b.up -> T  b.east -> V  b.west ->> W[1..n + n] }
        assembly a {
            seed plate 5 x 1 { M at (0, 0)  N at (4, 0) }
            phase p { M.up -> A  N.up -> B  t(3, M) t(A, B) }
        }";
    assert_eq!(codes(&text(program)), [Code::WrongKind; 3]);
}

#[test]
fn a_scene_may_take_the_place_of_the_built_in_one() {
    let program = "scene hemisphere from hemisphere { free 5 uniform }
        assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up ->> A[1..6] } }";
    assert_eq!(codes(&text(program)), [Code::TooFewBlocks]);
    let program = "scene other from other { free 5 uniform }";
    assert_eq!(codes(&text(program)), [Code::UnknownScene]);
}
