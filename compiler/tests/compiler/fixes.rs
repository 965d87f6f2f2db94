//! Checks that each fix makes exactly the change that it announces.
mod syntax_hints;

use proptest::prelude::*;
use stochc_compiler::diagnostic::{Code, Diagnostic, Fix, TextChange};
use stochc_compiler::{Changes, Checked, FileId, Fixed, Limits, LintLevels, check};

/// Reads a text as `a.sa`, next to the files that the fixtures import.
fn files(text: &str) -> impl FnMut(&str) -> std::io::Result<Vec<u8>> {
    move |requested| match requested {
        "a.sa" => Ok(text.as_bytes().to_vec()),
        "towers.sa" => Ok(Vec::new()),
        "importing_tower.sa" => {
            Ok(include_bytes!("../../../tests/fixtures/importing_tower.sa").to_vec())
        }
        _ => Err(std::io::Error::other("no such file")),
    }
}

fn checked(text: &str) -> Checked {
    check("a.sa", &mut files(text), Limits::default())
}

/// Returns the text with all safe changes.
fn apply_fixes(text: &str) -> Fixed {
    let mut reader = files(text);
    stochc_compiler::fix(
        "a.sa",
        &mut reader,
        Limits::default(),
        &LintLevels::default(),
        Changes::NONE,
    )
}

fn fixed(text: &str) -> String {
    apply_fixes(text).text.to_string()
}

/// Returns the messages without their places.
fn reported(diagnostics: &[Diagnostic]) -> Vec<(Code, String)> {
    let mut messages: Vec<_> = (diagnostics.iter())
        .map(|diagnostic| (diagnostic.code, diagnostic.title.clone()))
        .collect();
    messages.sort();
    messages
}

/// Returns the comments of a text in order.
fn comments(text: &str) -> Vec<&str> {
    let comment = |line: &'_ str| line.find("//").map(|at| at..line.len());
    text.lines()
        .filter_map(|line| comment(line).map(|range| line[range].trim_start_matches('/').trim()))
        .collect()
}

const PLATE: &str = "assembly a {\n    seed plate 2 x 1 { M at (0, 0)  N at (1, 0) }\n";

/// Returns a program with these phases.
fn program(phases: &str) -> String {
    format!("{PLATE}    phase base {{ M.up -> A }}\n    {phases}\n}}\n")
}

fn assert_fixed(slips: &[(&str, &str)]) {
    for (wrong, right) in slips {
        assert_eq!(fixed(&program(wrong)), program(right), "{wrong}");
    }
}

