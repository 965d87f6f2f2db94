//! Tests sweeps: ensembles over scene parameters.
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::stochc::{Outcome, path, stochc_with, tables, unfolded};

const TOWER: &str = "sweep --model shuffle --quiet --runs 3 tests/fixtures/tower.sa";

fn text(folder: &str, name: &str) -> String {
    fs::read_to_string(Path::new(folder).join(name)).unwrap()
}

fn json(folder: &str, name: &str) -> Value {
    serde_json::from_str(&text(folder, name)).unwrap()
}

#[test]
fn a_parameter_is_swept_in_one_folder() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let sweep = ["--vary", "free=50..150/3", "--out", &out];
    let outcome = stochc_with(TOWER, &sweep);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    insta::assert_snapshot!(outcome.out);
    // Each point of the sweep is a program with its own scene.
    let manifest = json(&out, "manifest.json");
    let programs = manifest["programs"].as_array().unwrap();
    let of = |i: usize| (&programs[i]["name"], &programs[i]["scene"]["free"]["count"]);
    assert_eq!(of(0), (&"tower [free=50]".into(), &50.into()));
    assert_eq!(of(2), (&"tower [free=150]".into(), &150.into()));
    // The results are printed and written as JSON.
    let data = json(&out, "sweep.json");
    let point = &data["points"][1];
    assert_eq!(data["axes"][0]["name"], "free");
    assert_eq!(point["values"][0]["value"], 100.0);
    assert_eq!(
        (&point["completed"], &point["time"]["mean"]),
        (&3.into(), &3.0.into())
    );
    let csv = text(&out, "sweep.csv");
    let mut lines = csv.split_terminator("\r\n");
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("program,free,runs,completed,")
    );
    assert!(
        lines.next().unwrap().starts_with("tower,50,3,3,0,0,0,1,"),
        "{csv}"
    );
    for name in ["sweep.svg", "sweep-completed.svg"] {
        let picture = text(&out, name);
        let marks = picture.matches("<circle").count();
        assert_eq!(marks, 3, "a mark for each point of {name}");
        roxmltree::Document::parse(&picture).unwrap();
    }
    // `show` prints the same for the folder. Its points can be replayed and reported.
    assert_eq!(stochc_with("show", &[&out]).out, outcome.out);
    let again = stochc_with(TOWER, &sweep);
    assert_eq!(
        (again.status, again.out),
        (0, outcome.out),
        "finished already"
    );
    assert_eq!(stochc_with("report", &[&out]).status, 0);
    let page = text(&out, "report.html");
    assert!(page.contains("Sweeps"), "{page}");
    assert!(page.contains("--vary free=50,100,150 --out"), "the command");
    assert!(text(&out, "report-figures/sweep-1.svg").contains("over free"));
}

/// Checks that a pre-attached block does not count as captured. Only one of the two blocks of a run
/// is captured.
#[test]
fn pre_attached_blocks_are_not_captures() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "hand.sa");
    let text =
        "assembly hand { seed plate 1 x 1 { A at (0, 0)  A.up -> B }\nphase one { B.up -> C } }";
    fs::write(&file, text).unwrap();
    let out = path(folder.path(), "out");
    let line = "sweep --model shuffle --quiet --runs 5 --vary free=50,80";
    let outcome = stochc_with(line, &[&file, "--out", &out]);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    for point in json(&out, "sweep.json")["points"].as_array().unwrap() {
        assert_eq!(point["captures"], 5, "{point}");
        assert_eq!(point["time_per_capture"], point["time"]["mean"], "{point}");
    }
}

