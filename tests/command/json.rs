//! Tests the schemas of all JSON documents. `docs/reference/json.md` is generated from these
//! schemas.
use std::collections::BTreeSet;
use std::fs;

use serde_json::{Map, Value, json};

use crate::claims::BREAKING;
use crate::pages::assert_page;
use crate::stochc::{Outcome, path, stochc, stochc_with};

const SCHEMA: &str = include_str!("../../docs/reference/json.schema.json");

/// Keywords of JSON Schema that do not restrict a value.
const ANNOTATIONS: [&str; 4] = ["title", "description", "$schema", "$defs"];

/// JSON schemas of all documents, with a validator for the keywords that they use.
struct Schemas(Value);

impl Schemas {
    fn new() -> Schemas {
        Schemas(serde_json::from_str(SCHEMA).unwrap())
    }

    fn definition(&self, name: &str) -> &Value {
        let definition = &self.0["$defs"][name];
        assert!(definition.is_object(), "no definition of `{name}`");
        definition
    }

    fn resolve<'a>(&'a self, schema: &'a Value) -> &'a Value {
        match schema["$ref"].as_str() {
            Some(name) => self.definition(name.trim_start_matches("#/$defs/")),
            None => schema,
        }
    }

    /// Returns the errors of a value against a schema, each with its path in the document.
    fn errors(&self, schema: &Value, value: &Value, at: &str) -> Vec<String> {
        let schema = self.resolve(schema);
        let keywords = schema.as_object().unwrap();
        let keywords = keywords
            .iter()
            .filter(|(it, _)| !ANNOTATIONS.contains(&&***it));
        let errors = keywords.flat_map(|(keyword, rule)| match &**keyword {
            "type" => wrong(at, value, "type", has_type(rule, value)),
            "const" => wrong(at, value, "constant", value == rule),
            "enum" => wrong(at, value, "word", rule.as_array().unwrap().contains(value)),
            "minimum" => {
                let number = value.as_f64();
                let fits = number.is_none_or(|it| it >= rule.as_f64().unwrap());
                wrong(at, value, "minimum", fits)
            }
            "anyOf" => {
                let rules = rule.as_array().unwrap();
                let fits = rules.iter().any(|it| self.errors(it, value, at).is_empty());
                wrong(at, value, "alternative", fits)
            }
            "items" => self.of_items(rule, value, at),
            "prefixItems" => {
                let pairs = rule
                    .as_array()
                    .unwrap()
                    .iter()
                    .zip(value.as_array().unwrap());
                pairs
                    .flat_map(|(rule, it)| self.errors(rule, it, at))
                    .collect()
            }
            "properties" => self.of_properties(rule, value, at),
            "required" => missing(rule, value, at),
            "additionalProperties" => unknown(&schema["properties"], value, at),
            other => panic!("no rule for `{other}`"),
        });
        errors.collect()
    }

    fn of_items(&self, rule: &Value, value: &Value, at: &str) -> Vec<String> {
        let items = value.as_array().into_iter().flatten().enumerate();
        let errors = items.flat_map(|(i, it)| self.errors(rule, it, &format!("{at}[{i}]")));
        errors.collect()
    }

    fn of_properties(&self, rule: &Value, value: &Value, at: &str) -> Vec<String> {
        let rules = rule.as_object().unwrap().iter();
        let known = rules.filter_map(|(key, rule)| Some((key, rule, value.get(key)?)));
        let errors =
            known.flat_map(|(key, rule, it)| self.errors(rule, it, &format!("{at}.{key}")));
        errors.collect()
    }
}

fn wrong(at: &str, value: &Value, what: &str, fits: bool) -> Vec<String> {
    let error = (!fits).then(|| format!("{at}: {value} has the wrong {what}"));
    error.into_iter().collect()
}

fn missing(rule: &Value, value: &Value, at: &str) -> Vec<String> {
    let Some(fields) = value.as_object() else {
        return Vec::new();
    };
    let required = rule
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it.as_str().unwrap());
    let missing = required.filter(|key| !fields.contains_key(*key));
    missing
        .map(|key| format!("{at}: `{key}` is missing"))
        .collect()
}

