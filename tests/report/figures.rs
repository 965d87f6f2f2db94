//! Figures on screens and in print: nothing is cut or hidden, and every axis says what it shows.
use std::sync::Arc;

use stochc::experiments::Time;
use stochc::experiments::statistics::Observation;
use stochc::experiments::sweep::{Sweep, SweepPoint, SweptNumber, SweptValue};
use stochc::report::ensemble_report::{FigureFormat, Figures, Input, Medium, Report};
use stochc::report::figures;

use crate::layout::{MEDIA, check, classes};
use crate::sample::{drawn, five, parsed};
use crate::stochc::{path, stochc_with};

fn check_all(report: &Report, medium: Medium) -> usize {
    let figures = report
        .files
        .iter()
        .filter(|(name, _)| name.ends_with(".svg"));
    figures
        .map(|(name, content)| check(name, std::str::from_utf8(content).unwrap(), medium))
        .count()
}

fn figures_for(medium: Medium, formats: &[FigureFormat]) -> Figures {
    Figures {
        medium,
        formats: formats.to_vec(),
        ..Figures::default()
    }
}

/// Names that are longer than there is room for.
fn long_names(mut input: Input) -> Input {
    let program = &mut input.manifest.programs[0];
    program.name = format!("{} and more", "a rather long name of a program ".repeat(3));
    let tables = &mut Arc::make_mut(&mut program.compiled).tables;
    for phase in &mut tables.phases {
        phase.name += &"_in_many_words".repeat(4);
    }
    for role in &mut tables.roles {
        role.name += &"WIDE".repeat(6);
    }
    input
}

#[test]
fn nothing_is_cut_or_hidden_at_any_width() {
    for medium in MEDIA {
        let figures = figures_for(medium, &[FigureFormat::Svg]);
        let both = [0.1, 0.2].map(five);
        assert_eq!(check_all(&drawn(&both, &figures), medium), 12);
        let long = both.map(long_names);
        assert_eq!(check_all(&drawn(&long, &figures), medium), 12);
    }
}

/// The page is the same, whatever the files beside it are like, but for their names.
#[test]
fn a_page_is_for_a_screen_whatever_is_printed() {
    let on_screen = drawn(&[five(0.2)], &Figures::default());
    let printed = figures_for(Medium::Print(89.0), &[FigureFormat::Svg]);
    let printed = drawn(&[five(0.2)], &printed);
    assert_eq!(on_screen.page, printed.page);
    assert_ne!(on_screen.files, printed.files);
    let names = |report: &Report| -> Vec<String> {
        report.files.iter().map(|(name, _)| name.clone()).collect()
    };
    assert_eq!(names(&on_screen), names(&printed));
}

#[test]
fn every_figure_can_be_pdf() {
    let formats = [FigureFormat::Svg, FigureFormat::Pdf];
    let report = drawn(&[five(0.2)], &figures_for(Medium::Print(183.0), &formats));
    let mut pages = 0;
    for (name, content) in &report.files {
        if let Some(name) = name.strip_suffix(".pdf") {
            pages += 1;
            assert!(
                content.starts_with(b"%PDF-") && content.ends_with(b"%%EOF"),
                "{name}"
            );
            let svg = format!("{name}.svg");
            assert!(report.files.iter().any(|(other, _)| *other == svg), "{svg}");
            assert!(report.page.contains(&format!("/{name}.pdf\"")), "{name}");
        }
    }
    assert_eq!(pages, 5);
}

/// A sweep over a number and others, whose times follow a power of the first.
fn swept_over(numbers: &[(&str, &[f64])], power: f64) -> Sweep {
    let mut all: Vec<Vec<f64>> = vec![Vec::new()];
    for (_, values) in numbers {
        let before = std::mem::take(&mut all);
        for point in before {
            all.extend(values.iter().map(|&value| [&point[..], &[value]].concat()));
        }
    }
    let points = all.into_iter().map(|point| {
        let mean = 1000.0 * point[0].powf(power);
        let times = [0.9, 1.0, 1.1].map(|share| Observation::completed(share * mean));
        SweepPoint {
            name: format!("line {point:?}"),
            program: "line".into(),
            values: point
                .iter()
                .map(|&value| SweptValue { value, si: value })
                .collect(),
            chosen: Vec::new(),
            tick: 0.02,
            runs: 3,
            completed: 3,
            timed_out: 0,
            censored: 0,
            failed: 0,
            share: Some(1.0),
            share_interval: Some((0.44, 1.0)),
            time: Time::new(&times),
            captures: 3,
            released: None,
            time_per_capture: Some(mean),
        }
    });
    let axis = |name: &str| SweptNumber {
        of: name.into(),
        unit: "N".into(),
    };
    Sweep {
        axes: numbers.iter().map(|(name, _)| axis(name)).collect(),
        settings: Vec::new(),
        unit: "ticks",
        points: points.collect(),
    }
}

