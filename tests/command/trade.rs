//! Small trades, in which a run takes milliseconds.
use std::fs;

use serde_json::Value;

use crate::stochc::{path, stochc, stochc_with};

/// Three runs of each setting, and hardly any refinement.
const DENSE: &str = "trade tests/fixtures/dense.sa --runs 3 --finest 2 --quiet";

fn candidates(trade: &Value) -> &Vec<Value> {
    trade["candidates"].as_array().unwrap()
}

fn candidate<'a>(trade: &'a Value, name: &str) -> &'a Value {
    let found = candidates(trade)
        .iter()
        .find(|candidate| candidate["name"] == name);
    found.unwrap_or_else(|| panic!("no candidate `{name}`"))
}

/// A trade without what a clock has said.
fn without_costs(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| {
                ![
                    "cost",
                    "cost_ratio",
                    "cost_of_tick",
                    "front",
                    "advice",
                    "threads",
                ]
                .contains(&name.as_str())
            });
            fields.values_mut().for_each(without_costs);
        }
        Value::Array(values) => values.iter_mut().for_each(without_costs),
        _ => {}
    }
}

#[test]
fn every_setting_is_measured_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let said = stochc_with(DENSE, &["--out", &out]);
    assert_eq!((said.status, said.err.as_str()), (0, ""));
    for command in ["show", "report", "verify"] {
        let other = stochc_with(command, &[&out]);
        assert_eq!((other.status, other.out.as_str()), (2, ""), "{command}");
        let told = format!(
            "`{out}` holds a trade, and no results; `stochc trade FILE... --out {out} --resume`"
        );
        assert!(other.err.contains(&told), "{}", other.err);
    }
    let again = stochc_with(DENSE, &["--out", &out, "--resume"]);
    assert_eq!((again.status, again.out.as_str()), (0, said.out.as_str()));
    let text = fs::read_to_string(path(out.as_ref(), "trade.json")).unwrap();
    let trade: Value = serde_json::from_str(&text).unwrap();
    for candidate in candidates(&trade) {
        let cell = &candidate["programs"][0];
        if candidate["name"] == "rate" || candidate["name"] == "estimate" {
            // Nobody has measured this scene.
            assert_eq!(cell["runs"], 0);
            assert!(said.out.contains("`stochc calibrate`"), "{}", said.out);
            continue;
        }
        assert_eq!(cell["runs"], 3, "{}", candidate["name"]);
        assert!(cell["mean"].as_f64().unwrap() > 1.0);
        assert!(cell["cost"].as_f64().unwrap() > 0.0);
        let name = candidate["name"].as_str().unwrap();
        let line = said
            .out
            .lines()
            .find(|line| line.contains(&format!(" {name} ")));
        assert!(line.is_some(), "{name}: {}", said.out);
    }
    assert_eq!(trade["reference"]["candidate"], 1, "rigid 2");
    assert_eq!(
        candidates(&trade)[1]["options"],
        "--model rigid --substeps 2"
    );
    assert_eq!(
        trade["reference"]["convergence"], "not_converged",
        "the only doubling has changed the mean"
    );
    assert!(said.out.contains("NOT CONVERGED"), "{}", said.out);
    assert!(
        said.out
            .contains(trade["advice"].as_str().unwrap().split(' ').next().unwrap())
    );
    assert!(!said.out.contains('\u{1b}'), "no colours into a pipe");

    // A run of it is a run of `simulate`.
    let alone = stochc(
        "simulate tests/fixtures/dense.sa --model rigid --substeps 1 --runs 3 --quiet --format json",
    );
    let mean = &candidate(&trade, "rigid 1")["programs"][0]["mean"];
    assert_eq!(&alone.json()["programs"][0]["time"]["mean"], mean);

    // It is not overwritten.
    let again = stochc_with(DENSE, &["--out", &out]);
    assert_eq!((again.status, again.out.as_str()), (2, ""));
    assert!(again.err.contains("is not empty"), "{}", again.err);
}

