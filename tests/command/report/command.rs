//! Tests the command `report`: output path, rejected input, and exit status.
use std::fs;
use std::path::Path;

use stochc::files::checksum::sealed;
use stochc::results::Manifest;

use crate::stochc::{command, path, run_command, stochc_with};

/// Removes the checksums of a folder, as if its files had been changed on purpose.
fn unseal(out: &str) {
    fs::remove_file(path(out.as_ref(), "checksums.json")).unwrap();
}

/// Returns the journal with one text replaced by another. The checksums stay valid.
fn renamed(journal: &str, before: &str, after: &str) -> String {
    let lines = journal.lines().map(|line| {
        let (object, _) = line.rsplit_once(",\"crc\"").unwrap();
        sealed(object.replace(before, after) + "}") + "\n"
    });
    lines.collect()
}

/// Simulates an ensemble into a folder. Returns its path.
fn simulated(folder: &Path, name: &str, more: &[&str]) -> String {
    let out = path(folder, name);
    let simulate = "simulate --quiet --model shuffle --runs 4 tests/fixtures/tower.sa";
    let outcome = stochc_with(simulate, &[&["--out", &out], more].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    out
}

#[test]
fn a_report_is_written_into_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), "out", &[]);
    let before = stochc_with("show", &[&out]).out;
    for _ in 0..2 {
        let outcome = stochc_with("report", &[&out]);
        let page = path(out.as_ref(), "report.html");
        assert_eq!((outcome.status, outcome.out), (0, format!("{page}\n")));
        assert!(
            Path::new(&out)
                .join("report-figures/survival.svg")
                .is_file()
        );
    }
    assert_eq!(stochc_with("show", &[&out]).out, before);
    assert_eq!(simulated(folder.path(), "out", &[]), out, "still finished");
    let quiet = stochc_with("report --quiet", &[&out]);
    assert_eq!((quiet.status, quiet.out.as_str()), (0, ""));
}

/// Checks that the segments of a critical path have no gaps and cover the run.
#[test]
fn the_critical_path_includes_messages() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "notifications.sa");
    let text = "scene slow from hemisphere { messages { hop 50 ticks } }\n\
                assembly notifications in slow { seed plate 3 x 1 { A at (0, 0) B at (2, 0) }\n\
                phase g { A.up ->> T[1..2] B.up -> X after T[2] } }\n";
    fs::write(&file, text).unwrap();
    let out = path(folder.path(), "out");
    let simulate = "simulate --quiet --model rate --runs 3";
    assert_eq!(stochc_with(simulate, &[&file, "--out", &out]).status, 0);
    assert_eq!(stochc_with("report --quiet", &[&out]).status, 0);
    let chains =
        fs::read_to_string(path(out.as_ref(), "report-figures/critical-paths.csv")).unwrap();
    let mut ends = [0; 3];
    let mut notifications = 0;
    for line in chains.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [_, run, _, event, from, to] = cells[..] else {
            panic!("{line}")
        };
        let [run, from, to] = [run, from, to].map(|it| it.parse::<usize>().unwrap());
        assert_eq!(from, ends[run], "{chains}");
        ends[run] = to;
        notifications += if event == "notification" {
            to - from
        } else {
            0
        };
    }
    // The message travels down to the plate and up the other tower.
    assert_eq!(notifications, 3 * 2 * 50, "{chains}");
    let page = fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
    assert!(
        page.contains("Then the message about it took 100 ticks"),
        "{page}"
    );
}

#[test]
fn several_folders_make_one_page_here() {
    let folder = tempfile::tempdir().unwrap();
    for (name, seed) in [("one", "1"), ("two", "2")] {
        simulated(folder.path(), name, &["--seed", seed]);
    }
    let mut report = command(["report", "one", "two", "one/"]);
    let outcome = run_command(report.current_dir(folder.path()));
    assert_eq!((outcome.status, outcome.out.as_str()), (0, "report.html\n"));
    assert_eq!(outcome.err, "note: `one/` is given twice\n");
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    for label in ["tower (one)", "tower (two)"] {
        assert!(page.contains(label), "{label}");
    }
}

