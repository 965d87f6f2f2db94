//! Tests that reports on real ensembles equal sums over the Parquet tables.
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use stochc::experiments::Time;
use stochc::experiments::statistics::{Observation, Summary};

use crate::reading::fields;
use crate::stochc::{path, stochc_with};

/// Capture, from a row of `bonds.parquet`.
#[derive(Debug)]
struct Bond {
    run: u64,
    phase: String,
    capture: String,
    magnetized: u64,
    docked: u64,
    entries: u64,
    docking: u64,
    origin: String,
}

fn reader(folder: &str, table: &str) -> SerializedFileReader<File> {
    SerializedFileReader::new(File::open(path(folder.as_ref(), table)).unwrap()).unwrap()
}

/// Returns the rows of a table for one program, each by column name.
fn table(folder: &str, table: &str, program: &str) -> Vec<BTreeMap<String, Field>> {
    let reader = reader(folder, table);
    let rows = reader.get_row_iter(None).unwrap().map(Result::unwrap);
    let rows = rows.map(|row| {
        let columns = row.get_column_iter();
        let columns = columns.map(|(name, field)| (name.clone(), field.clone()));
        columns.collect::<BTreeMap<_, _>>()
    });
    rows.filter(|row| text(&row["program"]) == program)
        .collect()
}

fn text(field: &Field) -> String {
    match field {
        Field::Str(text) => text.clone(),
        other => panic!("{other:?} is no text"),
    }
}

fn whole(field: &Field) -> u64 {
    match field {
        Field::Long(number) => u64::try_from(*number).unwrap(),
        other => panic!("{other:?} is no integer"),
    }
}

/// Returns the ticks of every completed run of a program, by run number.
fn runs(folder: &str, program: &str) -> BTreeMap<u64, u64> {
    let rows = table(folder, "runs.parquet", program).into_iter();
    rows.map(|row| {
        assert_eq!(text(&row["outcome"]), "completed");
        (whole(&row["run"]), whole(&row["ticks"]))
    })
    .collect()
}

/// Returns the captures of a program. Panics if a wait is censored.
fn bonds(folder: &str, program: &str) -> Vec<Bond> {
    let rows = table(folder, "bonds.parquet", program).into_iter();
    rows.map(|row| Bond {
        run: whole(&row["run"]),
        phase: text(&row["phase"]),
        capture: capture(&row),
        magnetized: whole(&row["magnetized"]),
        docked: whole(&row["docked"]),
        entries: whole(&row["entries"]),
        docking: whole(&row["docking"]),
        origin: text(&row["origin"]),
    })
    .collect()
}

/// Returns a capture in the notation of the program.
fn capture(row: &BTreeMap<String, Field>) -> String {
    let [parent, face, child] = ["parent", "face", "child"].map(|name| text(&row[name]));
    format!("{parent}.{face} -> {child}")
}

/// Returns the rows of a table next to a report, each by column name.
fn csv(folder: &str, name: &str) -> Vec<BTreeMap<String, String>> {
    let file = Path::new(folder).join("report-figures").join(name);
    fields(&fs::read_to_string(file).unwrap())
}

fn close(found: &str, expected: f64) {
    let found: f64 = found.parse().unwrap();
    let error = (found - expected).abs();
    assert!(
        error <= 1e-9 * expected.abs().max(1.0),
        "{found} {expected}"
    );
}

