//! Mean times over two numbers that were varied, as a map.
use stochc_ensemble::sweep::{SweepPoint, SweptValue};
use stochc_ensemble::text::number;

use super::WIDTH;
use super::frame::Panel;
use super::times::described;
use crate::svg::Drawing;
use crate::text::short;

/// A field for each pair of values, the darker the longer; `None`: no run of the program has a time.
pub(super) fn heat(panel: &Panel, name: &str, program: &str) -> Option<Drawing> {
    const LEFT: f64 = 110.0;
    const TOP: f64 = 34.0;
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
    let width = (WIDTH - LEFT - 24.0) / across.len() as f64;
    let bottom = TOP + HEIGHT * up.len() as f64;
    let axes = &panel.sweep.axes;
    let title = format!(
        "Mean time to completion of {program} over {} and {}{}",
        axes[0].of,
        axes[1].of,
        panel.at()
    );
    let told: Vec<String> = own()
        .map(|point| format!("{}: {}", point.name, described(point, unit)))
        .collect();
    let size = (WIDTH, bottom + 76.0);
    let mut out = Drawing::new(name, &title, &format!("{}.", told.join(". ")), size);
    out.text("ink", (8.0, TOP - 12.0), &axes[1].label());
    for (row, value) in up.iter().rev().enumerate() {
        let y = TOP + HEIGHT * (row as f64 + 0.5) + 4.0;
        out.text_before("dim", (LEFT - 7.0, y), &number(value.value));
    }
    for (column, value) in across.iter().enumerate() {
        let x = LEFT + width * (column as f64 + 0.5);
        out.text_around("dim", (x, bottom + 17.0), &number(value.value));
    }
    for (point, told) in own().zip(&told) {
        let place = |of: &[SweptValue], i: usize| of.iter().position(|it| *it == point.values[i]);
        let (Some(column), Some(row)) = (place(&across, 0), place(&up, 1)) else {
            continue;
        };
        let corner = (
            LEFT + width * column as f64,
            bottom - HEIGHT * (row + 1) as f64,
        );
        let (strength, text) = match &point.time {
            None => (0.0, "×".to_owned()),
            Some(time) => {
                let share = (time.mean - least) / (most - least).max(f64::MIN_POSITIVE);
                let bound = if time.censored > 0 { "≥ " } else { "" };
                (0.08 + 0.5 * share, format!("{bound}{}", number(time.mean)))
            }
        };
        out.shade("s0", corner, (width - 2.0, HEIGHT - 2.0), strength, told);
        // What does not fit is told by a pointer over the field.
        let letters = (width / 7.0) as usize;
        if text.chars().count() <= letters {
            let place = (corner.0 + width / 2.0, corner.1 + HEIGHT / 2.0 + 3.0);
            out.text_around("ink", place, &text);
        }
    }
    let middle = (LEFT + WIDTH - 24.0) / 2.0;
    out.text_around("ink", (middle, bottom + 36.0), &axes[0].label());
    let legend = format!(
        "{}: mean time to completion [{unit}], {} (light) to {} (dark); ≥: some runs were stopped; ×: no time",
        short(program, 30),
        number(least),
        number(most)
    );
    out.text("dim", (8.0, bottom + 62.0), &legend);
    Some(out)
}

/// The values of an axis that points have, each once, the smallest first.
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
