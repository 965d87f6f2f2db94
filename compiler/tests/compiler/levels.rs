//! Scope of an `allow` or `deny` in a file.
use std::collections::BTreeMap;

use stochc_compiler::diagnostic::{Code, Severity};
use stochc_compiler::{Checked, Level, Limits, LintLevels, check_with};

fn files(files: &[(&str, &str)], levels: &LintLevels) -> Checked {
    let files: BTreeMap<&str, &str> = files.iter().copied().collect();
    let mut reader = |path: &str| {
        let text = files.get(path).ok_or(std::io::ErrorKind::NotFound)?;
        Ok(text.as_bytes().to_vec())
    };
    check_with("a.sa", &mut reader, Limits::default(), levels)
}

/// Returns the reported codes, in capitals for errors.
fn reported(text: &str) -> Vec<String> {
    let checked = files(&[("a.sa", text)], &LintLevels::default());
    let name = |diagnostic: &stochc_compiler::diagnostic::Diagnostic| match diagnostic.severity {
        Severity::Error => diagnostic.code.name().to_uppercase(),
        Severity::Warning => diagnostic.code.name().to_owned(),
    };
    checked.diagnostics.iter().map(name).collect()
}

/// Returns a program with an unused seed and an empty phase. The arguments are inserted in five
/// places.
fn program([file, assembly, plate, phase, other]: [&str; 5]) -> String {
    format!(
        "{file}
        assembly a {{
            {assembly}
            seed plate 2 x 1 {{ M at (0, 0)  N at (1, 0) {plate} }}
            phase p {{ {phase} }}
            phase q {{ M.up -> A  {other} }}
        }}"
    )
}

#[test]
fn a_level_applies_to_the_enclosing_block() {
    let seed = "allow unused-seed \"a mark\"";
    let phase = "allow empty-phase \"waits for the next version\"";
    let no = "";
    assert_eq!(reported(&program([no; 5])), ["unused-seed", "empty-phase"]);
    for place in 0..3 {
        let mut places = [no; 5];
        places[place] = seed;
        assert_eq!(reported(&program(places)), ["empty-phase"], "{place}");
    }
    for place in [0, 1, 3] {
        let mut places = [no; 5];
        places[place] = phase;
        assert_eq!(reported(&program(places)), ["unused-seed"], "{place}");
    }
    // In other places it has nothing to allow.
    let elsewhere = [no, no, phase, no, seed];
    assert_eq!(
        reported(&program(elsewhere)),
        ["unused-seed", "unused-allow", "empty-phase", "unused-allow"]
    );
}

#[test]
fn the_innermost_level_applies() {
    let deny = "deny empty-phase \"each phase builds\"";
    let allow = "allow empty-phase \"this one does not\"";
    let seed = "allow unused-seed \"a mark\"";
    let both = format!("{seed} {deny}");
    assert_eq!(reported(&program([&both, "", "", "", ""])), ["EMPTY-PHASE"]);
    assert_eq!(reported(&program([&both, "", "", allow, ""])), [""; 0]);
    assert_eq!(
        reported(&program([seed, allow, "", deny, ""])),
        ["EMPTY-PHASE", "unused-allow"]
    );
    // Within one block the last statement applies.
    let twice = format!("{seed} {allow} {deny}");
    assert_eq!(
        reported(&program([&twice, "", "", "", ""])),
        ["EMPTY-PHASE", "unused-allow"]
    );
}

/// The source right after a block is outside of the block.
#[test]
fn a_level_ends_with_its_block() {
    let text = "assembly a { seed plate 2 x 1 { for i in 0..0 { allow unused-seed \"x\" M at (0, 0) }N at (1, 0) } \
                phase p { M.up -> A } }";
    let reported = reported(text);
    assert_eq!(reported, ["unused-allow", "unused-seed"]);
}

#[test]
fn many_outdated_allows_are_not_all_listed() {
    let phases: String = (0..3000)
        .map(|i| {
            format!(
                "phase p{i} {{ allow redundant-after \"generated\" M.up -> A{i}  release A{i} }}\n"
            )
        })
        .collect();
    let text = format!("assembly a {{ seed plate 1 x 1 {{ M at (0, 0) }}\n{phases}}}");
    let reported = reported(&text);
    assert_eq!(reported.len(), 1001);
    assert_eq!(reported[1000], "too-many-warnings");
}