#[test]
fn the_picture_has_a_mark_for_every_setting() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let trade = stochc_with(DENSE, &["--format", "json", "--out", &out]).json();
    let text = fs::read_to_string(path(out.as_ref(), "trade.svg")).unwrap();
    let picture = roxmltree::Document::parse(&text).unwrap();
    let marks = picture.descendants().filter(|node| {
        node.attribute("class")
            .is_some_and(|class| class.starts_with("mark "))
    });
    let marks: Vec<_> = marks.collect();
    let measured = candidates(&trade)
        .iter()
        .filter(|candidate| !candidate["cost"].is_null());
    assert_eq!(marks.len(), measured.count());
    let of = |class: &str| {
        let class = format!("mark {class}");
        marks
            .iter()
            .filter(|node| node.attribute("class") == Some(&class))
            .count()
    };
    assert_eq!((of("s2"), of("reference"), of("hot")), (4, 1, 0));
    for mark in &marks {
        let told = (mark.descendants()).find(|node| node.tag_name().name() == "title");
        let told = told.and_then(|title| title.text());
        assert!(told.unwrap().starts_with("--model "));
    }
    let axes: String = picture
        .descendants()
        .filter_map(|node| node.text())
        .collect();
    assert!(axes.contains("processor time of a run") && axes.contains("% of the reference"));
    assert!(text.contains("prefers-color-scheme:dark"));
    assert!(
        !text.contains("http:") || text.matches("http:").count() == 1,
        "nothing is loaded"
    );
}

#[test]
fn it_depends_on_nothing_but_its_inputs() {
    let of = |threads: &str| {
        let mut trade = stochc_with(DENSE, &["--format", "json", "--threads", threads]).json();
        without_costs(&mut trade);
        trade
    };
    let one = of("1");
    assert_eq!(one, of("3"));
    let mut other = stochc_with(DENSE, &["--format", "json", "--seed", "2"]).json();
    without_costs(&mut other);
    assert_ne!(one["candidates"], other["candidates"], "the seed does");
}

#[test]
fn a_model_that_cannot_do_a_scene_is_told_of_with_the_reason() {
    let said = stochc("trade tests/fixtures/soft.sa --runs 2 --finest 1 --quiet");
    assert_eq!((said.status, said.err.as_str()), (0, ""));
    let row = said
        .out
        .lines()
        .find(|line| line.contains(" rapier 1 "))
        .unwrap();
    assert!(
        row.contains("the model `rapier` has no contact with a `stiffness`"),
        "{row}"
    );
}

#[test]
fn programs_are_ranked() {
    let said =
        stochc("trade tests/fixtures/dense.sa tests/fixtures/dense.sa --runs 2 --finest 1 --quiet");
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(said.out.contains("dense (2)"), "{}", said.out);
    // The same program twice.
    assert!(said.out.contains("no order to keep"), "{}", said.out);
}

#[test]
fn censored_runs_are_told_of() {
    let said = stochc("trade tests/fixtures/still.sa --runs 2 --finest 1 --max-ticks 50 --quiet");
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(
        said.out.contains("limit of ticks (still 50)"),
        "{}",
        said.out
    );
    assert!(
        said.out.contains("Too few runs were completed"),
        "{}",
        said.out
    );
}

/// The first runs, of which the limit of ticks follows, are others when more are asked for.
#[test]
fn more_runs_make_none_again() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let line = "trade tests/fixtures/dense.sa --finest 2 --quiet --format json --runs";
    let first = stochc_with(line, &["2", "--out", &out]).json();
    let more = stochc_with(line, &["5", "--out", &out, "--resume"]).json();
    let limit = |trade: &Value| trade["programs"][0]["max_ticks"].as_u64().unwrap();
    assert_ne!(limit(&first), limit(&more), "else nothing is shown");
    let journal = fs::read_to_string(path(out.as_ref(), "trade.jsonl")).unwrap();
    let measured = candidates(&more)
        .iter()
        .filter(|it| !it["settings"].is_null());
    let runs = measured.map(|it| it["programs"][0]["runs"].as_u64().unwrap());
    assert_eq!(journal.lines().count() as u64, 1 + runs.sum::<u64>());
    let mut at_once = stochc_with(line, &["5"]).json();
    let mut more = more;
    [&mut at_once, &mut more]
        .into_iter()
        .for_each(without_costs);
    assert_eq!(more, at_once);
}