#[test]
fn an_existing_replay_is_linked() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), "out 1", &[]);
    fs::write(path(out.as_ref(), "replay-0.html"), "").unwrap();
    stochc_with("report", &[&out]);
    let page = fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
    assert!(page.contains("<a href=\"replay-0.html\">Watch run 0</a>"));
    assert!(
        page.contains("stochc replay &#39;"),
        "the others are not there"
    );
    // Names of replays may contain the assembly. If there are several programs, they must.
    let both = simulated(folder.path(), "both", &["tests/fixtures/importing.sa"]);
    for name in ["replay-tower-0.html", "replay-1.html"] {
        fs::write(path(both.as_ref(), name), "").unwrap();
    }
    stochc_with("report", &[&both]);
    let page = fs::read_to_string(path(both.as_ref(), "report.html")).unwrap();
    assert!(page.contains("<a href=\"replay-tower-0.html\">Watch run 0</a>"));
    assert!(
        !page.contains("\"replay-1.html"),
        "the program is ambiguous"
    );
    let line = format!("stochc replay {both} --run 1 --program tower</code>");
    assert!(page.contains(&line), "{page}");
    // Pages in other folders use relative addresses for their links.
    let elsewhere = path(folder.path(), "page.html");
    stochc_with("report", &[&out, "--out", &elsewhere]);
    let page = fs::read_to_string(&elsewhere).unwrap();
    assert!(
        page.contains("<a href=\"out%201/replay-0.html\">"),
        "{page}"
    );
}

#[test]
fn a_folder_without_results_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), "out", &[]);
    for wrong in ["tests/fixtures", "Cargo.toml", "no/such/folder"] {
        let outcome = stochc_with("report", &[&out, wrong]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{wrong}");
        let expected = format!("`{wrong}` contains no results; give a folder");
        assert!(outcome.err.contains(&expected), "{}", outcome.err);
    }
    assert_eq!(stochc_with("report", &[]).status, 2, "no folder at all");
    // The manifest differs only in whitespace.
    let manifest = path(out.as_ref(), "manifest.json");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replace("\"format\": 1", "\"format\": 99")).unwrap();
    let outcome = stochc_with("report", &[&out]);
    assert!(outcome.err.contains("changed by hand"), "{}", outcome.err);
    unseal(&out);
    let outcome = stochc_with("report", &[&out]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("its format is 99, and this is 1"),
        "{}",
        outcome.err
    );
}

/// Checks a report on a truncated journal, which contains fewer runs.
#[test]
fn an_unfinished_ensemble_is_marked() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), "out", &[]);
    let journal = path(out.as_ref(), "journal.jsonl");
    let text = fs::read_to_string(&journal).unwrap();
    unseal(&out);
    let lines: Vec<&str> = text.lines().collect();
    // The journal has two runs and half of the third.
    let half = &lines[3][..lines[3].len() / 2];
    fs::write(&journal, format!("{}\n{half}", lines[..3].join("\n"))).unwrap();
    let outcome = stochc_with("report", &[&out]);
    assert_eq!(outcome.status, 0);
    assert_eq!(
        outcome.err,
        format!("warning: `{out}` is not finished: 2 of 4 runs\n")
    );
    let page = fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
    assert!(page.contains("<strong>not finished</strong>: 2 of 4 runs are finished"));
    // If only the first line remains, the report is still written.
    fs::write(&journal, format!("{}\n", lines[0])).unwrap();
    assert_eq!(stochc_with("report", &[&out]).status, 0);
    let page = fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
    assert!(page.contains("No run of this program is finished."));
    // The journal belongs to another ensemble.
    fs::write(&journal, "{\"ensemble\":\"0\"}\n").unwrap();
    let outcome = stochc_with("report", &[&out]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome
            .err
            .contains("does not belong to the `manifest.json`"),
        "{}",
        outcome.err
    );
}

