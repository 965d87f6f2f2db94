//! How long each capture was waited for, and how much of the runs' time that decided.
use stochc_ensemble::text::{number, percent};

use super::{WIDTH, short};
use crate::analysis::subject::ReportedProgram;
use crate::analysis::waits::ReportedCapture;
use crate::svg::{Drawing, Scale};

/// Rows of the figure; of more captures, those that decided most are shown.
pub(crate) const SHOWN: usize = 60;

/// A dot for each mean, with its interval, in the order of the dependency graph; bars at the right.
///
/// `number` is that of the program in the report.
pub(crate) fn waits(
    program: usize,
    subject: &ReportedProgram,
    waits: &[ReportedCapture],
) -> Option<Drawing> {
    const LEFT: f64 = 190.0;
    const RIGHT: f64 = 560.0;
    const BARS: f64 = 590.0;
    const BARS_END: f64 = WIDTH - 54.0;
    const TOP: f64 = 44.0;
    const ROW: f64 = 20.0;
    let shown = shown(waits);
    let times = shown.iter().filter_map(|wait| wait.time());
    let ends = times.map(|time| time.mean + time.half_width.unwrap_or(0.0));
    let spreads = shown.iter().filter_map(|wait| Some(wait.spread()?.1));
    let last = ends.chain(spreads).fold(0.0, f64::max);
    if shown.is_empty() || last <= 0.0 {
        return None;
    }
    let mut phase = None;
    let groups = shown
        .iter()
        .filter(|wait| phase.replace(wait.phase) != Some(wait.phase));
    let height = TOP + ROW * (shown.len() + groups.count()) as f64;
    let mut out = Drawing::new(
        &format!("waits-{program}"),
        &format!("{}: how long each capture was waited for", subject.label),
        &told(&shown),
        (WIDTH, height + 64.0),
    );
    let x = Scale::linear((0.0, last), (LEFT, RIGHT));
    let axis = format!("wait [{}]", subject.tick().unit());
    out.across(&x, (LEFT, RIGHT), height, TOP, &axis);
    let decisive = shown.iter().any(|wait| wait.share.is_some());
    let most = shown
        .iter()
        .filter_map(|wait| wait.share)
        .fold(0.0, f64::max);
    let bar = Scale::linear((0.0, most.max(0.01)), (BARS, BARS_END));
    if decisive {
        out.text("ink", (BARS, TOP - 28.0), "part of the runs'");
        out.text("ink", (BARS, TOP - 13.0), "time it decided");
        out.line("axis", (BARS, TOP), (BARS, height), "");
    }
    out.text("ink", (8.0, TOP - 13.0), "capture");
    out.text(
        "ink",
        (LEFT, TOP - 13.0),
        "mean, 95 % interval, middle 80 % of the runs",
    );
    let mut y = TOP;
    let mut phase = None;
    for wait in &shown {
        let begins = phase.replace(wait.phase) != Some(wait.phase);
        if begins {
            let name = subject.program.phase(wait.phase);
            out.text(
                "dim",
                (8.0, y + 14.0),
                &format!("phase {}", short(name, 22)),
            );
            y += ROW;
        }
        let middle = y + ROW / 2.0;
        if wait.follows && !begins {
            out.line("axis", (20.0, y - ROW / 2.0 + 6.0), (20.0, middle), "");
            out.line("axis", (20.0, middle), (27.0, middle), "");
        }
        out.text("ink", (30.0, middle + 4.0), &short(&wait.text, 24));
        // What decided most is what a reader looks for.
        let hot = most > 0.0 && wait.share.is_some_and(|share| share >= 0.999 * most);
        let class = if hot { "hot" } else { "s0" };
        if let Some((low, high)) = wait.spread() {
            let style = "stroke-width=\"1\" opacity=\"0.65\"";
            out.line(class, (x.at(low), middle), (x.at(high), middle), style);
        }
        match wait.time() {
            Some(time) => {
                let half = time.half_width.unwrap_or(0.0);
                let (low, high) = (x.at(time.mean - half), x.at(time.mean + half));
                out.line(class, (low, middle), (high, middle), "stroke-width=\"4\"");
                let bound = if time.censored > 0 { "at least " } else { "" };
                let told = format!(
                    "{}: {bound}{} ± {} ticks, {} captures",
                    wait.text,
                    number(time.mean),
                    number(half),
                    time.completed
                );
                out.disc(class, (x.at(time.mean), middle), 4.5, &told);
                if time.censored > 0 {
                    out.text("ink", (high + 6.0, middle + 4.0), "≥");
                }
            }
            None => out.text("dim", (LEFT + 4.0, middle + 4.0), "never waited for"),
        }
        if let Some(share) = wait.share {
            let told = format!("{}: {}", wait.text, percent(share));
            let size = (bar.at(share) - BARS, 10.0);
            out.rectangle(&format!("bar {class}"), (BARS, middle - 5.0), size, &told);
            out.text("dim", (bar.at(share) + 5.0, middle + 4.0), &percent(share));
        }
        y += ROW;
    }
    if waits.len() > shown.len() {
        let note = format!(
            "{} of {} captures: those that decided most",
            shown.len(),
            waits.len()
        );
        out.text("dim", (8.0, height + 56.0), &note);
    }
    Some(out)
}

/// The captures that fit, in their order.
fn shown(waits: &[ReportedCapture]) -> Vec<&ReportedCapture> {
    let mut ranked: Vec<(usize, &ReportedCapture)> = waits.iter().enumerate().collect();
    let weight = |wait: &ReportedCapture| {
        let mean = wait.time().map_or(0.0, |time| time.mean);
        (wait.share.unwrap_or(0.0), mean)
    };
    ranked.sort_by(|(_, a), (_, b)| {
        let (a, b) = (weight(a), weight(b));
        b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1))
    });
    ranked.truncate(SHOWN);
    ranked.sort_by_key(|&(place, _)| place);
    ranked.into_iter().map(|(_, wait)| wait).collect()
}

fn told(shown: &[&ReportedCapture]) -> String {
    let mean = |wait: &&&ReportedCapture| wait.time().map_or(0.0, |time| time.mean);
    let longest = shown.iter().max_by(|a, b| mean(a).total_cmp(&mean(b)));
    let share = |wait: &&&ReportedCapture| wait.share.unwrap_or(0.0);
    let most = shown.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
    let mut text = format!("A row for each of {} captures.", shown.len());
    if let Some(wait) = longest {
        text += &format!(
            " The longest mean wait is that of {}, {} ticks.",
            wait.text,
            number(mean(&wait))
        );
    }
    if let Some(wait) = most.filter(|wait| wait.share.is_some()) {
        text += &format!(
            " {} decided most of the time: {}.",
            wait.text,
            percent(share(&wait))
        );
    }
    text
}