#[test]
fn typos_in_a_phase_are_fixed() {
    assert_fixed(&[
        ("phaze p { N.up -> B }", "phase p { N.up -> B }"),
        (
            "phase p { relese A }  phase q { N.up -> B }",
            "phase p { release A }  phase q { N.up -> B }",
        ),
        (
            "phase p timeot 5 ticks { N.up -> B }",
            "phase p timeout 5 ticks { N.up -> B }",
        ),
        (
            "phase p timeout 5 seconds { N.up -> B }",
            "phase p timeout 5 s { N.up -> B }",
        ),
        (
            "phase p timeout 5 tics { N.up -> B }",
            "phase p timeout 5 ticks { N.up -> B }",
        ),
        ("phase p { N.up -> B; }", "phase p { N.up -> B }"),
        (
            "phase p { N.up -> B;B.up -> C }",
            "phase p { N.up -> B B.up -> C }",
        ),
        ("phase p { N.up => B }", "phase p { N.up -> B }"),
        ("phase p { N.up → B }", "phase p { N.up -> B }"),
        ("phase p { N.up –> B }", "phase p { N.up -> B }"),
        (
            "phase p { N.up => B.up => C }",
            "phase p { N.up -> B.up -> C }",
        ),
        (
            "phase p { N.up -> B.up -> C  B.east -> D after (B, C) }",
            "phase p { N.up -> B.up -> C  B.east -> D after B, C }",
        ),
        (
            "phase p { for i in 1..1 // one\n        N.up -> B[i] } }",
            "phase p { for i in 1..1 { // one\n        N.up -> B[i] } }",
        ),
        (
            "phase p { N.up -> B  release(A) }",
            "phase p { N.up -> B  release A }",
        ),
        (
            "phase p\n        N.up -> B\n    }",
            "phase p {\n        N.up -> B\n    }",
        ),
        (
            "phase p // now\n        N.up ->> B[1..2]\n    }",
            "phase p { // now\n        N.up ->> B[1..2]\n    }",
        ),
        ("phase p { N.up > B }", "phase p { N.up -> B }"),
        (
            "phase p { N.up =>> B[1..2] }",
            "phase p { N.up ->> B[1..2] }",
        ),
        ("phase p { N.up ->> B }", "phase p { N.up -> B }"),
        (
            "phase p { N.up ->> B[1...2] }",
            "phase p { N.up ->> B[1..2] }",
        ),
        (
            "phase p { N.up ->> B[1..=2] }",
            "phase p { N.up ->> B[1..2] }",
        ),
        ("phase p { N.top -> B }", "phase p { N.up -> B }"),
        (
            "phase p { N.up -> B.noth -> C }",
            "phase p { N.up -> B.north -> C }",
        ),
        (
            "phase p { for (i in 1..1) { N.up -> B[i] } }",
            "phase p { for i in 1..1 { N.up -> B[i] } }",
        ),
        (
            "# note\n    phase p { N.up -> B }",
            "// note\n    phase p { N.up -> B }",
        ),
        (
            "/* note */\n    phase p { N.up -> B }",
            "// note \n    phase p { N.up -> B }",
        ),
        (
            "/ note\n    phase p { N.up -> B }",
            "// note\n    phase p { N.up -> B }",
        ),
    ]);
}

#[test]
fn misspelt_names_and_unneeded_parts_are_fixed() {
    assert_fixed(&[
        (
            "phase p { N.up -> B\n    /// one\n    /// two\n    }",
            "phase p { N.up -> B\n    // one\n    // two\n    }",
        ),
        ("phase p { N.up -> B after A }", "phase p { N.up -> B }"),
        (
            "phase p { N.up -> B.up -> C\n        B.east -> D after A, B }",
            "phase p { N.up -> B.up -> C\n        B.east -> D after B }",
        ),
        (
            "phase p { N.up -> B.up -> C\n        B.east -> D after B, A }",
            "phase p { N.up -> B.up -> C\n        B.east -> D after B }",
        ),
        (
            "phase p { N.up -> D\n        after A // not needed\n    }",
            "phase p { N.up -> D\n        // not needed\n    }",
        ),
        (
            "phase p { N.up -> B }\n    phase q { }",
            "phase p { N.up -> B }",
        ),
        (
            "phase p { N.up -> B  release A.up }",
            "phase p { N.up -> B  release A }",
        ),
        (
            "deny empty-phaze \"x\"\n    phase p { N.up -> B }",
            "deny empty-phase \"x\"\n    phase p { N.up -> B }",
        ),
        (
            "deny cycle \"x\"\n    phase p { N.up -> B }",
            "phase p { N.up -> B }",
        ),
        (
            "allow empty-phase \"x\"\n    phase p { N.up -> B }",
            "phase p { N.up -> B }",
        ),
        (
            "let heigth = 2  phase p { N.up ->> B[1..height] }",
            "let heigth = 2  phase p { N.up ->> B[1..heigth] }",
        ),
        (
            "phase p { N.up -> tower }  phase q { towre.up -> B }",
            "phase p { N.up -> tower }  phase q { tower.up -> B }",
        ),
        (
            "pattern grow(b) { b.up -> T }  phase p { grwo(N) }",
            "pattern grow(b) { b.up -> T }  phase p { grow(N) }",
        ),
        (
            "pattern grow(b) { b.up -> T }  phase p { grow(N) as left }  phase q { lfet.T.up -> B }",
            "pattern grow(b) { b.up -> T }  phase p { grow(N) as left }  phase q { left.T.up -> B }",
        ),
        (
            "shape flat { layer 1 { ## } }  phase p { N.up -> B  yields falt }",
            "shape flat { layer 1 { ## } }  phase p { N.up -> B  yields flat }",
        ),
    ]);
}

