//! Reports in SARIF. `python/tests/test_sarif.py` holds them against the published schema.
use serde_json::Value;
use stochc::compiler::diagnostic::Code;
use stochc::compiler::{Checked, Level, Limits, LintLevels, check_with};
use stochc::diagnostics::SarifLog;

/// The report on some files.
fn report<'a>(checks: impl IntoIterator<Item = (&'a str, Checked)>) -> Value {
    let mut log = SarifLog::new(Some("/projects/towers".as_ref()));
    for (path, checked) in checks {
        log.add(path, &checked);
    }
    serde_json::from_str(&log.document()).unwrap()
}

fn checked(path: &str, text: &str, levels: &LintLevels) -> Checked {
    let mut reader = |asked: &str| match asked == path {
        true => Ok(text.as_bytes().to_vec()),
        false => Err("no such file".to_owned()),
    };
    check_with(path, &mut reader, Limits::default(), levels)
}

#[test]
fn every_code_is_a_rule_and_every_result_has_its_number() {
    let text = "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { Q.up -> A } }";
    let report = report([("a.sa", checked("a.sa", text, &LintLevels::default()))]);
    let run = &report["runs"][0];
    let rules = run["tool"]["driver"]["rules"].as_array().unwrap();
    assert_eq!(rules.len(), Code::ALL.len());
    for result in run["results"].as_array().unwrap() {
        let number = result["ruleIndex"].as_u64().unwrap() as usize;
        assert_eq!(rules[number]["id"], result["ruleId"]);
    }
    let unused = rules
        .iter()
        .find(|rule| rule["id"] == "unused-seed")
        .unwrap();
    assert_eq!(unused["defaultConfiguration"]["level"], "warning");
    assert_eq!(
        unused["shortDescription"]["text"],
        "a seed that captures nothing"
    );
}

#[test]
fn places_count_characters_and_name_their_file() {
    let name = "/projects/towers/zwei türme.sa";
    let text = "assembly a { seed plate 1 x 1 { M at (0, 0) }\n\
                phase p { /* */ } }\n// µµ\nassembly b { /* µ */ seed plate 1 x 1 { } }";
    let report = report([(name, checked(name, text, &LintLevels::default()))]);
    let result = &report["runs"][0]["results"][0];
    let place = &result["locations"][0]["physicalLocation"];
    assert_eq!(place["artifactLocation"]["uri"], "zwei%20t%C3%BCrme.sa");
    assert_eq!(place["region"]["startLine"], 2);
    assert_eq!(place["region"]["startColumn"], 11);
    let wide = "let µ";
    let report = self::report([("a.sa", checked("a.sa", wide, &LintLevels::default()))]);
    let region = &report["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["region"];
    assert_eq!(
        (&region["startColumn"], &region["endColumn"]),
        (&5.into(), &6.into())
    );
}

#[test]
fn levels_fixes_and_reasons_are_in_the_report() {
    let text = "allow empty-phase \"not yet\"\nassembly a {\n    seed plate 2 x 1 {\n        \
                M at (0, 0)\n        N at (1, 0)\n    }\n    phase p { M.up -> A }\n    phase q { }\n    \
                phase r { A.up -> B after A }\n}\n";
    let mut levels = LintLevels::default();
    levels.set(Some(Code::UnusedSeed), Level::Deny);
    levels.set(Some(Code::RedundantAfter), Level::Allow);
    let mut nothing = |_: &str| Err("no such file".to_owned());
    let missing = check_with("none.sa", &mut nothing, Limits::default(), &levels);
    let missing = ("none.sa", missing);
    let mut report = report([("a.sa", checked("a.sa", text, &levels)), missing]);
    // The number of a rule changes with every new code; another test compares it.
    for result in report["runs"][0]["results"].as_array_mut().unwrap() {
        result.as_object_mut().unwrap().remove("ruleIndex");
    }
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_json_snapshot!("sarif", report["runs"][0]["results"]);
    });
    assert_eq!(
        report["runs"][0]["invocations"][0]["executionSuccessful"],
        false
    );
}
