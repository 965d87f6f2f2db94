//! Tests figures for print.
use stochc::report::figures::Medium;

use crate::layout::check;
use crate::stochc::{path, stochc_with};

#[test]
fn the_command_writes_figures_for_print() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate = "simulate --quiet --model shuffle --runs 3 tests/fixtures/tower.sa";
    assert_eq!(stochc_with(simulate, &["--out", &out]).status, 0);
    let print = "report --figure-width 89mm --figure-format pdf,pdf";
    assert_eq!(stochc_with(print, &[&out]).status, 0);
    let figures = folder.path().join("out/report-figures");
    let is_there = |name: &str| figures.join(name).is_file();
    assert!(is_there("survival.pdf") && !is_there("survival.svg"));
    // The figures of the previous report are removed.
    assert_eq!(stochc_with("report", &[&out]).status, 0);
    assert!(!is_there("survival.pdf") && is_there("survival.svg"));
    for wrong in ["89", "20mm", "wide"] {
        let outcome = stochc_with("report --figure-width", &[wrong, &out]);
        assert_eq!(outcome.status, 2, "{wrong}");
        assert!(outcome.err.contains("give "), "{}", outcome.err);
    }
}

/// Checks that a folder contains a figure for print, 89 mm wide, in both formats.
fn is_printed(folder: &str, name: &str) {
    let read =
        |form: &str| std::fs::read(path(folder.as_ref(), &format!("{name}.{form}"))).unwrap();
    let svg = String::from_utf8(read("svg")).unwrap();
    check(name, &svg, Medium::Print(89.0));
    let pdf = read("pdf");
    assert!(
        pdf.starts_with(b"%PDF-") && pdf.ends_with(b"%%EOF"),
        "{name}"
    );
}

const PRINTED: [&str; 4] = ["--figure-width", "89mm", "--figure-format", "svg,pdf"];

#[test]
fn writes_printed_figures_of_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let sweep =
        "sweep --quiet --model shuffle --runs 3 --vary free=50,100,150 tests/fixtures/tower.sa";
    let outcome = stochc_with(sweep, &[&["--out", &out], &PRINTED[..]].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    is_printed(&out, "sweep");
    is_printed(&out, "sweep-completed");
    assert_eq!(stochc_with("fsck", &[&out]).status, 0);
    // A later command without these options writes figures for screens.
    assert_eq!(stochc_with("resume --quiet --runs 4", &[&out]).status, 0);
    let svg = std::fs::read_to_string(path(out.as_ref(), "sweep.svg")).unwrap();
    check("sweep", &svg, Medium::Screen);
    // The options are rejected without a sweep and without a folder.
    let alone = "simulate --quiet --model shuffle --runs 3 tests/fixtures/tower.sa";
    let none = path(folder.path(), "none");
    let outcome = stochc_with(alone, &[&["--out", &none], &PRINTED[..]].concat());
    assert_eq!(outcome.status, 2);
    assert!(!std::path::Path::new(&none).exists());
    assert_eq!(stochc_with(sweep, &PRINTED).status, 2);
}

#[test]
fn writes_printed_figures_of_a_trade() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let trade = "trade --quiet --runs 3 --finest 2 tests/fixtures/dense.sa";
    let outcome = stochc_with(trade, &[&["--out", &out], &PRINTED[..]].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    is_printed(&out, "trade");
    assert_eq!(stochc_with(trade, &PRINTED).status, 2);
}

#[test]
fn writes_printed_figures_of_a_fit() {
    let folder = tempfile::tempdir().unwrap();
    let [file, data, out] = ["small.sa", "times.csv", "out"].map(|name| path(folder.path(), name));
    let program = "scene small from hemisphere { free 20 uniform  enclosure hemisphere { radius 1m  wall 25 N/m } }
assembly one in small { seed plate 3 x 3 { M at (1, 1) }
phase grow { M.up -> A } }
";
    std::fs::write(&file, program).unwrap();
    std::fs::write(&data, "program,n,mean_ticks,sd_ticks\none,100,300,250\n").unwrap();
    let fit = "fit --quiet --vary free=8..60 --points 8 --rounds 1 --runs 4";
    let given = ["--data", &data, &file];
    let outcome = stochc_with(fit, &[&given[..], &["--out", &out], &PRINTED].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    is_printed(&out, "fit");
    assert_eq!(stochc_with(fit, &[&given[..], &PRINTED].concat()).status, 2);
}