#[test]
fn another_version_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let [old, new] = ["old", "new"].map(|name| simulated(folder.path(), name, &[]));
    let file = |name: &str| path(old.as_ref(), name);
    let text = fs::read_to_string(file("manifest.json")).unwrap();
    let mut manifest = Manifest::from_json(&text).unwrap();
    let before = manifest.identity();
    manifest.stochc = "0.0.1".into();
    fs::write(file("manifest.json"), manifest.to_json()).unwrap();
    fs::remove_file(file("checksums.json")).unwrap();
    let journal = fs::read_to_string(file("journal.jsonl")).unwrap();
    fs::write(
        file("journal.jsonl"),
        renamed(&journal, &before, &manifest.identity()),
    )
    .unwrap();
    let page = path(folder.path(), "both.html");
    let outcome = stochc_with("report --quiet", &[&old, &new, "--out", &page]);
    assert_eq!(outcome.status, 0);
    let versions = format!("0.0.1, {}", env!("CARGO_PKG_VERSION"));
    assert!(outcome.err.contains(&versions), "{}", outcome.err);
    let page = fs::read_to_string(&page).unwrap();
    assert!(
        page.contains("were made by stochc <bdi>0.0.1</bdi>"),
        "{page}"
    );
}

/// Checks that a report works without sources, because a folder contains compiled programs.
#[test]
fn a_report_needs_no_source() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), "out", &[]);
    let file = |name: &str| path(out.as_ref(), name);
    let text = fs::read_to_string(file("manifest.json")).unwrap();
    let mut manifest = Manifest::from_json(&text).unwrap();
    let before = manifest.identity();
    manifest.programs[0].sources[0].text = "assembly tower {".into();
    fs::write(file("manifest.json"), manifest.to_json()).unwrap();
    fs::remove_file(file("checksums.json")).unwrap();
    let journal = fs::read_to_string(file("journal.jsonl")).unwrap();
    fs::write(
        file("journal.jsonl"),
        renamed(&journal, &before, &manifest.identity()),
    )
    .unwrap();
    assert_eq!(stochc_with("report", &[&out]).status, 0);
    let page = fs::read_to_string(file("report.html")).unwrap();
    assert!(page.contains("M.up -&gt; A"), "{page}");
    assert!(page.contains("assembly tower {"), "{page}");
}

#[test]
fn an_interrupted_report_is_rewritten() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), "out", &[]);
    // A killed command leaves some figures and a draft, but no page.
    let figures = Path::new(&out).join("report-figures");
    fs::create_dir(&figures).unwrap();
    fs::write(figures.join("survival.svg"), "<svg").unwrap();
    let draft = figures.join(".stochc-partial-9f3a");
    fs::write(&draft, "program,").unwrap();
    let outcome = stochc_with("report", &[&out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(!draft.exists() && Path::new(&out).join("report.html").exists());
    let figure = fs::read_to_string(figures.join("survival.svg")).unwrap();
    assert!(figure.ends_with("</svg>\n"), "{figure}");
    assert!(figures.join("critical-paths.csv").exists());
}

#[test]
fn foreign_files_are_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), "out", &[]);
    let page = path(folder.path(), "thesis.html");
    fs::write(&page, "<!DOCTYPE html><!-- mine -->").unwrap();
    let outcome = stochc_with("report", &[&out, "--out", &page]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome
            .err
            .contains("is not a report of stochc; choose another name"),
        "{}",
        outcome.err
    );
    assert_eq!(
        fs::read_to_string(&page).unwrap(),
        "<!DOCTYPE html><!-- mine -->"
    );
    let figures = folder.path().join("page-figures");
    fs::create_dir(&figures).unwrap();
    fs::write(figures.join("survival.svg"), "mine").unwrap();
    let page = path(folder.path(), "page.html");
    let outcome = stochc_with("report", &[&out, "--out", &page]);
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("holds other files"), "{}", outcome.err);
    assert_eq!(
        fs::read_to_string(figures.join("survival.svg")).unwrap(),
        "mine"
    );
    for wrong in [folder.path().to_str().unwrap(), "no/such/folder/page.html"] {
        assert_eq!(
            stochc_with("report", &[&out, "--out", wrong]).status,
            2,
            "{wrong}"
        );
    }
}