/// Most editors show a line end, so the source after a comment looks like a part of the program.
#[test]
fn a_lone_carriage_return_does_not_end_a_line() {
    let text = program("phase rest { A.up -> B N.up -> C }").replace('\n', "\r");
    let found = checked(&text);
    let first = &found.diagnostics[0];
    assert_eq!(first.title, "carriage return without a line feed");
    assert_eq!(fixed(&text), text.replace('\r', "\n"));
    // A fix does not restore source that a comment contains, if that is wrong.
    let text = format!("{PLATE}    phase base {{ M.up -> A N.up -> C }} // D.up\r}}\n}}\n");
    assert!(checked(&text).has_errors());
    assert_eq!(fixed(&text), text);
    let text = program("phase rest { A.up -> B N.up -> C }").replace('\n', "\r\n");
    assert!(checked(&text).diagnostics.is_empty());
}

#[test]
fn typos_outside_of_phases_are_fixed() {
    for (wrong, right) in [
        (
            "asembly a { seed plate 1 x 1 { } }",
            "assembly a { seed plate 1 x 1 { } }",
        ),
        ("sceen s from hemisphere { }", "scene s from hemisphere { }"),
        ("scene s from hemispere { }", "scene s from hemisphere { }"),
        ("scene s form hemisphere { }", "scene s from hemisphere { }"),
        (
            "scene s from hemisphere { tick 5 msec }",
            "scene s from hemisphere { tick 5 ms }",
        ),
        (
            "scene s from hemisphere { tik 5 ms }",
            "scene s from hemisphere { tick 5 ms }",
        ),
        (
            "scene s from hemisphere { contact { restitutoin 0  friction 0 } }",
            "scene s from hemisphere { contact { restitution 0  friction 0 } }",
        ),
        (
            "scene s from hemisphere { free 30 unifrom }",
            "scene s from hemisphere { free 30 uniform }",
        ),
        ("import \"a.sa\"\nlet n = 1\n", "let n = 1\n"),
        (
            "let n = 1\nimport towers.sa",
            "let n = 1\nimport \"towers.sa\"",
        ),
        (
            "assembly a {\n    seed plate 3x1 {\n    }\n}\n",
            "assembly a {\n    seed plate 3 x 1 {\n    }\n}\n",
        ),
        (
            "assembly a {\n    seed plate 3x 1\n        M at (0, 0)\n    }\n}\n",
            "assembly a {\n    seed plate 3x 1\n        M at (0, 0)\n    }\n}\n",
        ),
        (
            "assembly a\n    seed plate 1 x 1 { M at (0, 0) }\n    phase p { M.up -> A }\n}\n",
            "assembly a {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase p { M.up -> A }\n}\n",
        ),
        ("let n = 1;\n", "let n = 1\n"),
        (
            "scene s from hemisphere {\n  /// doc\n  tick 5 ms\n}",
            "scene s from hemisphere {\n  // doc\n  tick 5 ms\n}",
        ),
        (
            "assembly a {\n    seed plate 2 x 1 {\n        M at (0, 0)\n        N at (1, 0)   // spare\n    }\n    phase p { M.up -> A }\n}",
            "assembly a {\n    seed plate 2 x 1 {\n        M at (0, 0)\n        // spare\n    }\n    phase p { M.up -> A }\n}",
        ),
        (
            "assembly a { seed plat 1 x 1 { } }",
            "assembly a { seed plate 1 x 1 { } }",
        ),
    ] {
        assert_eq!(fixed(wrong), right, "{wrong}");
    }
}

