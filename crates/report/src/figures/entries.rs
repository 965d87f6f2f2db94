//! Entries into the magnetic field over docking time.
use stochc_experiments::statistics::quantile;
use stochc_text::{number, visible};

use super::EDGE;
use crate::analysis::reported_program::ReportedProgram;
use crate::analysis::waits::ReportedCapture;
use crate::svg::letters::{fitted, width};
use crate::svg::{
    Drawing, LegendEntry, LegendSymbol, Marker, Medium, PlotAxis, Scale, Style, phase, plot_height,
};

/// Draws a disc at the means of each capture, above a dot for each occurrence.
pub(crate) fn entries(
    medium: Medium,
    program: usize,
    subject: &ReportedProgram,
    waits: &[ReportedCapture],
) -> Option<Drawing> {
    /// Number of dots that a browser draws without delay.
    const DOTS: usize = 1500;
    /// Number of captures with names.
    const NAMED: usize = 6;
    let means: Vec<(&ReportedCapture, f64, f64)> = (waits.iter())
        .filter_map(|wait| Some((wait, wait.entries()?, subject.on_axis(wait.docking()?))))
        .collect();
    let bonds = &subject.dots.kept;
    // Without physics there are no entries and no docking times.
    let (most_entries, most_docking) = subject.dots.most;
    let most_docking = subject.on_axis(most_docking);
    if means.is_empty() || most_docking <= 0.0 {
        return None;
    }
    // A few immediate dockings would take most of the axis. They are drawn at its lower end.
    let docking = bonds.iter().map(|bond| subject.on_axis(bond.1));
    let docking: Vec<f64> = docking.collect();
    let least = quantile(&docking, 0.02)
        .unwrap_or(1.0)
        .min(most_docking / 2.0);
    let least = means.iter().map(|mean| mean.2).fold(least, f64::min);
    let ends = (least.max(subject.on_axis(0.9)), 1.15 * most_docking);
    let mut ranked = means.clone();
    let wait = |wait: &ReportedCapture| wait.time().map_or(0.0, |time| time.mean);
    ranked.sort_by(|a, b| wait(b.0).total_cmp(&wait(a.0)));
    ranked.truncate(NAMED);
    let mut phases: Vec<usize> = (means.iter())
        .map(|(wait, ..)| wait.phase.0 as usize)
        .collect();
    phases.dedup();
    let unit = subject.figure_unit();
    let mut out = Drawing::new(
        medium,
        &format!("entries-{program}"),
        &format!(
            "{}: entries into the field against docking time",
            subject.label
        ),
        &description(subject, &ranked),
    );
    let of = subject.time_axis("from the captured block's last entry to its docking");
    let left = Drawing::left_of(&Scale::logarithmic(ends, (0.0, 1.0)), number);
    let right = medium.width() - 18.0;
    let top = out.head(&of.on(&Scale::logarithmic(ends, (0.0, 1.0))));
    let bottom = top + plot_height(right - left).max(240.0);
    let x = Scale::logarithmic((0.9, 1.15 * most_entries), (left, right));
    let y = Scale::logarithmic(ends, (bottom, top));
    let entering = PlotAxis::new(
        "entries of blocks into the reach of the pull",
        "number for each capture",
    );
    let foot = out.across(&x, (left, right), bottom, top, &entering);
    out.upward(&y, (bottom, top), left, right, &of, number);
    let every = bonds.len().div_ceil(DOTS).max(1);
    for (i, &(entries, docking)) in bonds.iter().step_by(every).enumerate() {
        // Entries are whole numbers, so dots are spread sideways.
        let apart = (i * 7 % 11) as f64 - 5.0;
        out.disc(
            "rest faint",
            (x.at(entries) + 0.7 * apart, y.at(subject.on_axis(docking))),
            1.6,
            "",
        );
    }
    for (wait, entries, docking) in &means {
        let tooltip = format!(
            "{}: {} entries, {} {unit} to dock",
            wait.text,
            number(*entries),
            number(*docking)
        );
        let class = format!("rim {}", phase(wait.phase.0 as usize));
        out.disc(&class, (x.at(*entries), y.at(*docking)), 5.0, &tooltip);
    }
    let keys: Vec<LegendEntry> = (phases.iter())
        .map(|&number| {
            let id = stochc_ir::table::PhaseId(number as u32);
            LegendEntry {
                class: format!("rim {}", phase(number)),
                sample: LegendSymbol::Mark(Marker::Disc),
                meaning: format!("phase {}", visible(subject.program.phase(id))),
            }
        })
        .collect();
    let foot = out.keys((EDGE, foot), medium.width() - EDGE, &keys);
    let centre = |entries: f64, docking: f64| (x.at(entries), y.at(docking));
    // Half-size and centre of the occupied areas.
    let discs = means
        .iter()
        .map(|mean| (centre(mean.1, mean.2), (6.0, 6.0)));
    let mut taken: Vec<_> = discs.collect();
    for (wait, entries, docking) in &ranked {
        let text = fitted(&wait.text, 0.4 * (right - left));
        let half = (width(&text) / 2.0 + 1.0, 7.0);
        let at = centre(*entries, *docking);
        let hits = |place: &(f64, f64)| {
            let inside = (left + half.0..=right - half.0).contains(&place.0)
                && (top + half.1..=bottom - half.1).contains(&place.1);
            let hit = taken.iter().filter(|((tx, ty), (tw, th))| {
                (place.0 - tx).abs() < half.0 + tw && (place.1 - ty).abs() < half.1 + th
            });
            hit.count() + if inside { 0 } else { 10 }
        };
        let places = around(at, half);
        // The nearest of the places with the least overlap.
        let place = places.iter().copied().min_by_key(hits).unwrap_or(at);
        taken.push((place, half));
        if (place.1 - at.1).abs() > 20.0 {
            let end = (place.0, place.1 + if place.1 < at.1 { 7.0 } else { -9.0 });
            out.stroke("axis", at, end, Style::line(0.7));
        }
        out.text_around("ink halo", (place.0, place.1 + 4.0), &text);
    }
    Some(out.high(foot - 8.0))
}

/// Returns possible centres of a label, in order of preference.
fn around(at: (f64, f64), half: (f64, f64)) -> Vec<(f64, f64)> {
    let aside = half.0 + 9.0;
    let mut places = vec![(at.0 + aside, at.1), (at.0 - aside, at.1)];
    for away in [15.0, 32.0, 50.0, 70.0] {
        for dx in [0.0, aside, -aside] {
            places.extend([(at.0 + dx, at.1 - away), (at.0 + dx, at.1 + away)]);
        }
    }
    places
}

fn description(subject: &ReportedProgram, ranked: &[(&ReportedCapture, f64, f64)]) -> String {
    let unit = subject.figure_unit();
    let each = ranked.iter().map(|(wait, entries, docking)| {
        format!(
            "{}: {} entries, {} {unit} to dock",
            wait.text,
            number(*entries),
            number(*docking)
        )
    });
    format!(
        "A disc for each capture, coloured by phase. The longest waited for: {}.",
        each.collect::<Vec<_>>().join("; ")
    )
}