/// Checks that figures of an earlier report are removed if the new report does not have them.
#[test]
fn figures_of_an_earlier_report_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), "out", &["tests/fixtures/importing.sa"]);
    let page = path(folder.path(), "page.html");
    let figures = folder.path().join("page-figures");
    assert_eq!(stochc_with("report", &[&out, "--out", &page]).status, 0);
    assert!(figures.join("waits-2.svg").is_file());
    fs::write(figures.join("notes.txt"), "mine").unwrap();
    let single = simulated(folder.path(), "single", &[]);
    assert_eq!(stochc_with("report", &[&single, "--out", &page]).status, 0);
    assert!(!figures.join("waits-2.svg").exists());
    assert!(figures.join("waits-1.svg").is_file() && figures.join("notes.txt").is_file());
}

/// Checks a program that never completes. Its mean would only be the timeout.
#[test]
fn a_program_that_no_run_completes_has_no_mean_in_short() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "hasty.sa");
    let text = "assembly hasty { seed plate 1 x 1 { M at (0, 0) }\n\
                phase grow timeout 1 ticks { M.up ->> T[1..3] } }\n";
    fs::write(&file, text).unwrap();
    let out = path(folder.path(), "out");
    let simulate = "simulate --quiet --model shuffle --runs 5 --out";
    assert_eq!(stochc_with(simulate, &[&out, &file]).status, 3);
    assert_eq!(stochc_with("report --quiet", &[&out]).status, 0);
    let page = fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
    let begin = "</strong>: 0 of 5 runs completed, 5 timed out. ";
    let (_, rest) = page.split_once(begin).unwrap();
    let item = rest.split_once("</li>").unwrap().0;
    assert!(!item.contains("most of that"), "{item}");
}

#[test]
fn figures_are_in_seconds_with_labels_of_programs() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate = "simulate --quiet --substeps 1 --runs 3 --record all examples/five_tower_reconfigured.sa --out";
    assert_eq!(stochc_with(simulate, &[&out]).status, 0);
    let label = "five_tower_reconfigured=Five towers";
    let outcome = stochc_with("report --quiet --unit s", &["--label", label, &out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let figures = path(out.as_ref(), "report-figures");
    let mut shown = 0;
    let names = ["survival", "phases-1", "waits-1", "before-1", "near-1"];
    for name in names {
        let text = fs::read_to_string(path(figures.as_ref(), &format!("{name}.svg"))).unwrap();
        assert!(!text.contains("ticks"), "{name}");
        // The titles of maps contain times.
        let is_on_axis = ["survival", "phases-1", "waits-1"].contains(&name);
        assert!(!is_on_axis || text.contains("[s]"), "{name}");
        shown += usize::from(text.contains("Five towers"));
    }
    assert!(shown >= 3, "{shown}");
    let outcome = stochc_with("report --label other=One", &[&out]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("`other` is not the name of a program"),
        "{}",
        outcome.err
    );
}

#[test]
fn a_sweep_lists_its_programs() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let sweep = "sweep --quiet --model shuffle --runs 2 --vary free=20,30 --vary drag=1,2Hz \
                    tests/fixtures/tower.sa tests/fixtures/importing.sa --out";
    let outcome = stochc_with(sweep, &[&out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(stochc_with("report --quiet", &[&out]).status, 0);
    let page = fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
    let (_, rest) = page.split_once("These are runs of ").unwrap();
    let sentence = rest.split_once("</p>").unwrap().0;
    assert!(
        sentence.contains("Runs of one program differ only in ")
            && sentence.contains("free</bdi></code> and <code"),
        "{sentence}"
    );
}
