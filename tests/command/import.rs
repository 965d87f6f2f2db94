//! Tests the import of logs of experiments.
use std::fs;
use std::path::Path;

use stochc_ir::record::RunRecord;
use stochc_results::Folder;

use crate::logs::{Detail, csv, without_physics};
use crate::manifest::set_builds;
use crate::stochc::{path, stochc_with};

/// Returns the runs of a results folder of one program. All its tables are functions of these runs.
fn records(folder: &str) -> Vec<RunRecord> {
    let finished = Folder::read(Path::new(folder)).unwrap().finished;
    let finished = finished.to_vec().unwrap().into_iter();
    finished.map(|it| it.record).collect()
}

#[test]
fn imported_runs_have_the_tables_of_the_simulated_ones() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| path(folder.path(), name);
    let [simulated, measured, log] = ["simulated", "measured", "log.csv"].map(at);
    let program = "examples/five_tower_reconfigured.sa";
    let options = [program, "--out", &simulated];
    let outcome = stochc_with(
        "simulate --model rate --runs 12 --max-ticks 6000 --quiet",
        &options,
    );
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let manifest = Folder::read(Path::new(&simulated)).unwrap().manifest;
    let text = csv(&records(&simulated), &manifest.programs[0], Detail::Events);
    fs::write(&log, text).unwrap();
    let options = [&log, "--program", program, "--out", &measured];
    let outcome = stochc_with("import", &options);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    assert!(outcome.out.contains("12 measured runs"), "{}", outcome.out);
    let [there, here] = [&simulated, &measured].map(|it| records(it));
    let there: Vec<_> = there.iter().map(without_physics).collect();
    assert_eq!(there, here);
    for line in [
        "show --format csv",
        "show --captures --json",
        "show --run 3",
    ] {
        let [there, here] = [&simulated, &measured].map(|it| stochc_with(line, &[it]).out);
        let without_hops = |text: &str| {
            let lines = text.lines().filter(|line| !line.contains("hop"));
            lines.collect::<Vec<_>>().join("\n")
        };
        assert_eq!(without_hops(&there), without_hops(&here), "{line}");
    }
    for (line, status) in [
        ("fsck", 0),
        ("report --quiet", 0),
        ("resume", 2),
        ("replay", 2),
    ] {
        let outcome = stochc_with(line, &[&measured]);
        assert_eq!(outcome.status, status, "{line}: {}", outcome.err);
        if status == 2 {
            assert!(
                outcome.err.contains("measured in an experiment"),
                "{}",
                outcome.err
            );
        }
    }
    // The build that imported the runs does not matter.
    let manifest = path(measured.as_ref(), "manifest.json");
    set_builds(&manifest, &["0123456789abcdef"]);
    for (line, of) in [
        ("replay --run 3", &measured),
        ("export --run 3 --format parquet", &measured),
        ("repeat --quiet", &manifest),
    ] {
        let outcome = stochc_with(line, &[of]);
        assert_eq!(outcome.status, 2, "{line}: {}", outcome.err);
        let (reason, err) = ("measured in an experiment", &outcome.err);
        assert!(err.starts_with("error: ") && err.contains(reason), "{err}");
    }
    // Measured runs have no limit of ticks and no replay.
    let pages = [("a.html", &simulated), ("b.html", &measured)].map(|(name, folder)| {
        let page = at(name);
        let outcome = stochc_with("report --quiet --out", &[&page, folder]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        let page = fs::read_to_string(&page).unwrap();
        let texts = ["stochc replay", "stopped by <code>--max-ticks"];
        texts.map(|it| page.contains(it))
    });
    assert_eq!(pages, [[true, true], [false, false]]);
    let outcome = stochc_with(
        "report --quiet --out",
        &[&at("both.html"), &simulated, &measured],
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    // The same import again changes nothing, and another log is refused.
    let options = [&log, "--program", program, "--out", &measured];
    assert_eq!(stochc_with("import --quiet", &options).status, 0);
    fs::write(&log, fs::read_to_string(&log).unwrap() + "\n").unwrap();
    let outcome = stochc_with("import", &options);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("checksum of the log"),
        "{}",
        outcome.err
    );
}

#[test]
fn wrong_logs_name_their_line() {
    let folder = tempfile::tempdir().unwrap();
    let [log, out] = ["log.csv", "out"].map(|name| path(folder.path(), name));
    fs::write(&log, "run,seconds,event,block,by\n0,1,captured,B,A.down\n").unwrap();
    let options = [&log, "--program", "tests/fixtures/tower.sa", "--out", &out];
    let outcome = stochc_with("import", &options);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("log.csv`: line 2: "),
        "{}",
        outcome.err
    );
    assert!(!Path::new(&out).exists(), "nothing is written");
    let options = [
        &log,
        "--program",
        "examples/suction_growth.sa",
        "--out",
        &out,
    ];
    let outcome = stochc_with("import", &options);
    assert!(
        outcome.err.contains("choose one with `--assembly`"),
        "{}",
        outcome.err
    );
}