#[test]
fn two_parameters_are_combined() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let axes = ["--vary", "bond.pull=2..12 N/3", "--vary", "free=50,80"];
    let outcome = stochc_with(TOWER, &[&axes[..], &["--out", &out]].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    for point in [
        "bond.pull=2 N, free=50",
        "bond.pull=2 N, free=80",
        "bond.pull=12 N, free=80",
    ] {
        assert!(
            outcome.out.contains(&format!("tower [{point}]")),
            "{}",
            outcome.out
        );
    }
    // There is a curve over the first parameter for each value of the second.
    let picture = text(&out, "sweep.svg");
    assert!(picture.contains("bond.pull [N]"));
    assert!(
        picture.contains(">free=50<") && picture.contains(">free=80<"),
        "{picture}"
    );
    let scene = &json(&out, "manifest.json")["programs"][4]["scene"];
    assert_eq!(scene["bond"]["attract"]["pull"]["force"], 12.0);
    assert_eq!(scene["free"]["count"], 50);
    // If the second parameter has many values, a map replaces the curves.
    let out = path(folder.path(), "map");
    let axes = ["--vary", "bond.pull=2..12 N/3", "--vary", "free=50..57/8"];
    let outcome = stochc_with(TOWER, &[&axes[..], &["--out", &out]].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(
        text(&out, "sweep.svg").matches("<title>tower [").count(),
        24
    );
    let outcome = stochc_with("report", &[&out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let page = text(&out, "report.html");
    assert!(page.contains("24 points of sweeps are summarized in the section"));
    assert!(
        !page.contains("id=\"program-1\""),
        "no section for each of many points"
    );
}

/// Checks the elasticities of a tower that takes a tick per block.
#[test]
fn elasticities_are_slopes_of_logarithms() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "high.sa");
    let program = "assembly high(height = 2) { seed plate 1 x 1 { M at (0, 0) }
        phase grow { M.up ->> A[1..height] } }";
    fs::write(&file, program).unwrap();
    let sweep = |name: &str, more: &str| {
        let out = path(folder.path(), name);
        let line = format!("sweep --model shuffle --quiet --vary height=2,4,8 {more} --vary");
        let outcome = stochc_with(&line, &["contact.friction=0,1", &file, "--out", &out]);
        let elasticities = json(&out, "sweep.json")["elasticities"].clone();
        (outcome, elasticities, out)
    };
    let (outcome, all, out) = sweep("all", "--runs 10 --vary free=50,80");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let all = all.as_array().unwrap();
    assert_eq!(all.len(), 2, "a friction of 0 has no logarithm: {all:?}");
    for (it, name, expected) in [(&all[0], "height", 1.0), (&all[1], "free", 0.0)] {
        assert_eq!(
            (&it["program"], &it["parameter"]),
            (&"high".into(), &name.into())
        );
        assert_eq!(it["points"], 12);
        for end in ["value", "low", "high"] {
            let found = it["elasticity"][end].as_f64().unwrap();
            assert!((found - expected).abs() < 1e-9, "{it}");
        }
    }
    for row in ["high: height  1 (1 .. 1)", "high: free    0 (0 .. 0)"] {
        assert!(outcome.out.contains(row), "{}", outcome.out);
    }
    assert_eq!(stochc_with("report", &[&out]).status, 0);
    assert!(text(&out, "report.html").contains("Elasticities of the mean time"));
    // The mean of a stopped point is unknown.
    let (outcome, stopped, _) = sweep("stopped", "--runs 10 --max-ticks 6");
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    assert_eq!(stopped[0]["points"], 4);
    assert!(stopped[0]["elasticity"].is_object());
    let (outcome, few, _) = sweep("few", "--runs 9");
    assert_eq!(few[0]["elasticity"], Value::Null);
    assert!(!outcome.out.contains("elasticity"), "{}", outcome.out);
}

/// Checks that each value of a third parameter has its own figures, and that many values have none.
#[test]
fn a_third_parameter_makes_more_figures() {
    let folder = tempfile::tempdir().unwrap();
    let figures = |name: &str, ticks: &str| {
        let out = path(folder.path(), name);
        let axes = [
            "--vary",
            "free=50,60",
            "--vary",
            "bond.pull=2,4 N",
            "--vary",
            ticks,
        ];
        let outcome = stochc_with(TOWER, &[&axes[..], &["--out", &out]].concat());
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        let files = fs::read_dir(&out).unwrap();
        let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.filter(|name| name.ends_with(".svg")).collect();
        names.sort();
        (out, names)
    };
    let (out, names) = figures("few", "tick=10,20 ms");
    let expected = [
        "sweep-1-completed",
        "sweep-1",
        "sweep-2-completed",
        "sweep-2",
    ];
    assert_eq!(names, expected.map(|name| format!("{name}.svg")));
    let second = text(&out, "sweep-2.svg");
    assert!(second.contains("over free at tick=20 ms</title>"));
    // The figure contains the value of the third parameter, for printed pages.
    assert!(second.contains(">tick=20 ms<"), "{second}");
    let (out, names) = figures("many", "tick=10..16 ms/7");
    assert!(names.is_empty(), "{names:?}");
    assert_eq!(text(&out, "sweep.csv").lines().count(), 1 + 2 * 2 * 7);
}

