//! Tests the proof that `check` prints.
use serde_json::{Value, json};
use stochc_compiler::diagnostic::Code;
use stochc_compiler::{Level, Limits, LintLevels, check_with};

use crate::stochc::{stochc, stochc_reading};

/// Returns the invalid program on the page of a diagnostic code.
fn wrong_program(code: Code) -> &'static str {
    let (_, rest) = code.page().split_once("```sa\n").unwrap();
    rest.split_once("```").unwrap().0
}

/// Returns the status lines about the programs in a text, and the programs as JSON.
fn checked(text: &str, option: &str) -> (Vec<String>, Vec<Value>) {
    let outcome = stochc_reading(&format!("check {option} -"), text);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let is_proof = |line: &&str| line.contains("proved: ") || line.starts_with("    because ");
    let lines = outcome.out.lines().filter(is_proof);
    let document = stochc_reading(&format!("check {option} --json -"), text).json();
    let programs = document["programs"].as_array().unwrap();
    let proved = programs.iter().map(|program| program["proved"].clone());
    (lines.map(str::to_owned).collect(), proved.collect())
}

#[test]
fn proved_properties_are_reported() {
    let text = "shape pair { layer 1..2 { # } }
        assembly tower {
            seed plate 1 x 1 { M at (0, 0) }
            phase low { M.up ->> T[1..2] yields pair }
            phase high { T[2].up -> T[3] }
            phase again { release T[3] yields pair }
        }";
    let (lines, proved) = checked(text, "");
    let expected = [
        "  proved: completes in every order",
        "  proved: no cell is blocked or used twice",
        "  proved: builds `pair`",
    ];
    assert_eq!(lines, expected);
    assert_eq!(proved[0]["shapes"], json!(["pair"]));
    let document = stochc("check --json tests/fixtures/tower.sa").json();
    let program = json!({
        "file": "tests/fixtures/tower.sa",
        "name": "tower",
        "kind": "assembly",
        "scene": "hemisphere",
        "phases": 2,
        "pre_attached": 0,
        "captures": 3,
        "releases": 0,
        "proved": {
            "completes": true,
            "no_cell_blocked": true,
            "no_cell_used_twice": true,
            "shapes": [],
            "has_timeout": false,
            "has_dead_blocks": false,
            "has_breaking_bonds": false,
            "unproved": [],
        },
    });
    assert_eq!(document["programs"], json!([program]));
    assert_eq!(document["format"], 1);
}

#[test]
fn a_timeout_is_an_exception() {
    let text =
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p timeout 3600 s { M.up -> A } }";
    let (lines, proved) = checked(text, "");
    assert_eq!(
        lines[0],
        "  proved: completes in every order unless a phase times out"
    );
    assert_eq!(proved[0]["has_timeout"], true);
}

#[test]
fn a_dead_block_is_an_exception() {
    let text = "scene worn from hemisphere { faults { dead 1% } }
        assembly a in worn { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }";
    let (lines, proved) = checked(text, "");
    assert_eq!(
        lines[0],
        "  proved: completes in every order unless it captures a dead block"
    );
    assert_eq!(proved[0]["has_dead_blocks"], true);
}

/// Returns a program of one phase whose bonds can break. `faults` is a clause of its scene.
fn breaking(faults: &str, phase: &str) -> String {
    format!(
        "scene heavy from hemisphere {{
            {faults}
            gravity 9.81 m/s^2
            bond attract {{
                pull 15 N within 20cm  anchor centres 1mm
                strength {{ force 5 N }}
            }}
        }}
        assembly a in heavy {{
            seed plate 1 x 1 {{ M at (0, 0) }}
            phase p {phase}
        }}"
    )
}

/// Checks the proof of a program whose bonds break in no order, and of one with an overloaded bond.
#[test]
fn a_breaking_bond_is_an_exception() {
    let (lines, proved) = checked(&breaking("", "{ M.up -> A }"), "");
    assert_eq!(
        lines[0],
        "  proved: completes in every order unless a bond breaks"
    );
    assert_eq!(proved[0]["has_breaking_bonds"], true);
    assert_eq!(proved[0]["completes"], true);
    let (lines, proved) = checked(
        &breaking("", "{ M.up -> A.up -> B.east -> C }"),
        "--allow warnings",
    );
    let expected = [
        "  proved: no cell is blocked or used twice",
        "  not proved: completes in every order",
        "    because a bond breaks (overloaded-bond)",
    ];
    assert_eq!(lines, expected);
    assert_eq!(proved[0]["completes"], false);
    assert_eq!(proved[0]["no_cell_blocked"], true);
}

