//! Tests claims about runs: `stochc test` and their diagnostics.
use std::fs;

use crate::json::assert_output;
use crate::stochc::{Outcome, path, stochc_with};

/// Returns an assembly with a tower of three blocks, which takes about 1,900 ticks on average, and
/// with another tower. Two faces are open at the same time, so claims need runs.
fn tower(claims: &str) -> String {
    let seed = "seed plate 3 x 1 { M at (0, 0) N at (2, 0) }";
    format!("assembly tower {{ {seed} phase grow {{ M.up ->> T[1..3] N.up -> U }} {claims} }}")
}

/// Returns an assembly whose captures happen one after the other.
fn mast(claims: &str) -> String {
    let body = "seed plate 1 x 1 { M at (0, 0) } phase grow { M.up ->> T[1..9] }";
    format!("assembly mast {{ {body} {claims} }}")
}

fn command(arguments: &str, text: &str) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "tower.sa");
    fs::write(&file, text).unwrap();
    stochc_with(arguments, &[&file])
}

#[test]
fn claims_hold_fail_or_stay_undecided() {
    let text = tower(
        "expect complete within 20000 ticks with probability >= 90 %
        expect complete with probability <= 0.2
        expect mean completion <= 20000 ticks
        expect mean completion <= 1 ticks
        expect phase grow within 1700 ticks with probability >= 0.5
        expect captured T[2] by T[1] with probability >= 0.9",
    );
    let arguments = "test --json --quiet --model rate --runs 100";
    let outcome = command(arguments, &text);
    assert_output("claims", &outcome);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let document = outcome.json();
    let claims = document["claims"].as_array().unwrap();
    let verdicts: Vec<_> = claims
        .iter()
        .map(|it| it["verdict"].as_str().unwrap())
        .collect();
    assert_eq!(verdicts[..4], ["holds", "fails", "holds", "fails"]);
    assert_eq!(verdicts[5], "holds");
    for claim in claims {
        let [runs, low, high] = ["runs", "low", "high"].map(|it| claim[it].as_f64().unwrap());
        assert!(runs <= 100.0 && low < high, "{claim}");
        assert_eq!(claim["model"], "rate");
    }
    // Only the CPU times differ.
    let again = command(arguments, &text).json();
    let again = again["claims"].as_array().unwrap();
    for (claim, again) in claims.iter().zip(again) {
        assert_eq!(claim["low"], again["low"]);
        assert_eq!(claim["runs"], again["runs"]);
    }
}

/// The rate model has an error of 20 % at most, so it decides claims with a large distance.
#[test]
fn the_default_model_is_the_rate_model_where_its_error_does_not_matter() {
    let text = tower("expect complete within 40000 ticks with probability >= 0.5");
    let outcome = command("test --json --quiet", &text);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(outcome.json()["claims"][0]["model"], "rate");
    let capture = tower("expect captured T[1] by M with probability >= 0.5");
    let outcome = command("test --json --quiet", &capture);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(outcome.json()["claims"][0]["model"], "rigid");
}

/// An arm breaks at its third capture, in every run. It never completes.
pub(crate) const BREAKING: &str = "scene tank from hemisphere { gravity 1 m/s^2
    bond attract { pull 2 N within 10cm  anchor centres 1mm  strength { force 1 mN } } }
    assembly arm in tank {
        seed plate 1 x 1 { M at (0, 0) } phase grow { M.up -> A.up -> B.east -> C.east -> D }
        expect complete with probability <= 0.1
        expect mean completion <= 90000 ticks
        expect phase grow within 90000 ticks with probability >= 0.5
    }";

#[test]
fn broken_bonds_decide_claims() {
    let outcome = command(
        "test --json --quiet --model shuffle --allow warnings",
        BREAKING,
    );
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let document = outcome.json();
    let claims = document["claims"].as_array().unwrap();
    let verdicts = claims.iter().map(|it| it["verdict"].as_str().unwrap());
    assert_eq!(verdicts.collect::<Vec<_>>(), ["holds", "fails", "fails"]);
}

#[test]
fn captures_one_after_the_other_need_no_runs() {
    let text = mast(
        "expect complete within 40000 ticks with probability >= 0.99
        expect complete within 1 ticks with probability >= 0.01
        expect mean completion <= 40000 ticks
        expect faster than tower by 1 %",
    );
    let other =
        "assembly tower { seed plate 1 x 1 { M at (0, 0) } phase grow { M.up ->> T[1..3] } }";
    let outcome = command("test --json --quiet", &(text.clone() + other));
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    assert_output("claims", &outcome);
    let document = outcome.json();
    let claims = document["claims"].as_array().unwrap();
    for claim in claims.iter().take(3) {
        assert_eq!(claim["method"], "convolution");
        assert_eq!(
            (&claim["runs"], &claim["model"]),
            (&0.into(), &"rate".into())
        );
    }
    let verdicts = claims.iter().map(|it| it["verdict"].as_str().unwrap());
    assert_eq!(
        verdicts.collect::<Vec<_>>(),
        ["holds", "fails", "holds", "fails"]
    );
}

/// Runs that were stopped before the time of a claim are no successes.
#[test]
fn stopped_runs_decide_only_shorter_times() {
    let text = tower(
        "expect complete within 30 ticks with probability >= 0.5
        expect complete within 60 ticks with probability >= 0.5",
    );
    let arguments = "test --json --quiet --model rate --max-ticks 50 --runs 100";
    let outcome = command(arguments, &text);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let document = outcome.json();
    assert_eq!(document["claims"][0]["verdict"], "fails");
    assert_eq!(document["claims"][1]["verdict"], "undecided");
    assert_eq!(document["claims"][1]["high"], 1.0);
    let at_limit = tower("expect complete within 50 ticks with probability >= 0.5");
    let document = command(arguments, &at_limit).json();
    assert_eq!(document["claims"][0]["verdict"], "fails");
    assert_eq!(
        document["claims"][0]["high"]
            .as_f64()
            .map(|high| high < 0.5),
        Some(true)
    );
}

