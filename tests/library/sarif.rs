//! Tests SARIF reports against the types that `serde-sarif` generates from the published schema.
use serde_json::{Value, json};
use serde_sarif::sarif::Sarif;
use stochc::compiler::diagnostic::Code;
use stochc::compiler::{Checked, Level, Limits, LintLevels, check_with};
use stochc::diagnostics::SarifLog;

/// Returns the SARIF report on several files.
fn report<'a>(checks: impl IntoIterator<Item = (&'a str, Checked)>) -> Value {
    let mut log = SarifLog::new(Some("/projects/towers".as_ref()));
    for (path, checked) in checks {
        log.add(path, &checked);
    }
    serde_json::from_str(&log.document()).unwrap()
}

fn checked(path: &str, text: &str, levels: &LintLevels) -> Checked {
    let mut reader = |requested: &str| {
        if requested == path {
            Ok(text.as_bytes().to_vec())
        } else {
            Err(std::io::Error::other("no such file"))
        }
    };
    check_with(path, &mut reader, Limits::default(), levels)
}

/// Returns a deviation from the schema: a missing field, a wrong type or level, or an unknown
/// field. Returns `None` if there is none.
fn mistake(document: &Value) -> Option<String> {
    match serde_json::from_value::<Sarif>(document.clone()) {
        Err(error) => Some(error.to_string()),
        // Unknown fields are lost when the parsed document is written again.
        Ok(log) => {
            let again = serde_json::to_value(&log).unwrap();
            (again != *document).then(|| "unknown field".to_owned())
        }
    }
}

#[test]
fn a_document_that_differs_from_the_schema_has_a_mistake() {
    let tool = json!({ "driver": { "name": "a" } });
    let result = |result: Value| json!({ "tool": tool, "results": [result] });
    let mistake_in = |run: Value| mistake(&json!({ "version": "2.1.0", "runs": [run] }));
    let message = json!({ "text": "m" });
    assert_eq!(mistake_in(result(json!({ "message": message }))), None);
    for (run, expected) in [
        (json!({}), "missing field `tool`"),
        (result(json!({})), "missing field `message`"),
        (
            result(json!({ "message": message, "level": "bad" })),
            "unknown variant `bad`",
        ),
        (
            result(json!({ "message": message, "ruleName": "a" })),
            "unknown field",
        ),
        (
            result(json!({ "message": message, "ruleIndex": "a" })),
            "invalid type",
        ),
    ] {
        let reported = mistake_in(run).unwrap_or_default();
        assert!(reported.contains(expected), "{expected}: {reported}");
    }
}

/// Checks reports on the invalid programs of all pages and tests.
#[test]
fn every_report_follows_the_schema() {
    let mut programs: Vec<(String, String)> = Vec::new();
    for entry in std::fs::read_dir("tests/findings").unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|it| it == "sa") {
            let path = path.to_str().unwrap();
            let text = String::from_utf8(stochc_files::read(path).unwrap()).unwrap();
            programs.push((path.to_owned(), text));
        }
    }
    for code in Code::ALL {
        if let Some((_, rest)) = code.page().split_once("Wrong:\n\n```sa\n") {
            let (program, _) = rest.split_once("```").unwrap();
            programs.push((format!("{code}.sa"), program.to_owned()));
        }
    }
    assert!(programs.len() > 40);
    let levels = LintLevels::default();
    let checks = programs.iter();
    let checks = checks.map(|(path, text)| (path.as_str(), checked(path, text, &levels)));
    let report = report(checks);
    assert_eq!(mistake(&report), None);
    assert_eq!(report["version"], "2.1.0");
    assert!(report["runs"][0]["results"].as_array().unwrap().len() > 40);
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
    assert_eq!(unused["shortDescription"]["text"], "a seed is never used");
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
    let mut nothing = |_: &str| Err(std::io::Error::other("no such file"));
    let missing = check_with("none.sa", &mut nothing, Limits::default(), &levels);
    let missing = ("none.sa", missing);
    let mut report = report([("a.sa", checked("a.sa", text, &levels)), missing]);
    // The index of a rule changes with every new code. Another test checks it.
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
