use std::fs;

use crate::stochc::{path, stochc, stochc_with};

#[test]
fn show_repeats_the_output_of_simulate() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate =
        "simulate --quiet --model shuffle --runs 4 tests/fixtures/tower.sa tests/fixtures/late.sa";
    for form in [
        &[][..],
        &["--captures"],
        &["--json"],
        &["--json", "--captures"],
    ] {
        let printed = stochc_with(simulate, &[&["--out", &out], form].concat());
        let again = stochc_with("show", &[&[out.as_str()], form].concat());
        assert_eq!(
            (printed.status, again.status),
            (3, 3),
            "one program times out"
        );
        assert_eq!(again.err, "");
        assert_eq!(printed.out, again.out);
    }
}

/// Checks random impulses that break the physics. Without a results folder, only the terminal can
/// show the reason.
#[test]
fn the_first_reason_of_failed_runs_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let text = "scene wild from hemisphere { agitation kicks { speed 1e20 m/s } }\n\
                assembly tower in wild { seed plate 1 x 1 { M at (0, 0) } phase foot { M.up -> A } }\n";
    let (file, out) = (path(folder.path(), "wild.sa"), path(folder.path(), "out"));
    fs::write(&file, text).unwrap();
    let simulate = "simulate --quiet --runs 2";
    let outcome = stochc_with(simulate, &[&file]);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    assert!(
        outcome
            .err
            .contains("2 runs failed, first of all run 0 of tower, in phase foot, at tick "),
        "{}",
        outcome.err
    );
    assert!(outcome.err.contains("block "), "{}", outcome.err);
    assert!(
        outcome.err.contains("`stochc trace ... --run 0`"),
        "{}",
        outcome.err
    );
    let simulated = stochc_with(simulate, &[&file, "--out", &out]);
    let printed = stochc_with("show", &[&out]);
    for outcome in [simulated, printed] {
        assert!(outcome.err.contains("2 runs failed"), "{}", outcome.err);
        let (_, command) = outcome.err.rsplit_once("`stochc ").unwrap();
        let (command, _) = command.split_once('`').unwrap();
        let again = stochc_with(command, &["--quiet"]);
        assert!(
            again.out.contains("failed in phase foot"),
            "{command}: {}",
            again.err
        );
    }
}

/// Compares a program with and without a timeout of its first phase, for the same runs. Only slow
/// runs reach the timeout. They count as slower than all others, not as if they had continued like
/// fast runs.
#[test]
fn a_timeout_of_one_of_several_phases_makes_no_program_faster() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, timeout: &str| {
        let text = format!(
            "assembly {name} {{ seed plate 1 x 1 {{ M at (0, 0) }}\n\
             phase first {timeout} {{ M.up -> A }}\nphase second {{ A.up -> B }} }}\n"
        );
        let file = path(folder.path(), &format!("{name}.sa"));
        fs::write(&file, text).unwrap();
        file
    };
    let files = [file("limited", "timeout 900 ticks"), file("patient", "")];
    let command = "simulate --quiet --model rate --runs 200 --json";
    let outcome = stochc_with(command, &[&files[0], &files[1]]);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let found: serde_json::Value = serde_json::from_str(&outcome.out).unwrap();
    let time = |program: usize, figure: &str| found["programs"][program]["time"][figure].as_f64();
    let censored = time(0, "incomplete").unwrap();
    assert!((20.0..90.0).contains(&censored), "{}", outcome.out);
    assert!(time(0, "median") >= time(1, "median"), "{}", outcome.out);
    assert!(time(0, "mean") >= time(1, "mean"), "{}", outcome.out);
    assert_ne!(
        found["pairs"][0]["difference"]["longer"], "second",
        "{}",
        outcome.out
    );
    let outcome = stochc_with("simulate --quiet --model rate --runs 200", &[&files[0]]);
    let words = outcome.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains("These runs never complete."),
        "{}",
        outcome.out
    );
}