#[test]
fn a_report_agrees_with_the_tables() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let name = "five_tower_reconfigured";
    let file = format!("examples/{name}.sa");
    let simulate = "simulate --quiet --model rigid --runs 6";
    assert_eq!(stochc_with(simulate, &[&file, "--out", &out]).status, 0);
    assert_eq!(stochc_with("report --quiet", &[&out]).status, 0);
    let (runs, bonds) = (runs(&out, name), bonds(&out, name));
    assert_eq!((runs.len(), bonds.len()), (6, 90));

    let ticks: Vec<f64> = runs.values().map(|&ticks| ticks as f64).collect();
    let expected = Summary::from_values(&ticks).unwrap();
    let whole = &csv(&out, "means.csv")[0];
    close(&whole["mean"], expected.mean);
    close(&whole["half_width"], expected.half_width.unwrap());
    close(&whole["median"], expected.median);

    let waits = csv(&out, "waits.csv");
    assert_eq!(waits.len(), 15);
    for row in &waits {
        let same = |bond: &&Bond| bond.capture == row["capture"] && bond.phase == row["phase"];
        let of = |value: fn(&Bond) -> u64| {
            let values: Vec<f64> = bonds.iter().filter(same).map(|b| value(b) as f64).collect();
            Summary::from_values(&values).unwrap()
        };
        let wait = of(|bond| bond.docked - bond.magnetized);
        close(&row["wait"], wait.mean);
        close(&row["half_width"], wait.half_width.unwrap());
        close(&row["entries"], of(|bond| bond.entries).mean);
        close(&row["docking"], of(|bond| bond.docking).mean);
    }
    let released = bonds
        .iter()
        .filter(|bond| bond.origin == "released")
        .count();
    let reported = csv(&out, "origins.csv").into_iter();
    let reported = reported.filter(|row| row["origin"] == "released");
    let reported: usize = reported
        .map(|row| row["captured"].parse::<usize>().unwrap())
        .sum();
    assert!(released > 0);
    assert_eq!(reported, released);

    // The share of a capture is the sum of its segments divided by the total time.
    let chains = csv(&out, "critical-paths.csv");
    let total: u64 = runs.values().sum();
    for row in &waits {
        let links = chains.iter();
        let links =
            links.filter(|link| link["event"] == row["capture"] && link["phase"] == row["phase"]);
        let spent: u64 = links
            .map(|link| number(link, "to") - number(link, "from"))
            .sum();
        close(&row["share"], spent as f64 / total as f64);
    }
    chains_fill(&chains, &runs, &bonds);
}

/// Checks the shares of a `wait`, and the differences between slow and fast runs.
#[test]
fn waits_have_rows_for_phases_and_slow_runs() {
    let folder = tempfile::tempdir().unwrap();
    let [file, out] = ["rest.sa", "out"].map(|name| path(folder.path(), name));
    let text = "assembly rest {
        seed plate 1 x 1 { M at (0, 0) }
        phase grow { M.up -> A }
        phase settle { wait 4000 ticks }
    }";
    std::fs::write(&file, text).unwrap();
    let simulate = "simulate --quiet --model rate --runs 40";
    assert_eq!(stochc_with(simulate, &[&file, "--out", &out]).status, 0);
    assert_eq!(stochc_with("report --quiet", &[&out]).status, 0);
    let waits = csv(&out, "waits.csv");
    let [capture, wait] = &waits[..] else {
        panic!("{waits:?}");
    };
    assert_eq!((&*wait["capture"], &*wait["phase"]), ("wait", "settle"));
    assert_eq!((&*wait["decided"], &*wait["slower"]), ("40", "0"));
    let share = |row: &BTreeMap<String, String>| row["share"].parse::<f64>().unwrap();
    let total: f64 = runs(&out, "rest").values().map(|&it| it as f64).sum();
    close(&wait["share"], 40.0 * 4000.0 / total);
    assert!((share(capture) + share(wait) - 1.0).abs() < 1e-9);
    let slower: f64 = capture["slower"].parse().unwrap();
    let docking: f64 = capture["slower_docking"].parse().unwrap();
    assert!(
        slower > 500.0 && docking.abs() < slower,
        "{slower} {docking}"
    );
    let slowest = runs(&out, "rest")
        .into_iter()
        .max_by_key(|(_, ticks)| *ticks);
    assert_eq!(capture["run_to_watch"], slowest.unwrap().0.to_string());
    // Both kinds of estimates have the same rows.
    for how in ["", "--runs 200"] {
        let estimate = stochc_with(&format!("estimate --json {how}"), &[&file]).json();
        let shares = estimate["estimates"][0]["shares"].as_array().unwrap();
        assert_eq!((shares.len(), &shares[0]["event"]), (2, &"wait".into()));
        let sum: f64 = shares.iter().map(|it| it["share"].as_f64().unwrap()).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{shares:?}");
    }
}