fn swept(values: &[f64], power: f64) -> Sweep {
    swept_over(&[("bond.pull", values)], power)
}

#[test]
fn maps_of_two_numbers_find_room() {
    let values: Vec<f64> = (0..12).map(|i| 1.5 + 1000.0 * f64::from(i)).collect();
    let sweep = swept_over(&[("bond.pull", &values), ("bond.reach", &values)], 1.0);
    for medium in MEDIA {
        let drawings = figures::sweep(medium, &sweep, "sweep");
        assert_eq!(drawings.len(), 1);
        check("sweep", &drawings[0].file(), medium);
    }
}

/// What follows a power of a number is a line: both axes are logarithmic where both span more than a factor of ten.
#[test]
fn powers_are_drawn_as_lines() {
    let axes = |sweep: &Sweep, medium| -> Vec<bool> {
        let drawings = figures::sweep(medium, sweep, "sweep");
        let svg = drawings[0].file();
        check("sweep", &svg, medium);
        let document = parsed(&svg);
        let axes = document.descendants().filter(|node| classes(node) == "of");
        axes.map(|axis| {
            let mut words = axis.descendants().filter_map(|node| node.text());
            words.any(|text| text.contains("logarithmic"))
        })
        .collect()
    };
    for medium in MEDIA {
        assert_eq!(axes(&swept(&[1.0, 5.0, 30.0], -2.0), medium), [true, true]);
        assert_eq!(axes(&swept(&[1.0, 5.0, 30.0], 0.1), medium), [true, false]);
        assert_eq!(axes(&swept(&[1.0, 2.0, 8.0], -2.0), medium), [false, false]);
    }
}

#[test]
fn the_command_writes_figures_for_print() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate = "simulate --quiet --model shuffle --runs 3 tests/fixtures/tower.sa";
    assert_eq!(stochc_with(simulate, &["--out", &out]).status, 0);
    let print = "report --figure-width 89mm --format pdf,pdf";
    assert_eq!(stochc_with(print, &[&out]).status, 0);
    let figures = folder.path().join("out/report-figures");
    let is_there = |name: &str| figures.join(name).is_file();
    assert!(is_there("survival.pdf") && !is_there("survival.svg"));
    // Those of the report before go.
    assert_eq!(stochc_with("report", &[&out]).status, 0);
    assert!(!is_there("survival.pdf") && is_there("survival.svg"));
    for wrong in ["89", "20mm", "wide"] {
        let said = stochc_with("report --figure-width", &[wrong, &out]);
        assert_eq!(said.status, 2, "{wrong}");
        assert!(said.err.contains("give "), "{}", said.err);
    }
}

/// That there is a figure in a folder for print, 89 mm wide, in both forms.
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
fn figures_of_a_sweep_are_for_print_as_well() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let sweep =
        "sweep --quiet --model shuffle --runs 3 --vary free=50,100,150 tests/fixtures/tower.sa";
    let said = stochc_with(sweep, &[&["--out", &out], &PRINTED[..]].concat());
    assert_eq!(said.status, 0, "{}", said.err);
    is_printed(&out, "sweep");
    is_printed(&out, "sweep-completed");
    assert_eq!(stochc_with("fsck", &[&out]).status, 0);
    // Written by a later command that is told nothing of them, they are for a screen.
    assert_eq!(stochc_with("resume --quiet --runs 4", &[&out]).status, 0);
    let svg = std::fs::read_to_string(path(out.as_ref(), "sweep.svg")).unwrap();
    check("sweep", &svg, Medium::Screen);
    // What is no sweep has none, and what is kept nowhere neither.
    let alone = "simulate --quiet --model shuffle --runs 3 tests/fixtures/tower.sa";
    let none = path(folder.path(), "none");
    let said = stochc_with(alone, &[&["--out", &none], &PRINTED[..]].concat());
    assert_eq!(said.status, 2);
    assert!(!std::path::Path::new(&none).exists());
    assert_eq!(stochc_with(sweep, &PRINTED).status, 2);
}

#[test]
fn figures_of_a_trade_are_for_print_as_well() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let trade = "trade --quiet --runs 3 --finest 2 tests/fixtures/dense.sa";
    let said = stochc_with(trade, &[&["--out", &out], &PRINTED[..]].concat());
    assert_eq!(said.status, 0, "{}", said.err);
    is_printed(&out, "trade");
    assert_eq!(stochc_with(trade, &PRINTED).status, 2);
}

#[test]
fn figures_of_a_fit_are_for_print_as_well() {
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
    let said = stochc_with(fit, &[&given[..], &["--out", &out], &PRINTED].concat());
    assert_eq!(said.status, 0, "{}", said.err);
    is_printed(&out, "fit");
    assert_eq!(stochc_with(fit, &[&given[..], &PRINTED].concat()).status, 2);
}