/// Compares a program that times out in most runs with a program that always completes later. The
/// first one takes longer.
#[test]
fn a_program_that_mostly_times_out_is_not_the_faster_one() {
    let folder = tempfile::tempdir().unwrap();
    let text = "assembly quick_or_never { seed plate 1 x 1 { M at (0, 0) }\n\
                phase a timeout 900 ticks { M.up -> A.up -> B } }\n\
                assembly always { seed plate 1 x 1 { M at (0, 0) } phase a { M.up -> A.up -> B.up -> C } }\n";
    let file = path(folder.path(), "both.sa");
    fs::write(&file, text).unwrap();
    let command = "simulate --quiet --model rate --runs 200 --json";
    let outcome = stochc_with(command, &[&file]);
    let found: serde_json::Value = serde_json::from_str(&outcome.out).unwrap();
    assert_eq!(
        found["pairs"][0]["difference"]["longer"], "first",
        "{}",
        outcome.out
    );
    let time = |program: usize, figure: &str| found["programs"][program]["time"][figure].as_f64();
    // Both means are restricted to the latest time that was observed in either program.
    assert_eq!(time(0, "horizon"), time(1, "max"));
    assert!(time(0, "mean") > time(1, "mean"), "{}", outcome.out);
    // A sweep gives the same result. Five ticks of 10 ms fit into the timeout, but only one of 40
    // ms.
    let limited = "assembly limited { seed plate 1 x 1 { M at (0, 0) } phase a timeout 50 ms { M.up ->> T[1..5] } }";
    let slow = path(folder.path(), "limited.sa");
    fs::write(&slow, limited).unwrap();
    let out = path(folder.path(), "out");
    let sweep = "sweep --quiet --model shuffle --runs 3 --vary";
    stochc_with(sweep, &["tick=10,40 ms", &slow, "--out", &out]);
    let json = fs::read_to_string(path(folder.path(), "out/sweep.json")).unwrap();
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    let time = |point: usize, figure: &str| found["points"][point]["time"][figure].as_f64();
    assert!(time(0, "max").is_some(), "{json}");
    assert_eq!(time(1, "horizon"), time(0, "max"), "{json}");
    assert_eq!(time(1, "mean"), time(0, "max"), "{json}");
}

#[test]
fn a_folder_is_shown_as_csv_latex_and_markdown_in_ticks_and_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate =
        "simulate --quiet --model rate --runs 6 examples/line.sa tests/fixtures/tower.sa --out";
    assert_eq!(stochc_with(simulate, &[&out]).status, 0);
    let found = stochc_with("show --json", &[&out]).json();
    let program = &found["programs"][0];
    let [mean, tick] = [&program["time"]["mean"], &program["tick"]].map(|it| it.as_f64().unwrap());
    let cell = |unit: &str, name: &str| {
        let outcome = stochc_with("show --format csv --unit", &[unit, &out]);
        assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
        let mut rows = csv::Reader::from_reader(outcome.out.as_bytes());
        let at = rows.headers().unwrap().iter().position(|it| it == name);
        let rows: Vec<_> = rows.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        rows[0][at.unwrap()].to_owned()
    };
    assert_eq!(cell("ticks", "program"), "line");
    assert_eq!(cell("ticks", "mean").parse(), Ok(mean));
    assert_eq!(cell("s", "mean").parse(), Ok(mean * tick));
    assert_eq!(cell("s", "completed"), "6");
    // Text has both units.
    let text = stochc_with("show --unit s", &[&out]);
    assert_eq!(text.out, stochc_with("show", &[&out]).out);
    let label = ["--unit", "s", "--label", "line=A line & more", &out];
    let markdown = stochc_with("show --format markdown", &label).out;
    assert!(
        markdown.starts_with("|  | A line & more | tower |\n|---|--:|--:|\n"),
        "{markdown}"
    );
    let seconds = stochc::text::number(mean * tick);
    assert!(
        markdown.contains(&format!("| mean \\[s\\] | {seconds} ± ")),
        "{markdown}"
    );
    assert!(markdown.contains("A line & more - tower: "), "{markdown}");
    let latex = stochc_with("show --format latex", &label).out;
    assert!(
        latex.contains("A line \\& more & tower \\\\\n\\midrule"),
        "{latex}"
    );
    assert!(
        latex.contains(&format!("mean [s] & {seconds} $\\pm$ ")),
        "{latex}"
    );
    for (more, reason) in [
        (
            &["--label", "lines=A"][..],
            "`lines` is not the name of a program",
        ),
        (&["--label", "line"], "NAME=TEXT"),
        (&["--json", "--unit", "s"], "`--unit s` is not for JSON"),
        (&["--format", "csv", "--captures"], "`--captures` is for"),
    ] {
        let outcome = stochc_with("show", &[&[out.as_str()], more].concat());
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
        assert!(outcome.err.contains(reason), "{}", outcome.err);
    }
}