#[test]
fn uncertain_fixes_are_not_applied() {
    for text in [
        // The name of another block may be intended.
        program("phase p { N.up -> top }  phase q { tip.up -> B }"),
        program("phase p { N.up -> T[1] }  phase q { T[2].up -> B }"),
        program("phase p { N.up -> towar.up -> tower }  phase q { towr.up -> B }"),
        program("phase p { N.left -> B }"),
        // A part may be missing.
        program("phase p { N.up -> B.up }"),
        program("phase p { N -> B }"),
        program("phase p { N.up -> B  } }"),
        program("phase p { N.up -> B }  phase q { /* later */ }").replace("/* later */", "// later\n"),
        program("phase p { N.up -> B }  phase q { for i in 2..1 { } }"),
        // The documentation would belong to another statement.
        program("phase p { N.up -> B }  /// later\n    phase q { }"),
        // Another round needs the same source, or the source names several blocks.
        program("for i in 1..2 { phase p[i] { N.up -> B[i] after X  release X } }"),
        program("for i in 1..2 { phase p[i] { M.up -> Z[i] N.up -> B[i] after Z[1] } }"),
        "assembly a { seed plate 3 x 1 { for i in 0..2 { M[i] at (i, 0) } } phase p { M[0].up -> A } }".to_owned(),
    ] {
        assert_eq!(fixed(&text), text);
        assert!(!checked(&text).diagnostics.is_empty(), "{text}");
    }
}

#[test]
fn a_fix_that_causes_a_diagnostic_is_only_offered() {
    for (wrong, code) in [
        // If this became a comment, `wall` would have no value.
        (
            "scene s from hemisphere { enclosure hemisphere { radius 5m  wall N/m } }",
            Code::Syntax,
        ),
        // With the corrected keyword, a cycle appears.
        (
            "asembly a {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase p { M.up -> A after B  A.up -> B }\n}\n",
            Code::Syntax,
        ),
        // The imported file would import itself.
        ("let n = 1\nimport a.sa", Code::Syntax),
    ] {
        let found = checked(wrong).diagnostics;
        assert_eq!(found[0].code, code, "{wrong}");
        let is_safe = |fix: &Fix| fix.safe;
        assert!(
            !found.iter().any(|it| it.fix.as_ref().is_some_and(is_safe)),
            "{wrong}"
        );
        assert_eq!(fixed(wrong), wrong);
    }
}

#[test]
fn unchecked_warnings_do_not_count_as_new() {
    let wrong = format!("{PLATE}    phaze base {{ M.up -> A }}\n}}\n");
    let right = wrong.replace("phaze", "phase").replace("  N at (1, 0)", "");
    assert_eq!(fixed(&wrong), right);
}

/// Returns the result and the number of checks of a program that imports a missing file.
fn checks(text: &str) -> (Checked, u32) {
    let mut checks = 0;
    let mut reader = |requested: &str| match requested {
        "a.sa" => Ok(text.as_bytes().to_vec()),
        _ => {
            checks += 1;
            Err(std::io::Error::other("no such file"))
        }
    };
    (check("a.sa", &mut reader, Limits::default()), checks)
}

#[test]
fn many_fixes_are_tried_together() {
    let import = "import \"none.sa\"\n";
    let lets = |count: usize| {
        (0..count)
            .map(|n| format!("let n{n} = {n};\n"))
            .collect::<String>()
    };
    let safe = |checked: &Checked| {
        let fixes = checked.diagnostics.iter().filter_map(|it| it.fix.as_ref());
        fixes.filter(|fix| fix.safe).count()
    };
    for count in [1, 60, 99] {
        let (checked, checks) = self::checks(&format!("{import}{}", lets(count)));
        assert_eq!(safe(&checked), count);
        assert!(checks <= 1 + 64, "{checks} checks of {count} fixes");
    }
    // One fix does not help. Bisection finds it.
    let bad = "asembly a {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase p { M.up -> A  Q.up -> B }\n}\n";
    let (checked, _) = self::checks(&format!("{import}{}{bad}", lets(98)));
    assert_eq!(safe(&checked), 98);
    // The number of attempts does not depend on the size of the text.
    let long = "// much\n".repeat(100_000);
    let (checked, checks) = self::checks(&format!("{import}{}{long}", lets(99)));
    assert_eq!(safe(&checked), 99);
    assert!(checks <= 1 + 2, "{checks}");
    let (checked, checks) = self::checks(&format!("{import}{}{long}{long}{long}", lets(3)));
    assert_eq!((safe(&checked), checks), (0, 1));
}

