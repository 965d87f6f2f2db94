//! Figure of the waiting time of each capture, and of its share of the completion time.
use stochc_text::{counted, number, percent};

use super::EDGE;
use crate::analysis::reported_program::ReportedProgram;
use crate::analysis::waits::ReportedCapture;
use crate::svg::letters::{fitted, widest, width, wrapped};
use crate::svg::{Drawing, LINE, Medium, Scale, Style};

/// Largest number of captures in the figure. If there are more, it shows the captures with the
/// largest shares.
pub(crate) const SHOWN: usize = 60;

/// Draws the mean waiting time of each capture as a dot with its interval. Captures are in the
/// order of the dependency graph. Bars to the right show shares of the completion time.
///
/// `program` is the index of the program in the report.
pub(crate) fn waits(
    medium: Medium,
    program: usize,
    subject: &ReportedProgram,
    waits: &[ReportedCapture],
) -> Option<Drawing> {
    const ROW: f64 = 20.0;
    /// Left edge of the names of captures, next to the lines that connect dependent captures.
    const NAMES: f64 = 30.0;
    const SHARES: &str = "share of the time that runs waited only for it [%]";
    const SHOWS: &str = "mean, 95\u{a0}% interval, middle 80\u{a0}% of the waits";
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
    let rows = ROW * (shown.len() + groups.count()) as f64;
    let mut out = Drawing::new(
        medium,
        &format!("waits-{program}"),
        &format!("{}: waiting times of captures", subject.label),
        &description(subject, &shown),
    );
    let decisive = shown.iter().any(|wait| wait.share.is_some());
    let most = shown
        .iter()
        .filter_map(|wait| wait.share)
        .fold(0.0, f64::max);
    // Names, waiting times and bars are side by side.
    let all = medium.width();
    let names = widest(shown.iter().map(|wait| wait.text.as_str())).min(0.29 * all);
    let left = (NAMES + names + 12.0).max(100.0);
    let percents = width("100.0 %") + 8.0;
    let bars_end = all - percents;
    let bars = if decisive {
        bars_end - 0.12 * all
    } else {
        bars_end
    };
    // Add space for a mark after the longest interval.
    let right = bars - 26.0;
    let (shows, shares) = (
        wrapped(SHOWS, right - left),
        wrapped(SHARES, all - bars - 2.0),
    );
    let top = 18.0 + LINE * shows.len().max(if decisive { shares.len() } else { 1 }) as f64;
    let height = top + rows;
    let x = Scale::linear((0.0, subject.on_axis(last)), (left, right));
    let axis = subject.time_axis("wait");
    let mut foot = out.across(&x, (left, right), height, top, &axis);
    let bar = Scale::linear((0.0, most.max(0.01)), (bars, bars_end));
    let mut heading = |x: f64, lines: &[String]| {
        for (above, line) in (0..lines.len()).rev().zip(lines) {
            out.text("ink", (x, top - 13.0 - LINE * above as f64), line);
        }
    };
    heading(EDGE, &["capture".to_owned()]);
    heading(left, &shows);
    if decisive {
        heading(bars, &shares);
        out.line("axis", (bars, top), (bars, height));
    }
    let mut y = top;
    let mut phase = None;
    for wait in &shown {
        let begins = phase.replace(wait.phase) != Some(wait.phase);
        if begins {
            let name = subject.program.phase(wait.phase);
            let name = fitted(&format!("phase {name}"), left - EDGE - 8.0);
            out.text("dim", (EDGE, y + 14.0), &name);
            y += ROW;
        }
        let middle = y + ROW / 2.0;
        if wait.follows && !begins {
            out.line("axis", (20.0, y - ROW / 2.0 + 6.0), (20.0, middle));
            out.line("axis", (20.0, middle), (27.0, middle));
        }
        out.text("ink", (NAMES, middle + 4.0), &fitted(&wait.text, names));
        // The largest share is highlighted.
        let hot = most > 0.0 && wait.share.is_some_and(|share| share >= 0.999 * most);
        let class = if hot { "hot" } else { "s0" };
        draw_wait(&mut out, subject, wait, class, &x, middle);
        if let Some(share) = wait.share {
            draw_share(&mut out, wait, share, class, &bar, middle);
        }
        y += ROW;
    }
    if waits.len() > shown.len() {
        let note = format!(
            "The {} of {} captures with the largest shares",
            shown.len(),
            waits.len()
        );
        foot = out.paragraph("dim", (EDGE, foot), all - 2.0 * EDGE, &note);
    }
    Some(out.high(foot - 8.0))
}

/// Draws a capture's mean waiting time, its interval, and the range from the 10th to the 90th
/// percentile. `y` is the middle of the row.
fn draw_wait(
    out: &mut Drawing,
    subject: &ReportedProgram,
    wait: &ReportedCapture,
    class: &str,
    x: &Scale,
    y: f64,
) {
    let at = |ticks: f64| x.at(subject.on_axis(ticks));
    if let Some((low, high)) = wait.spread() {
        let style = Style::line(1.0).faint(0.65);
        out.stroke(class, (at(low), y), (at(high), y), style);
    }
    let Some(time) = wait.time() else {
        return out.text("dim", (at(0.0) + 4.0, y + 4.0), "never waited for");
    };
    let half = time.half_width.unwrap_or(0.0);
    let (low, high) = (at(time.mean - half), at(time.mean + half));
    out.stroke(class, (low, y), (high, y), Style::line(4.0));
    let bound = if time.incomplete > 0 { "≥ " } else { "" };
    let interval = match half {
        0.0 => subject.described(time.mean),
        half => format!(
            "{} ± {}",
            number(subject.on_axis(time.mean)),
            subject.described(half)
        ),
    };
    let captures = counted(time.completed, "capture");
    let tooltip = format!("{}: {bound}{interval}, {captures}", wait.text);
    out.disc(class, (at(time.mean), y), 4.5, &tooltip);
    if time.incomplete > 0 {
        out.text("ink", (high + 6.0, y + 4.0), "≥");
    }
}

/// Draws the share of a capture in the completion time as a bar. `y` is the middle of its row.
fn draw_share(
    out: &mut Drawing,
    wait: &ReportedCapture,
    share: f64,
    class: &str,
    bar: &Scale,
    y: f64,
) {
    let tooltip = format!("{}: {}", wait.text, percent(share));
    let size = (bar.at(share) - bar.at(0.0), 10.0);
    let class = format!("bar {class}");
    out.rectangle(&class, (bar.at(0.0), y - 5.0), size, &tooltip);
    out.text("dim", (bar.at(share) + 5.0, y + 4.0), &percent(share));
}

/// Returns the captures that fit in the figure, in their order.
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
    ranked.sort_by_key(|&(position, _)| position);
    ranked.into_iter().map(|(_, wait)| wait).collect()
}

fn description(subject: &ReportedProgram, shown: &[&ReportedCapture]) -> String {
    let mean = |wait: &&&ReportedCapture| wait.time().map_or(0.0, |time| time.mean);
    let longest = shown.iter().max_by(|a, b| mean(a).total_cmp(&mean(b)));
    let share = |wait: &&&ReportedCapture| wait.share.unwrap_or(0.0);
    let most = shown.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
    let mut text = format!("Each of {} captures has a row.", shown.len());
    if let Some(wait) = longest {
        text += &format!(
            " {} has the longest mean waiting time, {}.",
            wait.text,
            subject.described(mean(&wait))
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