#[test]
fn an_outdated_allow_can_be_allowed_itself() {
    let text = |statement: &str| {
        format!(
            "{statement}
            assembly a {{
                allow redundant-after \"generated\"
                seed plate 1 x 1 {{ M at (0, 0) }}
                phase p {{ M.up -> A }}
            }}"
        )
    };
    assert_eq!(reported(&text("")), ["unused-allow"]);
    assert_eq!(reported(&text("allow unused-allow \"generated\"")), [""; 0]);
    let other = "assembly a { allow unused-allow \"x\" seed plate 1 x 1 { M at (0, 0) } \
                 phase p { M.up -> A } }";
    assert_eq!(reported(other), ["unused-allow"]);
}

#[test]
fn an_uncertain_allow_is_not_reported() {
    let allow = "allow redundant-after \"x\"";
    // Another file may use the pattern, and the error may hide the warning.
    let pattern = format!(
        "pattern _t(b) {{ {allow} b.up -> T }}
        assembly a {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A }} }}"
    );
    assert_eq!(reported(&pattern), [""; 0]);
    assert_eq!(
        reported(&format!("{allow} pattern t(b) {{ b.up -> T }}")),
        [""; 0]
    );
    let wrong = format!(
        "assembly a {{ {allow} seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A  X.up -> B }} }}"
    );
    assert_eq!(reported(&wrong), ["UNKNOWN-NAME"]);
}

#[test]
fn a_level_applies_only_to_its_file() {
    let tower = "pattern tower(base, other) { other.up -> T after base }";
    let own = |statement: &str| {
        format!(
            "import \"b.sa\" {statement}
            assembly a {{ seed plate 2 x 1 {{ M at (0, 0)  N at (1, 0) }}
            phase p {{ M.up -> A }} phase q {{ tower(A, N) }} }}"
        )
    };
    let allow = "allow redundant-after \"in general it is not\"\n";
    let codes = |own: &str, tower: &str| -> Vec<Code> {
        let checked = files(&[("a.sa", own), ("b.sa", tower)], &LintLevels::default());
        checked
            .diagnostics
            .iter()
            .map(|diagnostic| diagnostic.code)
            .collect()
    };
    assert_eq!(codes(&own(""), tower), [Code::RedundantAfter]);
    assert_eq!(codes(&own(""), &format!("{allow}{tower}")), []);
    assert_eq!(
        codes(&own(allow), tower),
        [Code::UnusedAllow, Code::RedundantAfter]
    );
}

#[test]
fn allowed_warnings_are_listed_with_their_reason() {
    let text = program(["allow unused-seed \"a mark\"", "", "", "", ""]);
    let mut levels = LintLevels::default();
    levels.set(Some(Code::EmptyPhase), Level::Allow);
    let checked = files(&[("a.sa", &text)], &levels);
    assert!(checked.diagnostics.is_empty());
    let allowed: Vec<_> = (checked.allowed.iter())
        .map(|allowed| (allowed.diagnostic.code, allowed.reason.as_deref()))
        .collect();
    assert_eq!(
        allowed,
        [(Code::UnusedSeed, Some("a mark")), (Code::EmptyPhase, None)]
    );
}

#[test]
fn a_denied_program_has_no_tables() {
    let text = program(["deny warnings_ \"x\"", "", "", "", ""]);
    assert_eq!(reported(&text)[0], "UNKNOWN-CODE");
    let text = program(["deny unused-seed \"x\"", "", "", "", ""]);
    let checked = files(&[("a.sa", &text)], &LintLevels::default());
    assert!(checked.has_errors());
    assert!(checked.programs[0].tables.is_none());
}