/// Checks that two programs are compared at the same values, and that a program is never compared
/// with itself.
#[test]
fn programs_are_compared_at_the_same_point() {
    let more = ["tests/fixtures/importing.sa", "--vary", "free=50,80"];
    let outcome = stochc_with(TOWER, &[&more[..], &["--json"]].concat());
    let figures = outcome.json();
    let pairs = figures["pairs"].as_array().unwrap().iter();
    let pairs: Vec<_> = pairs
        .map(|pair| (&pair["first"], &pair["second"]))
        .collect();
    let pair = |n| {
        (
            Value::from(format!("tower [free={n}]")),
            Value::from(format!("importing [free={n}]")),
        )
    };
    let (first, second) = (pair(50), pair(80));
    assert_eq!(pairs, [(&first.0, &first.1), (&second.0, &second.1)]);
}

#[test]
fn timeouts_follow_the_tick_and_are_shown_as_bounds() {
    let folder = tempfile::tempdir().unwrap();
    let program = path(folder.path(), "timed.sa");
    let source = fs::read_to_string("tests/fixtures/late.sa").unwrap();
    fs::write(&program, source.replace("2 ticks", "40 ms")).unwrap();
    let out = path(folder.path(), "out");
    let outcome = stochc_with(
        "sweep --model shuffle --quiet --runs 3 --vary",
        &["tick=10,20 ms", &program, "--out", &out],
    );
    // Four ticks suffice for the three captures, but two do not.
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let data = json(&out, "sweep.json");
    let (early, late) = (&data["points"][0], &data["points"][1]);
    assert_eq!(data["unit"], "s", "the ticks are not those of one clock");
    assert_eq!(
        (&early["completed"], &early["timed_out"]),
        (&3.into(), &0.into())
    );
    assert_eq!(
        (&late["completed"], &late["timed_out"]),
        (&0.into(), &3.into())
    );
    assert_eq!(
        (&early["timed_out"], &late["timed_out"]),
        (&0.into(), &3.into())
    );
    let never = |outcome: &Outcome| outcome.out.replace("\n  ", " ").contains("never complete");
    assert!(never(&outcome), "{}", outcome.out);
    // A run that reached the limit of ticks gives no information about later times.
    let cut = stochc_with(TOWER, &["--vary", "free=50,80", "--max-ticks", "1"]);
    assert!(
        cut.out.contains("0 of 3") && cut.out.contains("≥ marks"),
        "{}",
        cut.out
    );
    assert!(!never(&cut), "{}", cut.out);
    assert_eq!(late["share"], 0.0);
    assert_eq!(late["time"]["median"], Value::Null);
    assert!(outcome.out.contains("late [tick=20 ms]"), "{}", outcome.out);
    assert!(
        outcome.out.contains("0 of 3") && outcome.out.contains("≥ 0.04"),
        "{}",
        outcome.out
    );
    assert!(
        text(&out, "sweep.svg").contains(">≥<"),
        "the bound is marked"
    );
}

#[test]
fn a_swept_folder_is_rerun_and_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, torn, again] = ["whole", "torn", "again"].map(|name| path(folder.path(), name));
    // Values with a ratio of three have many digits.
    let sweep = [
        "--vary",
        "agitation=0.1..0.3 m/s/4 log",
        "--vary",
        "free=50,60",
    ];
    let with = |more: &[&str]| stochc_with(TOWER, &[&sweep[..], more].concat());
    let outcome = with(&["--out", &whole]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    // The manifest alone is enough to repeat the sweep.
    let manifest = path(whole.as_ref(), "manifest.json");
    let rerun = stochc_with("repeat --quiet", &[&manifest, "--out", &again]);
    assert_eq!((rerun.status, rerun.err.as_str()), (0, ""));
    assert_eq!(rerun.out, outcome.out);
    assert!(tables(&whole) == tables(&again));
    assert_eq!(text(&whole, "sweep.json"), text(&again, "sweep.json"));
    // The folder is as a kill would leave it.
    fs::create_dir(&torn).unwrap();
    fs::copy(&manifest, path(torn.as_ref(), "manifest.json")).unwrap();
    let journal = text(&whole, "journal.jsonl");
    let half = &journal[..journal.len() / 2];
    fs::write(path(torn.as_ref(), "journal.jsonl"), half).unwrap();
    let results = stochc_with("show", &[&torn]);
    assert!(
        results.err.ends_with("of 24 runs are still to do\n"),
        "{}",
        results.err
    );
    assert!(
        results.out.contains("Some runs are not finished."),
        "{}",
        results.out
    );
    let refused = with(&["--out", &torn]);
    assert_eq!(refused.status, 2);
    assert!(refused.err.contains("stochc resume "), "{}", refused.err);
    let resumed = stochc_with("resume --quiet", &[&torn]);
    assert_eq!((resumed.status, resumed.out), (0, outcome.out));
    assert!(tables(&whole) == tables(&torn));
    assert_eq!(text(&whole, "sweep.csv"), text(&torn, "sweep.csv"));
    // A sweep over other values is another ensemble.
    let other = ["--vary", "agitation=0.1..0.3 m/s/4", "--vary", "free=50,60"];
    let outcome = stochc_with(TOWER, &[&other[..], &["--out", &torn]].concat());
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("the list of programs is"),
        "{}",
        outcome.err
    );
}