/// A tick takes 20 ms, so the first run ends at the latest whole tick before the bound.
#[test]
fn bounds_in_seconds_are_not_rounded_to_ticks() {
    let text = tower(
        "expect complete within 0.99 s with probability >= 0.5
        expect complete within 990.1 ms with probability >= 0.5
        expect complete within 0.3 s with probability >= 0.5
        expect mean completion <= 30 ms",
    );
    let document = command("test --json --quiet --model rate", &text).json();
    let claims = document["claims"].as_array().unwrap();
    let texts: Vec<_> = claims
        .iter()
        .map(|it| it["claim"].as_str().unwrap())
        .collect();
    let texts_with_limits = [
        "complete within 49.5 ticks with probability >= 0.5",
        "complete within 49.505 ticks with probability >= 0.5",
        "complete within 15 ticks with probability >= 0.5",
        "mean completion <= 1.5 ticks",
    ];
    assert_eq!(texts, texts_with_limits);
}

#[test]
fn programs_of_the_same_name_show_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let files = ["one.sa", "other.sa"].map(|name| path(folder.path(), name));
    let text = tower("expect complete within 40000 ticks with probability >= 0.5");
    for file in &files {
        fs::write(file, &text).unwrap();
    }
    let files = files.each_ref().map(String::as_str);
    let outcome = stochc_with("test --quiet --model rate", &files);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    for file in files {
        let label = format!("tower ({file})");
        assert!(outcome.out.contains(&label), "{}", outcome.out);
    }
    let junit = stochc_with("test --quiet --model rate --format junit", &files);
    for file in files {
        let suite = format!("<testsuite name=\"tower ({file})\"");
        assert!(junit.out.contains(&suite), "{}", junit.out);
    }
    let alone = stochc_with("test --quiet --model rate", &files[..1]);
    assert!(!alone.out.contains("tower ("), "{}", alone.out);
}

#[test]
fn programs_are_compared_in_pairs() {
    let text = tower("expect faster than mast by 30 %") + &mast("");
    let outcome = command("test --quiet --model rate", &text);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome.out.contains("faster than mast by 30 %"),
        "{}",
        outcome.out
    );
    assert!(
        outcome.out.contains("1 hold, 0 fail, 0 undecided."),
        "{}",
        outcome.out
    );
}

/// Each claim is a test case. Undecided claims are errors, so that continuous integration shows
/// them.
#[test]
fn verdicts_are_written_as_junit() {
    let text = tower(
        "expect complete within 20000 ticks with probability >= 0.9
        expect mean completion <= 1 ticks
        expect complete within 60 ticks with probability >= 0.5",
    );
    let arguments = "test --format junit --quiet --model rate --max-ticks 50 --runs 100";
    let outcome = command(arguments, &text);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let document = roxmltree::Document::parse(&outcome.out).unwrap();
    let root = document.root_element();
    for (count, number) in [("tests", "3"), ("failures", "1"), ("errors", "2")] {
        assert_eq!(root.attribute(count), Some(number), "{}", outcome.out);
    }
    let cases = root.descendants().filter(|it| it.has_tag_name("testcase"));
    let names: Vec<_> = cases.map(|it| it.attribute("name").unwrap()).collect();
    assert_eq!(names[1], "mean completion <= 1 ticks");
    let failure = root.descendants().find(|it| it.has_tag_name("failure"));
    let message = failure.and_then(|it| it.attribute("message")).unwrap();
    assert!(
        message.starts_with("estimate ?, limits 51 to ∞, 100 runs"),
        "{message}"
    );
}

#[test]
fn wrong_claims_have_diagnostics() {
    for (claim, code) in [
        ("complete with probability >= 1", "wrong-claim"),
        (
            "complete within 4 kg with probability >= 0.5",
            "wrong-dimension",
        ),
        (
            "complete within 4 with probability >= 0.5",
            "wrong-dimension",
        ),
        ("complete with probability >= 0.5 s", "wrong-dimension"),
        ("phase grew with probability >= 0.5", "unknown-name"),
        ("captured T[4] by M with probability >= 0.5", "unknown-name"),
        ("captured T[3] by M with probability >= 0.5", "wrong-claim"),
        (
            "captured T[1..2] by M with probability >= 0.5",
            "range-misused",
        ),
        ("faster than tower", "wrong-claim"),
        ("faster than mast", "unknown-name"),
        ("faster than tower by 120 %", "wrong-claim"),
        ("mean completion >= 0 ticks", "wrong-dimension"),
        ("complete by 5 s", "syntax"),
    ] {
        let outcome = command("check --format short", &tower(&format!("expect {claim}")));
        assert_eq!(outcome.status, 1, "{claim}: {}", outcome.err);
        let output = outcome.out + &outcome.err;
        assert!(output.contains(code), "{claim}: {output}");
    }
    let inside = "assembly tower { seed plate 1 x 1 { M at (0, 0) }
        phase grow { M.up -> A expect complete with probability >= 0.5 } }";
    let outcome = command("check --format short", inside);
    assert!((outcome.out + &outcome.err).contains("misplaced"));
}

#[test]
fn a_program_without_claims_has_nothing_to_test() {
    let outcome = command("test", &tower(""));
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    assert!(outcome.err.contains("contain no claims"), "{}", outcome.err);
}
