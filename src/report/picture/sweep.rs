//! Mean times over a number of the scene that was varied.
use super::{WIDTH, short};
use crate::figures::{DASHES, Drawing, Scale, class, number};
use crate::report::sweep::Sweep;

/// A curve for each program, with the 95 % intervals of its means.
pub(in crate::report) fn sweep(index: usize, sweep: &Sweep, unit: &str) -> Option<Drawing> {
    const TOP: f64 = 34.0;
    const BOTTOM: f64 = 300.0;
    const LEFT: f64 = 70.0;
    const RIGHT: f64 = WIDTH - 24.0;
    let points = || sweep.curves.iter().flat_map(|curve| &curve.points);
    let least = points().map(|point| point.0).fold(f64::INFINITY, f64::min);
    let most = points()
        .map(|point| point.0)
        .fold(f64::NEG_INFINITY, f64::max);
    let half = |half: Option<f64>| half.unwrap_or(0.0);
    let ends = points().map(|(_, _, time)| time.mean + half(time.half_width));
    let last = ends.fold(0.0, f64::max);
    if last <= 0.0 || least >= most {
        return None;
    }
    let places = (LEFT + 14.0, RIGHT - 14.0);
    let logarithmic = least > 0.0 && most / least > 10.0;
    let x = match logarithmic {
        true => Scale::logarithmic((least, most), places),
        false => Scale::linear((least, most), places),
    };
    let y = Scale::linear((0.0, last), (BOTTOM, TOP));
    let height = BOTTOM + 58.0 + 19.0 * sweep.curves.len() as f64;
    let title = format!("Mean time to completion over {}", sweep.of);
    let mut out = Drawing::new(
        &format!("sweep-{index}"),
        &title,
        &told(sweep, unit),
        (WIDTH, height),
    );
    let note = if logarithmic { ", logarithmic" } else { "" };
    let of = format!("{} (SI units{note})", sweep.of);
    out.across(&x, (LEFT, RIGHT), BOTTOM, TOP, &of);
    let of = format!("mean time to completion [{unit}]");
    out.upward(&y, (BOTTOM, TOP), LEFT, RIGHT, &of, number);
    for (i, curve) in sweep.curves.iter().enumerate() {
        let places = curve
            .points
            .iter()
            .map(|(value, _, time)| (x.at(*value), y.at(time.mean)));
        let dashes = DASHES[i % DASHES.len()];
        out.curve(class(i), &places.collect::<Vec<_>>(), dashes);
        for (value, _, time) in &curve.points {
            let (at, half) = (x.at(*value), half(time.half_width));
            let ends = (y.at(time.mean - half), y.at(time.mean + half));
            out.line(class(i), (at, ends.0), (at, ends.1), "stroke-width=\"2\"");
            let told = format!(
                "{}: {} ± {}",
                number(*value),
                number(time.mean),
                number(half)
            );
            out.disc(class(i), (at, y.at(time.mean)), 4.5, &told);
        }
        let at = BOTTOM + 58.0 + 19.0 * i as f64;
        out.curve(
            class(i),
            &[(LEFT, at - 4.0), (LEFT + 34.0, at - 4.0)],
            dashes,
        );
        out.text("ink", (LEFT + 42.0, at), &short(&curve.name, 60));
    }
    Some(out)
}

fn told(sweep: &Sweep, unit: &str) -> String {
    let curve = |curve: &crate::report::sweep::Curve| {
        let points = curve
            .points
            .iter()
            .map(|(value, _, time)| format!("{} {unit} at {}", number(time.mean), number(*value)));
        format!("{}: {}", curve.name, points.collect::<Vec<_>>().join(", "))
    };
    let curves: Vec<_> = sweep.curves.iter().map(curve).collect();
    format!("{}.", curves.join(". "))
}