fn unknown(properties: &Value, value: &Value, at: &str) -> Vec<String> {
    let fields = value.as_object().into_iter().flat_map(Map::keys);
    let unknown = fields.filter(|key| properties.get(key).is_none());
    unknown
        .map(|key| format!("{at}: `{key}` is not documented"))
        .collect()
}

fn has_type(rule: &Value, value: &Value) -> bool {
    let is = |kind: &str| match kind {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("no type `{other}`"),
    };
    match rule {
        Value::Array(kinds) => kinds.iter().any(|kind| is(kind.as_str().unwrap())),
        kind => is(kind.as_str().unwrap()),
    }
}

#[track_caller]
fn assert_valid(name: &str, text: &str) {
    let value: Value = serde_json::from_str(text).unwrap_or_else(|_| panic!("{name}: {text}"));
    let schemas = Schemas::new();
    let errors = schemas.errors(schemas.definition(name), &value, name);
    assert!(errors.is_empty(), "{}", errors.join("\n"));
}

#[track_caller]
pub fn assert_output(name: &str, outcome: &Outcome) {
    assert!(
        [0, 1, 3].contains(&outcome.status),
        "{name}: {}",
        outcome.err
    );
    assert_valid(name, &outcome.out);
}

const LATE: &str = "tests/fixtures/late.sa";

#[test]
fn results_have_schemas() {
    let folder = tempfile::tempdir().unwrap();
    let [out, cut] = ["out", "cut"].map(|name| path(folder.path(), name));
    let files = ["examples/five_tower_reconfigured.sa", LATE];
    let simulate = "simulate --quiet --model shuffle --runs 4 --json --captures --out";
    let outcome = stochc_with(simulate, &[&[out.as_str()], &files[..]].concat());
    assert_output("show", &outcome);
    assert_output("show", &stochc_with("show --json", &[&out]));
    let alone = "trace --model rigid --substeps 1 --max-ticks 400 --json --quiet --run 0";
    assert_output("runs", &stochc_with(alone, &files));
    let breaking = path(folder.path(), "breaking.sa");
    fs::write(&breaking, BREAKING).unwrap();
    let trace = "trace --model shuffle --allow warnings --json --quiet";
    let broken = stochc_with(trace, &[&breaking]);
    assert_output("runs", &broken);
    let outcome = &broken.json()["runs"][0]["outcome"];
    assert_eq!(outcome["is_broken"], true, "{outcome}");
    let shards = "shard new --quiet --model shuffle --runs 4 --shards 2 --out";
    assert_eq!(stochc_with(shards, &[&cut, LATE]).status, 0);
    assert_output("status", &stochc_with("shard status --json", &[&cut]));
    assert_output(
        "missing",
        &stochc_with("shard status --missing --json", &[&cut]),
    );
    let swept = path(folder.path(), "swept");
    let sweep = "sweep --quiet --model shuffle --runs 3 --vary tick=10,40ms --out";
    stochc_with(sweep, &[&swept, LATE]);
    let text = fs::read_to_string(path(swept.as_ref(), "sweep.json")).unwrap();
    assert_valid("sweep", &text);
}

#[test]
fn estimates_plans_and_trades_have_schemas() {
    let line = "examples/line.sa";
    assert_output("estimate", &stochc_with("estimate --json --quiet", &[line]));
    let runs = "estimate --runs 5 --json --quiet";
    assert_output("estimate", &stochc_with(runs, &[line]));
    let measured = tempfile::tempdir().unwrap();
    let measured = path(measured.path(), "measured");
    let import =
        "import examples/bench/log.csv --program examples/five_tower_reconfigured.sa --quiet --out";
    assert_eq!(stochc_with(import, &[&measured]).status, 0);
    let remaining = stochc_with("estimate --json --remaining", &[&measured]);
    assert_output("remaining", &remaining);
    assert_eq!(remaining.json()["remaining"][0]["happened"], 7);
    let plan = "plan examples/planned/chair.sa --tries 3 --json --quiet";
    assert_output("plan", &stochc(plan));
    let folder = tempfile::tempdir().unwrap();
    let loose = path(folder.path(), "loose.txt");
    fs::write(&loose, "#..\n\n..#\n").unwrap();
    let refused = stochc_with("plan --json --quiet", &[&loose]);
    assert_eq!(refused.status, 1, "{}", refused.err);
    assert_valid("plan_error", &refused.out);
    let fit = "fit examples/fit/small.sa --data examples/fit/stopped.csv --vary free=8..60 --runs 4 \
               --points 8 --hold-out two --quiet --json";
    assert_output("fit", &stochc(fit));
    let optimize = "optimize --model rate --runs 40 --confirm 10 --vary length=1..6 examples/windmill.sa --json --quiet";
    assert_output("optima", &stochc(optimize));
    let trade = "trade tests/fixtures/still.sa --runs 2 --finest 1 --max-ticks 50 --quiet --json";
    assert_output("trade", &stochc(trade));
}