#[test]
fn unused_declarations_are_reported() {
    let program = "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }";
    for (declared, code) in [
        ("let n = 1", "unused-let"),
        ("pattern t(b) { b.up -> T }", "unused-pattern"),
        ("pattern t(b) { b.up -> T t(T) }", "unused-pattern"),
        ("shape s { layer 1 { # } }", "unused-shape"),
        ("scene s from hemisphere { free 5 uniform }", "unused-scene"),
    ] {
        assert_eq!(
            reported(&format!("{declared} {program}")),
            [code],
            "{declared}"
        );
        let name = declared.split([' ', '(']).nth(1).unwrap();
        let renamed = declared.replace(&format!(" {name}"), &format!(" _{name}"));
        assert_eq!(
            reported(&format!("{renamed} {program}")),
            [""; 0],
            "{renamed}"
        );
        let allowed = format!("allow {code} \"later\" {declared} {program}");
        assert_eq!(reported(&allowed), [""; 0], "{allowed}");
        // A file without a program is meant for import.
        assert_eq!(reported(declared), [""; 0]);
    }
    // The warning occurs in each kind of block.
    let local = "assembly a {
        let a = 1 pattern t(b) { let i = 1 b.up -> T } shape s { layer 1..2 { # } }
        seed plate 1 x 1 { let b = 1 M at (0, 0) }
        phase p { let c = 1 for i in 1..1 { let d = 1 t(M) } M.up -> A } }";
    let codes = reported(local);
    let of = |code: &str| {
        codes
            .iter()
            .filter(|reported_code| *reported_code == code)
            .count()
    };
    // First there is an error. The warnings appear after the fix.
    assert_eq!((of("unused-let"), codes.len()), (0, 1), "{codes:?}");
    let codes = reported(&local.replace("M.up -> A", ""));
    let of = |code: &str| {
        codes
            .iter()
            .filter(|reported_code| *reported_code == code)
            .count()
    };
    assert_eq!((of("unused-let"), of("unused-shape")), (5, 1), "{codes:?}");
}

#[test]
fn used_declarations_are_not_reported() {
    for program in [
        "let n = 2 let m = n assembly a { seed plate m x 1 { M at (n - 2, 0) } phase p { M.up -> A } }",
        "let n = 2 pattern t(b) { b.up ->> T[1..n] } pattern u(b) { t(b) }
         assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { u(M) } }",
        "shape s { layer 1 { # } } scene c from hemisphere { free 9 uniform } scene d from c { free 8 uniform }
         assembly a in d { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A yields s } }",
        "scene hemisphere from hemisphere { free 9 uniform }
         assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }",
        "let n = 3 aggregate pair in magnet_tank to n - 1",
    ] {
        assert_eq!(reported(program), [""; 0], "{program}");
    }
    let own =
        "import \"b.sa\" assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }";
    let library = "let n = 1 pattern t(b) { b.up -> T } shape s { layer 1 { # } }";
    let checked = files(&[("a.sa", own), ("b.sa", library)], &LintLevels::default());
    assert!(checked.diagnostics.is_empty(), "{:?}", checked.diagnostics);
}

#[test]
fn only_a_private_number_is_removed_automatically() {
    let text = "let n = 1\nassembly a {\n    let k = 1\n    seed plate 1 x 1 { M at (0, 0) }\n    phase p { M.up -> A }\n}\n";
    let checked = files(&[("a.sa", text)], &LintLevels::default());
    let safe: Vec<_> = (checked.diagnostics.iter())
        .map(|diagnostic| diagnostic.fix.as_ref().map(|fix| fix.safe))
        .collect();
    assert_eq!(safe, [Some(false), Some(true)]);
}

#[test]
fn no_warning_follows_from_an_error() {
    let program = |phases: &str| {
        reported(&format!(
            "assembly a {{ seed plate 2 x 1 {{ M at (0, 0)  N at (1, 0) }} phase p {{ M.up -> A }} {phases} }}"
        ))
    };
    // A misspelt seed or a misspelt capture in an `after` causes no warnings. The phase has a
    // statement.
    assert_eq!(program("phase q { n.up -> B }"), ["UNKNOWN-NAME"]);
    assert_eq!(
        program("phase q { N.up -> A  A.up -> B after A }"),
        ["CAPTURED-TWICE"]
    );
    assert_eq!(program("phase q { N -> B }"), ["MISSING-FACE"]);
    assert_eq!(
        program("phase q { for i in 1..k { N.up -> B } }"),
        ["UNKNOWN-NAME"]
    );
    // Errors of cells do not hide unused names.
    assert_eq!(
        program("phase q { A.down -> B }"),
        ["ANCHORING-FACE", "unused-seed"]
    );
    // A misspelt name may stand for a name that seems unused.
    let unused = |used: &str| {
        reported(&format!(
            "shape flat {{ layer 1 {{ # }} }} assembly a {{ seed plate 1 x 1 {{ M at (0, 0) }}
            phase p {{ M.up -> A {used} }} }}"
        ))
    };
    assert_eq!(unused(""), ["unused-shape"]);
    assert_eq!(unused("yields falt"), ["UNKNOWN-NAME"]);
    assert_eq!(unused("yields flat"), [""; 0]);
}
