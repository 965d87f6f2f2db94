//! Heat map of mean times over two scene parameters.
use stochc_experiments::sweep::{SweepPoint, SweptValue};
use stochc_text::number;

use super::frame::Panel;
use super::times::described;
use crate::figures::EDGE;
use crate::svg::letters::{fitted, widest, width as width_of};
use crate::svg::{Drawing, Style};

/// Draws a heat map of a program: a coloured field for each pair of parameter values. Longer times
/// are darker. Returns `None` if no run of the program has a time.
pub(super) fn heat(panel: &Panel, name: &str, program: &str) -> Option<Drawing> {
    const HEIGHT: f64 = 30.0;
    let own = || panel.points.iter().filter(|point| point.program == program);
    let unit = panel.sweep.unit;
    let mean = |point: &SweepPoint| point.time.as_ref().map(|time| time.mean);
    let most = own().filter_map(|point| mean(point)).fold(0.0, f64::max);
    if most <= 0.0 {
        return None;
    }
    let least = own().filter_map(|point| mean(point)).fold(most, f64::min);
    let (across, up) = (values(own(), 0), values(own(), 1));
    let numbers: Vec<String> = up.iter().map(|value| number(value.value)).collect();
    let left = EDGE + 7.0 + widest(numbers.iter().map(String::as_str));
    let all = panel.medium.width();
    let width = (all - left - 24.0) / across.len() as f64;
    let axes = &panel.sweep.axes;
    let title = format!(
        "Mean completion time of {program} over {} and {}{}",
        axes[0].name,
        axes[1].name,
        panel.at()
    );
    let tooltip: Vec<String> = own()
        .map(|point| format!("{}: {}", point.name, described(point, unit)))
        .collect();
    let mut out = Drawing::new(
        panel.medium,
        name,
        &title,
        &format!("{}.", tooltip.join(". ")),
    );
    let top = out.head(&panel.axis(1).label());
    let bottom = top + HEIGHT * up.len() as f64;
    let rows = numbers.iter().rev().enumerate();
    let rows = rows.map(|(row, text)| (top + HEIGHT * (row as f64 + 0.5), text.clone()));
    out.marks_upward(
        &rows.collect::<Vec<_>>(),
        (bottom, top),
        (EDGE, left),
        &panel.axis(1).label(),
    );
    let columns = across.iter().enumerate();
    let columns = columns.map(|(i, it)| (left + width * (i as f64 + 0.5), number(it.value)));
    let foot = out.marks_across(
        &columns.collect::<Vec<_>>(),
        (left, all - 24.0),
        bottom,
        &panel.axis(0).label(),
    );
    for (point, tooltip) in own().zip(&tooltip) {
        let position =
            |of: &[SweptValue], i: usize| of.iter().position(|it| *it == point.values[i]);
        let (Some(column), Some(row)) = (position(&across, 0), position(&up, 1)) else {
            continue;
        };
        let corner = (
            left + width * column as f64,
            bottom - HEIGHT * (row + 1) as f64,
        );
        let (strength, text) = match &point.time {
            None => (0.0, "×".to_owned()),
            Some(time) => {
                let share = (time.mean - least) / (most - least).max(f64::MIN_POSITIVE);
                let bound = if time.incomplete > 0 { "≥ " } else { "" };
                (0.08 + 0.5 * share, format!("{bound}{}", number(time.mean)))
            }
        };
        let own = Style {
            fill_opacity: Some(strength),
            stroke_opacity: Some(0.4),
            ..Style::default()
        };
        out.field("s0", corner, (width - 2.0, HEIGHT - 2.0), own, tooltip);
        // Text that does not fit into the field is only in its tooltip.
        if width_of(&text) + 4.0 <= width {
            let position = (corner.0 + width / 2.0, corner.1 + HEIGHT / 2.0 + 3.0);
            out.text_around("ink", position, &text);
        }
    }
    let legend = format!(
        "{}{}: mean completion time [{unit}], from {} (light) to {} (dark). ≥ is a lower bound, × has no time",
        fitted(program, 200.0),
        panel.at(),
        number(least),
        number(most)
    );
    let foot = out.paragraph("dim", (EDGE, foot), all - 2.0 * EDGE, &legend);
    Some(out.high(foot - 8.0))
}

/// Returns the distinct values of an axis in ascending order.
fn values<'a>(points: impl Iterator<Item = &'a &'a SweepPoint>, axis: usize) -> Vec<SweptValue> {
    let mut found: Vec<SweptValue> = Vec::new();
    for point in points {
        if !found.contains(&point.values[axis]) {
            found.push(point.values[axis]);
        }
    }
    found.sort_by(|a, b| a.value.total_cmp(&b.value));
    found
}