#[test]
fn many_typos_are_fixed_in_rounds() {
    let lets = |end: &str| {
        (0..250)
            .map(|n| format!("let n{n} = {n}{end}\n"))
            .collect::<String>()
    };
    assert_eq!(fixed(&lets(";")), lets(""));
}

#[test]
fn fixes_never_worsen_fixtures_and_pages() {
    let mut programs: Vec<String> = Vec::new();
    for &code in Code::ALL {
        let wrong = code.page().split_once("Wrong:\n\n```sa\n");
        programs.extend(
            wrong
                .and_then(|(_, rest)| rest.split("```").next())
                .map(str::to_owned),
        );
    }
    for entry in std::fs::read_dir("../tests/findings").unwrap() {
        programs.push(std::fs::read_to_string(entry.unwrap().path()).unwrap());
    }
    let mut fixes = 0;
    for text in &programs {
        let before = checked(text);
        for diagnostic in &before.diagnostics {
            if let Some(fix) = &diagnostic.fix {
                one_change(text, &before, diagnostic, fix);
                fixes += 1;
            }
        }
    }
    assert!(fixes > 15, "{fixes}");
}

/// Checks that a change resolves its diagnostic. A safe change causes no error and keeps all
/// comments.
fn one_change(text: &str, before: &Checked, diagnostic: &Diagnostic, fix: &Fix) {
    let mut change = TextChange::new(FileId(0), text);
    assert!(change.add(fix), "{fix:?}");
    // Each unclosed block needs its own brace. A single brace closes the inner block.
    if diagnostic.code == Code::UnclosedBrace {
        let open = before.diagnostics.iter();
        let open = open.filter(|it| it.code == diagnostic.code && *it != diagnostic);
        open.filter_map(|it| it.fix.as_ref()).for_each(|fix| {
            change.add(fix);
        });
    }
    let new = change.text();
    let after = checked(&new);
    let (old, left) = (reported(&before.diagnostics), reported(&after.diagnostics));
    let this = (diagnostic.code, diagnostic.title.clone());
    let times = |messages: &[(Code, String)]| messages.iter().filter(|one| **one == this).count();
    assert!(times(&left) < times(&old), "{this:?} in\n{new}");
    if !fix.safe {
        return;
    }
    // The parser reads only parts of a text with several syntax errors. Fixing one error reveals
    // more.
    let partly_read = diagnostic.code == Code::Syntax && before.diagnostics.len() > 1;
    for diagnostic in &after.diagnostics {
        let known = old.contains(&(diagnostic.code, diagnostic.title.clone()));
        assert!(
            !diagnostic.is_error() || known || partly_read,
            "{diagnostic:?} in\n{new}"
        );
    }
    let slips =
        |messages: &[(Code, String)]| messages.iter().filter(|one| one.0 == Code::Syntax).count();
    assert!(slips(&left) <= slips(&old), "{new}");
    let retained = comments(&new);
    for comment in comments(text) {
        assert!(retained.contains(&comment), "{comment} in\n{new}");
    }
}

/// Removes or doubles a letter of a word, or swaps it with the next one.
fn misspelt(text: &str, at: usize, how: u8) -> Option<String> {
    let letter = |at: usize| text.as_bytes().get(at).is_some_and(u8::is_ascii_alphabetic);
    if !letter(at) || !letter(at + 1) {
        return None;
    }
    let (head, tail) = text.split_at(at);
    let (one, two) = (&tail[..1], &tail[1..2]);
    Some(match how % 3 {
        0 => format!("{head}{}", &tail[1..]),
        1 => format!("{head}{one}{tail}"),
        _ => format!("{head}{two}{one}{}", &tail[2..]),
    })
}