#[test]
fn checks_have_schemas() {
    let files = "examples/five_tower.sa examples/experiment_2.sa tests/fixtures/wrong.sa";
    assert_output("check", &stochc(&format!("check --json {files}")));
    let outcome = stochc("check --json --cost=2 --physics examples/five_tower.sa");
    assert_output("check", &outcome);
    let cost = &outcome.json()["programs"][0]["cost"];
    assert_eq!(cost["captures"].as_array().unwrap().len(), 2);
    assert!(cost["total"]["median"].is_number(), "{cost}");
    // Only the document contains the costs.
    assert!(!outcome.err.contains("depth"), "{}", outcome.err);
}

#[test]
fn verifications_have_schemas() {
    let files = "examples/gate.sa tests/fixtures/aggregate.sa tests/fixtures/wrong.sa";
    let outcome = stochc(&format!("verify --json {files}"));
    assert_output("verify", &outcome);
    let document = outcome.json();
    let programs = document["programs"].as_array().unwrap();
    assert_eq!(programs[0]["exploration"]["outcome"], "every_order");
    for program in programs {
        let is_right = program["proved"].is_object();
        assert_eq!(program.get("exploration").is_some(), is_right, "{program}");
    }
    assert!(!document["diagnostics"].as_array().unwrap().is_empty());
    for (file, survived) in [
        ("examples/gate.sa", "not_survived"),
        ("examples/dead_blocks.sa", "every_order"),
    ] {
        let outcome = stochc(&format!("verify --json --faults 1 {file}"));
        assert_output("verify", &outcome);
        let survival = &outcome.json()["programs"][0]["exploration"]["survival"];
        assert_eq!(survival["outcome"], survived);
    }
    let outcome = stochc("verify --json --states 5 examples/gate.sa");
    let exploration = &outcome.json()["programs"][0]["exploration"];
    assert_eq!(exploration["outcome"], "random_orders");
    assert_eq!(exploration["orders"], 1000);
}

#[test]
fn stages_of_the_compiler_have_schemas() {
    for stage in ["structure", "graph", "table"] {
        let compile = format!("compile --format json --emit {stage} examples/line.sa");
        assert_output("compile", &stochc(&compile));
    }
}

/// Checks that the validator itself detects errors.
#[test]
fn a_document_that_differs_from_its_schema_is_rejected() {
    let schemas = Schemas::new();
    let errors = |value: &Value| schemas.errors(schemas.definition("status"), value, "");
    let valid = json!({
        "format": 1, "shards": 2, "runs": 8, "missing": [0],
        "states": [{ "state": "missing" }, { "state": "whole" }],
    });
    assert_eq!(errors(&valid), [""; 0]);
    for (key, value, reason) in [
        ("format", json!(2), "constant"),
        ("runs", json!(-1), "minimum"),
        ("shards", json!("2"), "type"),
        ("missing", json!([0.5]), "missing[0]"),
        ("more", json!(1), "`more` is not documented"),
        ("states", json!([{ "state": "lost" }]), "word"),
        ("states", json!([{ "runs": 1 }]), "`state` is missing"),
    ] {
        let mut corrupted = valid.clone();
        corrupted[key] = value;
        let errors = errors(&corrupted);
        assert!(
            errors.len() == 1 && errors[0].contains(reason),
            "{errors:?}"
        );
    }
}