#[test]
fn a_sweep_is_shown_point_by_point_with_the_label_of_its_program() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let sweep =
        "sweep --quiet --model shuffle --runs 3 tests/fixtures/tower.sa --vary free=200,400 --out";
    assert_eq!(stochc_with(sweep, &[&out]).status, 0);
    let csv = stochc_with("show --format csv --label tower=Tower", &[&out]).out;
    assert!(
        csv.starts_with("program,free,runs,completed,timed_out,censored,"),
        "{csv}"
    );
    assert!(csv.contains("\r\nTower,200,3,3,0,0,0,"), "{csv}");
    let printed = stochc_with(
        "show --format markdown --unit s --label tower=Tower",
        &[&out],
    )
    .out;
    assert!(printed.contains("| mean time \\[s\\] |"), "{printed}");
    assert!(
        printed.contains("| Tower \\[free=200\\] | 3 of 3 |"),
        "{printed}"
    );
}

/// Compares two runs of similar programs. The difference is not significant, and the sentence
/// states a sufficient number of runs.
#[test]
fn prints_the_runs_needed_for_a_difference() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "two.sa");
    let program = |name: &str, last: &str| {
        format!(
            "assembly {name} {{ seed plate 3 x 3 {{ M at (1, 1) }} \
             phase p {{ M.up -> A.up -> B.{last} -> C }} }}\n"
        )
    };
    fs::write(&file, program("tall", "up") + &program("bent", "east")).unwrap();
    let simulate = "simulate --quiet --model rate --runs 2";
    let outcome = stochc_with(simulate, &[&file]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let words = outcome.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains(": not significant. A difference of 5 % would need "),
        "{words}"
    );
    let found = stochc_with(simulate, &[&file, "--json"]).json();
    let difference = &found["pairs"][0]["difference"];
    assert_eq!(difference["longer"], "not_significant");
    let needed = difference["runs_for_5_percent"].as_u64().unwrap();
    assert!(
        words.contains(&format!(
            "{} runs of each",
            stochc::text::number(needed as f64)
        )),
        "{words}"
    );
    assert!(needed > 2);
}

#[test]
fn several_folders_are_for_report() {
    let outcome = stochc("show results/a results/b");
    assert_eq!(outcome.status, 2);
    let advice = "`stochc report results/a results/b` compares several";
    assert!(outcome.err.contains(advice), "{}", outcome.err);
}

#[test]
fn valid_runs_of_a_corrupted_folder_are_shown_with_status_2() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate = "simulate --quiet --model shuffle --runs 4 tests/fixtures/tower.sa --out";
    assert_eq!(stochc_with(simulate, &[&out]).status, 0);
    assert_eq!(stochc_with("show", &[&out]).status, 0);
    for name in ["journal.jsonl", "runs.parquet"] {
        let file = path(out.as_ref(), name);
        let whole = fs::read(&file).unwrap();
        let mut flipped = whole.clone();
        flipped[whole.len() / 2] ^= 1;
        fs::write(&file, flipped).unwrap();
        let outcome = stochc_with("show", &[&out]);
        assert_eq!(outcome.status, 2, "{name}: {}", outcome.err);
        assert!(outcome.out.contains("Mean time"), "{}", outcome.out);
        fs::write(&file, whole).unwrap();
    }
}