#[test]
fn a_budget_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("trade").display().to_string();
    let line =
        format!("trade tests/fixtures/dense.sa --budget 3s --quiet --format json --out {folder}");
    let said = stochc(&line);
    assert_eq!(said.status, 0, "{}", said.err);
    let trade = said.json();
    assert_eq!(trade["budget"], 3.0);
    assert!(candidate(&trade, "rigid 1")["programs"][0]["runs"].as_u64() >= Some(4));
    // Processor time, so that it does not matter what else the machine does. A last run of each thread may end later.
    let number = |value: &Value| value.as_f64().unwrap_or_default();
    let programs = candidates(&trade)
        .iter()
        .flat_map(|candidate| candidate["programs"].as_array().unwrap());
    let spent: f64 = programs
        .map(|of| number(&of["runs"]) * number(&of["cost"]))
        .sum();
    assert!(
        spent > 0.0 && spent < 2.0 * 3.0 * number(&trade["threads"]),
        "{spent}"
    );
    // What was measured is there without any time left.
    let resumed = stochc(&format!("{line} --resume"));
    assert_eq!(resumed.status, 0, "{}", resumed.err);
    let resumed = resumed.json();
    for (before, after) in candidates(&trade).iter().zip(candidates(&resumed)) {
        let runs = |candidate: &Value| candidate["programs"][0]["runs"].as_u64();
        assert!(runs(after) >= runs(before), "{before}\n{after}");
    }
}

#[test]
fn wrong_command_lines_are_told_of() {
    for line in [
        "trade",
        "trade tests/fixtures/dense.sa --budget 10",
        "trade tests/fixtures/dense.sa --budget 0s",
        "trade tests/fixtures/dense.sa --budget -1s",
        "trade tests/fixtures/dense.sa --runs 1",
        "trade tests/fixtures/dense.sa --runs 5 --budget 1m",
    ] {
        let said = stochc(line);
        assert_eq!((said.status, said.out.as_str()), (2, ""), "{line}");
    }
    let said = stochc("trade tests/fixtures/crowded.sa --runs 2");
    assert_eq!(said.status, 1);
    assert!(
        said.err.contains("crowded: 400 free blocks do not fit"),
        "{}",
        said.err
    );
    let said = stochc("trade tests/fixtures/wrong.sa --runs 2");
    assert_eq!((said.status, said.out.as_str()), (1, ""));
}

#[test]
fn a_reduced_model_is_told_of() {
    let line = "simulate tests/fixtures/dense.sa --runs 2 --quiet --substeps 2 --seed 2 --reduce no-friction --allow coarse-step";
    let said = stochc(line);
    assert_eq!(said.status, 0);
    let note =
        "note: `no-friction` is a reduced model: it leaves out something that the scene has\n";
    assert!(said.err.starts_with(note), "{}", said.err);
}

/// A trade that was refused or killed before its first run leaves nothing that is in the way.
#[test]
fn what_is_left_of_a_trade_without_runs_is_in_nobodys_way() {
    let folder = tempfile::tempdir().unwrap();
    let (out, program) = (path(folder.path(), "out"), path(folder.path(), "dense.sa"));
    let dense = fs::read_to_string("tests/fixtures/dense.sa").unwrap();
    let stiff = dense.replace("wall 25 N/m", "wall 25000 N/m");
    assert_ne!(stiff, dense);
    fs::write(&program, stiff).unwrap();
    let command = [
        "trade", &program, "--runs", "2", "--finest", "2", "--quiet", "--out", &out,
    ];
    let [trade, more @ ..] = command;
    let refused = stochc_with(trade, &more);
    assert_eq!(refused.status, 1);
    assert!(refused.err.contains("too stiff"), "{}", refused.err);
    fs::write(&program, dense).unwrap();
    fs::write(format!("{out}/.lock"), "").unwrap();
    let said = stochc_with(trade, &more);
    assert_eq!((said.status, said.err.as_str()), (0, ""));
    // Now there is something.
    assert_eq!(stochc_with(trade, &more).status, 2);
    // What somebody else has written is no trade, whatever its name.
    let texts = ["my notes", "my notes\n", "{\"a\": 1}\n"];
    for (i, text) in texts.into_iter().enumerate() {
        let foreign = path(folder.path(), &format!("foreign{i}"));
        fs::create_dir(&foreign).unwrap();
        let file = format!("{foreign}/trade.jsonl");
        fs::write(&file, text).unwrap();
        for resume in [&[][..], &["--resume"]] {
            let command = [
                "trade", &program, "--runs", "2", "--quiet", "--out", &foreign,
            ];
            let said = stochc_with(command[0], &[&command[1..], resume].concat());
            assert_eq!(said.status, 2, "{}", said.err);
        }
        assert_eq!(fs::read_to_string(&file).unwrap(), text);
    }
}