/// Checks that `docs/reference/json.md` lists every document and every key.
///
/// `STOCHC_WRITE_DOCS=1 cargo test --test command json::every` updates the page.
#[test]
fn every_key_is_documented() {
    let schemas = Schemas::new();
    let documents = schemas.0["anyOf"].as_array().unwrap().iter();
    let documents = documents.map(|it| it["$ref"].as_str().unwrap().trim_start_matches("#/$defs/"));
    let documents: Vec<&str> = documents.collect();
    let mut page = HEAD.to_owned();
    for name in &documents {
        page += &section(&schemas, "##", schemas.definition(name));
    }
    page += "\n## Parts\n\nThe documents contain these objects.\n";
    let parts = schemas.0["$defs"].as_object().unwrap();
    let shown: BTreeSet<&str> = documents.into_iter().collect();
    for (_, part) in parts.iter().filter(|(name, _)| !shown.contains(&***name)) {
        page += &section(&schemas, "###", part);
    }
    assert_page("docs/reference/json.md", &page);
}

const HEAD: &str = "\
# JSON

Commands print JSON with `--json`. Each document is an object. Its key `format` is the version of the document's format, which is 1.
Results go to standard output. Notes, warnings and errors go to standard error.

[json.schema.json](json.schema.json) is a [JSON Schema](https://json-schema.org) of all documents on this page.
A key is always present unless it is optional. The type of a key states whether its value can be null.

Other files have their own pages: [executable programs](executable.md), [tables](results.md#tables), [recordings](recordings.md).
`manifest.json`, `checksums.json`, `shards.json` and the journals are internal files of stochc. They may change between versions.
";

fn section(schemas: &Schemas, level: &str, schema: &Value) -> String {
    let [title, description] = ["title", "description"].map(|key| schema[key].as_str().unwrap());
    let mut text = format!("\n{level} {title}\n\n{description}\n");
    if let Some(words) = schema.get("enum") {
        text += &format!("\nOne of {}.\n", kind(schemas, &json!({ "enum": words })));
    }
    let Some(properties) = schema["properties"].as_object() else {
        return text;
    };
    let required = schema["required"].as_array().unwrap();
    text += "\n| key | type | meaning |\n|---|---|---|\n";
    for (key, rule) in properties {
        let optional = if required.contains(&json!(key)) {
            ""
        } else {
            ", optional"
        };
        let meaning = rule["description"].as_str().unwrap();
        text += &format!(
            "| `{key}` | {}{optional} | {meaning} |\n",
            kind(schemas, rule)
        );
    }
    if schema.get("additionalProperties").is_none() {
        text += "\nIt may have further keys.\n";
    }
    text
}

/// Returns the type that a rule of the schema describes, as text.
fn kind(schemas: &Schemas, rule: &Value) -> String {
    if rule.get("$ref").is_some() {
        let title = schemas.resolve(rule)["title"].as_str().unwrap();
        return format!("[{title}](#{})", title.replace(' ', "-"));
    }
    if let Some(words) = rule["enum"].as_array() {
        let words = words
            .iter()
            .map(|word| format!("`{}`", word.as_str().unwrap()));
        return words.collect::<Vec<_>>().join(", ");
    }
    if let Some(kinds) = rule["anyOf"].as_array() {
        let kinds = kinds.iter().map(|it| kind(schemas, it));
        return kinds.collect::<Vec<_>>().join(" or ");
    }
    if let Some(constant) = rule.get("const") {
        return format!("`{constant}`");
    }
    let one = |name: &str| match name {
        "array" => match rule.get("items") {
            Some(items) => format!("list of {}", kind(schemas, items)),
            None => "pair".to_owned(),
        },
        "object" => match rule["properties"].as_object() {
            Some(fields) => {
                let fields = fields.iter();
                let fields = fields.map(|(key, it)| format!("`{key}` ({})", kind(schemas, it)));
                format!("object of {}", fields.collect::<Vec<_>>().join(", "))
            }
            None => "object".to_owned(),
        },
        other => other.to_owned(),
    };
    match &rule["type"] {
        Value::Array(kinds) => {
            let kinds = kinds.iter().map(|it| one(it.as_str().unwrap()));
            kinds.collect::<Vec<_>>().join(" or ")
        }
        kind => one(kind.as_str().unwrap()),
    }
}