/// Checks that the median of five runs is the third in the order of times.
#[test]
fn a_replay_without_a_number_shows_the_median_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate = "simulate --quiet --substeps 1 --runs 5 tests/fixtures/dense.sa --out";
    assert_eq!(stochc_with(simulate, &[&out]).status, 0);
    let runs = stochc_with("show --json", &[&out]).json();
    let median = runs["programs"][0]["time"]["median"].as_f64().unwrap();
    let outcome = stochc_with("replay", &[&out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let (_, run) = outcome.err.split_once("note: run ").expect(&outcome.err);
    let (run, _) = run
        .split_once(" has the median completion time")
        .expect(&outcome.err);
    assert!(
        outcome.out.ends_with(&format!("replay-dense-{run}.html\n")),
        "{}",
        outcome.out
    );
    let single = "trace --substeps 1 --json tests/fixtures/dense.sa --run";
    let ticks = stochc_with(single, &[run]).json()["runs"][0]["ticks"]
        .as_f64()
        .unwrap();
    assert_eq!(ticks, median);
    // With several programs, the program must be named. It has its own median run.
    let failing = "simulate --quiet --model shuffle --runs 2 tests/fixtures/tower.sa tests/fixtures/late.sa --out";
    let two = path(folder.path(), "two");
    stochc_with(failing, &[&two]);
    let outcome = stochc_with("replay", &[&two]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("choose one with `--program`"),
        "{}",
        outcome.err
    );
}

#[test]
fn a_folder_without_results_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let missing = path(folder.path(), "missing");
    for place in [
        folder.path().to_str().unwrap(),
        &missing,
        "tests/fixtures",
        "Cargo.toml",
    ] {
        let outcome = stochc_with("show", &[place]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{place}");
        assert!(
            outcome
                .err
                .contains(&format!("`{place}` contains no results")),
            "{}",
            outcome.err
        );
    }
}

/// Checks that the terminal, `show` and the report print the same about a folder, with and without
/// censored runs.
#[test]
fn one_folder_has_one_test_and_one_wording() {
    let folder = tempfile::tempdir().unwrap();
    let taller = path(folder.path(), "taller.sa");
    let text = fs::read_to_string("tests/fixtures/dense.sa").unwrap();
    let text = text
        .replace("T[1..2]", "T[1..3]")
        .replace("assembly dense", "assembly taller");
    fs::write(&taller, text).unwrap();
    for (name, limit) in [("all", "1000000"), ("censored", "250")] {
        let out = path(folder.path(), name);
        let line = "simulate --quiet --runs 12 tests/fixtures/dense.sa --max-ticks";
        let printed = stochc_with(line, &[limit, &taller, "--out", &out]);
        assert_eq!(printed.status == 3, name == "censored", "{}", printed.err);
        let results = stochc_with("show", &[&out]);
        assert_eq!(results.out, printed.out);
        let json = stochc_with("show --json", &[&out]).json();
        let pair = &json["pairs"][0]["difference"];
        assert_eq!(pair["test"]["kind"], "paired");
        assert_eq!(pair["horizon"].is_null(), name == "all", "{pair}");
        assert_eq!(stochc_with("report --quiet", &[&out]).status, 0);
        let csv = fs::read_to_string(path(out.as_ref(), "report-figures/differences.csv")).unwrap();
        let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let (names, row) = (lines.next().unwrap(), lines.next().unwrap());
        for field in ["difference", "half_width", "p", "p_holm"] {
            let at = names.iter().position(|name| *name == field).unwrap();
            let in_report: f64 = row[at].parse().unwrap();
            assert_eq!(Some(in_report), pair[field].as_f64(), "{field}");
        }
        let at = names.iter().position(|name| *name == "horizon").unwrap();
        assert_eq!(row[at].parse().ok(), pair["horizon"].as_f64());
        // The page contains the same sentence, word for word.
        let (_, sentence) = printed.out.split_once("\ndense - taller: ").unwrap();
        let sentence = sentence.replace("\n  ", " ");
        let page = fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
        let page = page
            .replace('\u{a0}', " ")
            .replace("&lt;", "<")
            .replace("&#39;", "'");
        // On the page, names are in markup.
        let (figures, conclusion) = sentence.trim().rsplit_once(": ").unwrap();
        assert!(page.contains(figures), "{sentence}");
        let known = ["takes longer.", "not significant."];
        let known = known.into_iter().find(|it| conclusion.contains(it));
        assert!(page.contains(known.expect(conclusion)), "{sentence}");
        assert!(!page.contains("no difference") && !printed.out.contains("no difference"));
    }
}