#[test]
fn all_exceptions_are_listed() {
    let (faults, timeout) = ("faults { dead 1% }", "timeout 3600 s");
    for (faults, timeout, expected) in [
        ("", timeout, "a bond breaks or a phase times out"),
        (faults, "", "it captures a dead block or a bond breaks"),
        (
            faults,
            timeout,
            "it captures a dead block, a bond breaks or a phase times out",
        ),
    ] {
        let phase = format!("{timeout} {{ M.up -> A }}");
        let (lines, _) = checked(&breaking(faults, &phase), "--allow warnings");
        let expected = format!("  proved: completes in every order unless {expected}");
        assert_eq!(lines[0], expected);
    }
}

#[test]
fn nothing_is_proved_about_wrong_programs_and_aggregates() {
    let document = stochc("check --json tests/fixtures/wrong.sa").json();
    assert_eq!(document["programs"][0]["proved"], Value::Null);
    let denied = "check --deny warnings --json tests/fixtures/careless.sa";
    assert_eq!(stochc(denied).json()["programs"][0]["proved"], Value::Null);
    let document = stochc("check --json tests/fixtures/aggregate.sa").json();
    assert_eq!(document["programs"][0]["kind"], "aggregate");
    assert_eq!(document["programs"][0]["proved"], Value::Null);
}

/// Checks a search that was given up, with its warning reported and with the warning allowed.
#[test]
fn a_search_that_gave_up_proves_no_access() {
    // The core is within walls, so the proof of access requires a search.
    let text = "assembly tunnel {
        seed plate 3 x 3 {
            for y in 0..2 { W[y] at (0, y)  E[y] at (2, y) }
            M at (1, 1)
        }
        phase shell {
            for y in 0..2 { W[y].up -> A[y].up -> B[y].east -> R[y]  E[y].up -> F[y] }
        }
        phase core { M.up -> CORE }
    }";
    let limits = Limits {
        search: 0,
        ..Limits::default()
    };
    for level in [Level::Warn, Level::Allow] {
        let mut levels = LintLevels::default();
        levels.set(None, level);
        let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
        let checked = check_with("a.sa", &mut reader, limits, &levels);
        let proof = checked.proof(0).unwrap();
        assert!(!proof.completes && !proof.no_cell_blocked && proof.no_cell_used_twice);
        let expected = "proved: no cell is used twice\n\
                        not proved: completes in every order\n  \
                        because the search for access paths reached its limit (reach-undecided)\n";
        assert_eq!(proof.to_string(), expected);
        let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
        let checked = check_with("a.sa", &mut reader, Limits::default(), &levels);
        assert!(checked.proof(0).unwrap().completes);
    }
}

#[test]
fn a_release_without_room_proves_no_access() {
    let text = wrong_program(Code::BlockedRelease);
    for option in ["", "--allow warnings"] {
        let (lines, proved) = checked(text, option);
        assert_eq!(proved[0]["completes"], false, "{lines:?}");
        assert_eq!(lines[1], "  not proved: completes in every order");
        assert!(lines[2].contains("(blocked-release)"), "{lines:?}");
    }
}

/// Checks a program that may run out of free blocks. `Y` and `Z` may be captured before `X` is
/// released. Then no third block is free.
#[test]
fn free_blocks_that_may_run_out_prove_no_completion() {
    let program = |free: u32, wait: &str| {
        format!(
            "scene few from hemisphere {{ free {free} uniform }}
            assembly a in few {{
                seed plate 5 x 1 {{ A at (0, 0)  B at (2, 0)  C at (4, 0) }}
                phase one {{ A.up -> X }}
                phase two {{ B.up -> Y{wait}  C.up -> Z{wait}  release X }}
            }}"
        )
    };
    let proved = |text: &str| checked(text, "--allow warnings").1.remove(0);
    let scarce = proved(&program(2, ""));
    assert_eq!(
        (&scarce["completes"], &scarce["no_cell_blocked"]),
        (&json!(false), &json!(true))
    );
    assert!(
        scarce["unproved"][0]
            .as_str()
            .unwrap()
            .contains("phase `two`"),
        "{scarce}"
    );
    assert_eq!(proved(&program(3, ""))["completes"], true);
    assert_eq!(proved(&program(2, " after release X"))["completes"], true);
}