#[test]
fn a_point_can_be_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate = "sweep --quiet --runs 2 tests/fixtures/dense.sa";
    let outcome = stochc_with(simulate, &["--vary", "free=10,12", "--out", &out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let replay = ["--run", "1", "--program", "dense [free=10]"];
    let outcome = stochc_with("replay", &[&[&*out], &replay[..]].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let outcome = stochc_with("replay --run 1", &[&out]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("`dense [free=10]`, `dense [free=12]`"),
        "{}",
        outcome.err
    );
}

#[test]
fn a_missing_parameter_is_reported() {
    for (sweep, reason) in [
        (
            "fre=50",
            "the scene `hemisphere` has no number `fre`; did you mean `free`? (it has tick, block.side,",
        ),
        (
            "gravity=1 m/s^2",
            "the scene `hemisphere` declares no `gravity`",
        ),
        (
            "contact.restitution=0",
            "the scene `hemisphere` does not say `contact.restitution`",
        ),
        (
            "bond.pull=3 m",
            "`bond.pull` is a force, such as `15 N`, not a length",
        ),
        (
            "bond.pull=3",
            "`bond.pull` is a force, such as `15 N`, not a number without a unit; write the unit after the last value, such as `2,4,8 N`",
        ),
        (
            "free=50..600/7",
            "`free` is a whole number, and 7 values from 50 to 600 are not all",
        ),
        (
            "block.faces=0,1",
            "`block.faces` must be a whole number from 1 to 5, and is 0",
        ),
        (
            "bond.anchor.tilt=91 deg",
            "`bond.anchor.tilt` must be more than 0 and at most 90 deg, and is 91 deg",
        ),
    ] {
        let outcome = stochc_with(TOWER, &["--vary", sweep]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{sweep}");
        let reason = format!("error: --vary: {reason}");
        assert!(outcome.err.contains(&reason), "{sweep}: {}", outcome.err);
    }
    for sweep in [
        "free",
        "free=",
        "free=50..600",
        "free=1..2/1000000",
        "bond.pull=3 newton",
    ] {
        let outcome = stochc_with(TOWER, &["--vary", sweep]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{sweep}");
        assert!(
            outcome.err.contains("for '--vary"),
            "{sweep}: {}",
            outcome.err
        );
    }
    let outcome = stochc_with(TOWER, &["--substeps", "4", "--vary", "substeps=1,2"]);
    assert_eq!(outcome.status, 2);
    let reason = "`--substeps` and `--vary substeps=...` exclude each other";
    assert!(outcome.err.contains(reason), "{}", outcome.err);
}

#[test]
fn an_endless_sweep_is_rejected() {
    let axes = ["--vary", "free=100..199/100", "--vary", "tick=1..5 ms/5"];
    let outcome = stochc_with(TOWER, &axes);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome
            .err
            .contains("500 or more points, more than the limit of 400"),
        "{}",
        outcome.err
    );
    let many = TOWER.replace("--runs 3", "--runs 5000000");
    let outcome = stochc_with(&many, &["--vary", "free=50,60,70"]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("more than 10000000; lower `--runs`"),
        "{}",
        outcome.err
    );
}

#[test]
fn a_point_with_an_invalid_program_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let outcome = stochc_with(TOWER, &["--vary", "free=1,2,3", "--out", &out]);
    assert_eq!((outcome.status, outcome.out.as_str()), (1, ""));
    assert!(
        outcome
            .err
            .starts_with("error: `tower [free=1]` cannot be run:\n"),
        "{}",
        outcome.err
    );
    assert!(
        unfolded(&outcome.err)
            .contains("needs 3 free blocks at once, but scene `hemisphere` has 1"),
        "{}",
        outcome.err
    );
    assert!(
        outcome
            .err
            .ends_with("nor can these be run: tower [free=2]\n"),
        "{}",
        outcome.err
    );
    assert!(!Path::new(&out).exists(), "nothing is begun");
}
