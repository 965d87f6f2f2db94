//! Tests figures for screens and print: no content is cut off or hidden, and every axis has a
//! label.
use std::sync::Arc;

use stochc_experiments::Time;
use stochc_experiments::statistics::Observation;
use stochc_experiments::sweep::{Sweep, SweepPoint, SweptNumber, SweptValue};
use stochc_report::ensemble_report::{FigureFormat, Figures, Input, Medium, Report};
use stochc_report::figures;

use crate::layout::{MEDIA, check, classes};
use crate::reading::parsed;
use crate::sample::{drawn, five};

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

/// Returns an input with names that are longer than the available space.
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
fn nothing_is_clipped_or_hidden_at_any_width() {
    for medium in MEDIA {
        let figures = figures_for(medium, &[FigureFormat::Svg]);
        let both = [0.1, 0.2].map(five);
        assert_eq!(check_all(&drawn(&both, &figures), medium), 10);
        let long = both.map(long_names);
        assert_eq!(check_all(&drawn(&long, &figures), medium), 10);
    }
}

/// Checks that the format of figure files affects only their names in the page.
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
    assert_eq!(pages, 4);
}

/// Returns a sweep over several parameters whose times follow a power of the first one.
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
        name: name.into(),
        unit: "N".into(),
    };
    Sweep {
        axes: numbers.iter().map(|(name, _)| axis(name)).collect(),
        settings: Vec::new(),
        unit: "ticks",
        points: points.collect(),
        elasticities: Vec::new(),
    }
}

fn swept(values: &[f64], power: f64) -> Sweep {
    swept_over(&[("bond.pull", values)], power)
}

#[test]
fn maps_of_two_parameters_fit() {
    let values: Vec<f64> = (0..12).map(|i| 1.5 + 1000.0 * f64::from(i)).collect();
    let sweep = swept_over(&[("bond.pull", &values), ("bond.reach", &values)], 1.0);
    for medium in MEDIA {
        let drawings = figures::sweep(medium, &sweep, "sweep");
        assert_eq!(drawings.len(), 1);
        check("sweep", &drawings[0].file(), medium);
    }
}

/// Checks that a power law is drawn as a straight line. Both axes are logarithmic if both span more
/// than a factor of ten.
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
