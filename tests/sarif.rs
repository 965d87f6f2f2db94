//! Reports in SARIF, held against the published schema.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests read the schema and the programs from the disk"
)]
use std::sync::LazyLock;

use jsonschema::Validator;
use serde_json::Value;
use stochc::compiler::diagnostic::Code;
use stochc::compiler::{Checked, Level, Limits, LintLevels, check_with};
use stochc::diagnostics::Log;

static SCHEMA: LazyLock<Validator> = LazyLock::new(|| {
    let text = std::fs::read_to_string("tests/sarif/sarif-schema-2.1.0.json").unwrap();
    // Two patterns of the published schema have a bracket too many, which strict readers refuse.
    let text = text.replace("{2}]?$", "{2}$");
    let schema: Value = serde_json::from_str(&text).unwrap();
    let options = jsonschema::options().should_validate_formats(true);
    options.build(&schema).unwrap()
});

/// The report on some files as a document that follows the schema.
fn report<'a>(checks: impl IntoIterator<Item = (&'a str, Checked)>) -> Value {
    let mut log = Log::new(Some("/projects/towers".as_ref()));
    for (path, checked) in checks {
        log.add(path, &checked);
    }
    let document: Value = serde_json::from_str(&log.document()).unwrap();
    let errors: Vec<String> = (SCHEMA.iter_errors(&document))
        .map(|error| format!("{}: {error}", error.instance_path()))
        .collect();
    assert_eq!(errors, [""; 0]);
    document
}

fn checked(path: &str, text: &str, levels: &LintLevels) -> Checked {
    let mut reader = |asked: &str| match asked == path {
        true => Ok(text.as_bytes().to_vec()),
        false => Err("no such file".to_owned()),
    };
    check_with(path, &mut reader, Limits::default(), levels)
}

#[test]
fn the_schema_refuses_what_is_none() {
    for wrong in [
        r#"{ "version": "2.1.0" }"#,
        r#"{ "version": "2.1.0", "runs": [{}] }"#,
        r#"{ "version": "2.1.0", "runs": [{ "tool": { "driver": { "name": "a" } },
            "results": [{ "message": { "text": "m" }, "level": "bad" }] }] }"#,
        r#"{ "version": "2.1.0", "runs": [{ "tool": { "driver": { "name": "a" } },
            "results": [{ "message": { "text": "m" }, "locations": [{ "physicalLocation":
            { "artifactLocation": { "uri": "a b" } } }] }] }] }"#,
    ] {
        assert!(
            !SCHEMA.is_valid(&serde_json::from_str(wrong).unwrap()),
            "{wrong}"
        );
    }
}

#[test]
fn every_page_and_fixture_gives_a_valid_report() {
    let mut results = 0;
    for &code in Code::ALL {
        let page = code.page();
        let program = page
            .split_once("Wrong:\n\n```sa\n")
            .map_or("", |(_, rest)| rest);
        let program = program.split("```").next().unwrap_or_default();
        let report = report([(
            "page.sa",
            checked("page.sa", program, &LintLevels::default()),
        )]);
        results += report["runs"][0]["results"].as_array().unwrap().len();
    }
    assert!(results > 40);
    for entry in std::fs::read_dir("tests/findings").unwrap() {
        let path = entry.unwrap().path();
        let name = path.to_str().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        report([(name, checked(name, &text, &LintLevels::default()))]);
    }
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