/// Checks that `show --captures`, the report and the table of captures have the same waiting times
/// if runs are stopped.
#[test]
fn censored_runs_have_equal_waits_in_every_table() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let name = "five_tower_reconfigured";
    let file = format!("examples/{name}.sa");
    let simulate = "simulate --quiet --model shuffle --runs 12 --max-ticks 12";
    assert_eq!(stochc_with(simulate, &[&file, "--out", &out]).status, 3);
    assert_eq!(stochc_with("report --quiet", &[&out]).status, 0);
    let outcome = stochc_with("show --captures --json", &[&out]);
    let outcome = outcome.json();
    assert_eq!(outcome["captures"][0]["program"], name);
    let captures = outcome["captures"][0]["captures"].as_array().unwrap();
    let bonds = table(&out, "bonds.parquet", name);
    let waits = csv(&out, "waits.csv");
    let waited = |row: &&BTreeMap<String, String>| !row["wait"].is_empty();
    assert_eq!(waits.iter().filter(waited).count(), captures.len());
    let mut stopped = 0;
    for reported in captures {
        let field = |name: &str| reported[name].as_str().unwrap();
        let what = format!(
            "{}.{} -> {}",
            field("parent"),
            field("face"),
            field("child")
        );
        let phase = field("phase");
        let same =
            |row: &&BTreeMap<String, Field>| capture(row) == what && text(&row["phase"]) == phase;
        let times = bonds.iter().filter(same).map(|row| {
            let time = whole(&row["wait"]) as f64;
            match row["censored"] {
                Field::Bool(false) => Observation::completed(time),
                _ => Observation::censored(time),
            }
        });
        let times: Vec<Observation> = times.collect();
        let expected = Time::new(&times).unwrap();
        assert_eq!(reported["wait"], serde_json::json!(expected), "{what}");
        let row = waits
            .iter()
            .find(|row| row["capture"] == what && row["phase"] == phase);
        let row = row.unwrap();
        let maybe = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        assert_eq!(row["captured"], expected.completed.to_string());
        assert_eq!(row["censored"], expected.incomplete.to_string());
        assert_eq!(row["wait"], expected.mean.to_string());
        assert_eq!(row["half_width"], maybe(expected.half_width));
        stopped += expected.incomplete;
    }
    // The number of unfinished waits equals the number of faces that were on when runs were
    // stopped.
    let rows = table(&out, "runs.parquet", name);
    let running: u64 = rows
        .iter()
        .map(|row| whole(&row["censored_captures"]))
        .sum();
    assert!(running >= 6, "{running}");
    assert_eq!(stopped as u64, running);
}

/// Checks critical paths of runs without physics, which have every order of events and all kinds of
/// releases. The segments of a run have no gaps, from its first tick to its last. Each segment is a
/// waiting time in the tables.
#[test]
fn critical_paths_cover_whole_runs() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let files = fs::read_dir("tests/verification").unwrap();
    let files = files.map(|file| file.unwrap().path());
    let files = files.filter(|file| file.extension().is_some_and(|it| it == "sa"));
    let mut files: Vec<String> = files
        .map(|file| file.to_str().unwrap().to_owned())
        .filter(|file| !stochc::check(file).has_errors())
        .collect();
    files.sort();
    assert!(files.len() > 25, "{}", files.len());
    let mut arguments: Vec<&str> = files.iter().map(String::as_str).collect();
    arguments.extend(["--out", &out]);
    let outcome = stochc_with("simulate --quiet --model shuffle --runs 5", &arguments);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(stochc_with("report --quiet", &[&out]).status, 0);
    let chains = csv(&out, "critical-paths.csv");
    let mut programs: Vec<&String> = chains.iter().map(|link| &link["program"]).collect();
    programs.dedup();
    assert_eq!(programs.len(), files.len());
    for program in programs {
        let of = chains.iter().filter(|link| link["program"] == *program);
        let of: Vec<_> = of.cloned().collect();
        chains_fill(&of, &runs(&out, program), &bonds(&out, program));
    }
}

fn number(row: &BTreeMap<String, String>, column: &str) -> u64 {
    row[column].parse().unwrap()
}

fn chains_fill(chains: &[BTreeMap<String, String>], runs: &BTreeMap<u64, u64>, bonds: &[Bond]) {
    for (&run, &ticks) in runs {
        let links: Vec<_> = chains
            .iter()
            .filter(|link| number(link, "run") == run)
            .collect();
        let mut tick = 0;
        for link in links {
            assert_eq!(number(link, "from"), tick, "run {run}: {link:?}");
            tick = number(link, "to");
            if !link["event"].starts_with("release ") {
                let found = bonds.iter().any(|bond| {
                    let same = (bond.run, &bond.capture, &bond.phase, bond.docked);
                    // A cell may become empty only after the face was switched on.
                    same == (run, &link["event"], &link["phase"], tick)
                        && bond.magnetized <= number(link, "from")
                });
                assert!(found, "run {run}: {link:?}");
            }
        }
        assert_eq!(tick, ticks, "run {run}");
    }
}