const EXAMPLES: [&str; 4] = [
    include_str!("../../../examples/five_tower.sa"),
    include_str!("../../../examples/five_tower_reconfigured.sa"),
    include_str!("../../../examples/closed_platform.sa"),
    include_str!("../../../examples/line.sa"),
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    #[test]
    fn a_typo_is_fixed_or_left_alone(
        example in 0usize..4,
        at in any::<prop::sample::Index>(),
        how in any::<u8>(),
    ) {
        let right = EXAMPLES[example];
        let wrong = misspelt(right, at.index(right.len()), how).unwrap_or(right.to_owned());
        let new = fixed(&wrong);
        let errors = |text: &str| checked(text).diagnostics.iter().filter(|f| f.is_error()).count();
        prop_assert!(new == wrong || errors(&new) == 0, "{}\nto\n{}", wrong, new);
        prop_assert_eq!(comments(&new), comments(&wrong));
    }

    #[test]
    fn fixing_several_typos_preserves_comments(
        example in 0usize..4,
        slips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 2..9),
    ) {
        let mut text = EXAMPLES[example].to_owned();
        for (at, how) in slips {
            text = misspelt(&text, at.index(text.len()), how).unwrap_or(text);
        }
        let new = fixed(&text);
        prop_assert_eq!(comments(&new), comments(&text));
    }
}

/// A program with more warnings than the limit can be run, and all warnings can be fixed.
#[test]
fn many_warnings_prevent_no_fix() {
    let rest = ", A".repeat(1_500);
    let text = program(&format!("phase p {{ N.up -> B after A{rest} }}"));
    let found = checked(&text);
    let codes: Vec<Code> = found.diagnostics.iter().map(|it| it.code).collect();
    assert_eq!(codes.len(), 1_001);
    assert_eq!(codes.last(), Some(&Code::TooManyWarnings));
    assert!(!found.has_errors() && found.programs[0].tables.is_some());
    assert_eq!(fixed(&text), program("phase p { N.up -> B }"));
    let empty: String = (0..1_500).map(|i| format!("phase e{i} {{ }}\n")).collect();
    let found = checked(&program(&format!("{empty} phase last {{ N.up -> B }}")));
    assert_eq!(found.diagnostics.len(), 1_001);
    assert!(!found.has_errors());
    // An error is reported in addition.
    let wrong = program(&format!("phase p {{ N.up -> B after A{rest}  X.up -> Y }}"));
    let reported = checked(&wrong).diagnostics;
    assert!(reported.iter().any(|it| it.code == Code::UnknownName));
}

/// `after release A` may be intended, but not for the release of A itself.
#[test]
fn no_fix_lets_a_release_wait_for_itself() {
    let help = |event: &str| {
        let text = program(&format!("phase p {{ release A  N.up -> B {event} }}"));
        let mut reported = checked(&text).diagnostics.into_iter();
        reported
            .find(|it| it.code == Code::RedundantAfter)
            .unwrap()
            .help
    };
    assert!(help("after A").unwrap().contains("after release A"));
    let text = program("phase p { N.up -> B  release A after A }");
    let found = checked(&text).diagnostics;
    assert_eq!(
        (found.len(), found[0].code, &found[0].help),
        (1, Code::RedundantAfter, &None)
    );
    assert_eq!(fixed(&text), text.replace(" after A", ""));
}

/// If faces attract by themselves, removing a seed changes the program.
#[test]
fn an_attracting_seed_is_not_removed_automatically() {
    let text = |scene: &str| {
        format!(
            "assembly a{scene} {{ seed plate 3 x 1 {{ P at (0, 0) R at (2, 0) }} phase p {{ P.up -> B }} }}"
        )
    };
    let seed_of = |text: &str| {
        let mut reported = checked(text).diagnostics.into_iter();
        reported.find(|it| it.code == Code::UnusedSeed).unwrap()
    };
    assert!(seed_of(&text("")).fix.is_some());
    let attracting = seed_of(&text(" in magnet_tank"));
    assert_eq!(attracting.fix, None);
    assert!(
        attracting
            .help
            .unwrap()
            .contains("attracts no blocks there")
    );
}
