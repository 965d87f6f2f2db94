//! Mean times to completion side by side.
use stochc_ensemble::Time;
use stochc_ensemble::text::number;

use super::{WIDTH, short};
use crate::svg::{Drawing, Scale, class};

/// A dot for each program, with the 95 % interval of its mean.
pub(crate) fn means(times: &[(&str, Time)], unit: &str) -> Option<Drawing> {
    const LEFT: f64 = 250.0;
    const RIGHT: f64 = WIDTH - 24.0;
    const TOP: f64 = 14.0;
    const ROW: f64 = 26.0;
    let half = |time: &Time| time.half_width.unwrap_or(0.0);
    let ends = times.iter().map(|(_, time)| time.mean + half(time));
    let last = ends.fold(0.0, f64::max);
    if last <= 0.0 {
        return None;
    }
    let told: Vec<_> = times
        .iter()
        .map(|(name, time)| described(name, time, unit))
        .collect();
    let bottom = TOP + ROW * times.len() as f64;
    let mut out = Drawing::new(
        "means",
        "Mean times to completion",
        &format!("{}.", told.join(". ")),
        (WIDTH, bottom + 48.0),
    );
    let x = Scale::linear((0.0, last), (LEFT, RIGHT));
    let of = format!("mean time to completion, 95 % interval [{unit}]");
    out.across(&x, (LEFT, RIGHT), bottom, TOP, &of);
    for (i, ((name, time), told)) in times.iter().zip(&told).enumerate() {
        let y = TOP + ROW * (i as f64 + 0.5);
        out.text("ink", (8.0, y + 4.0), &short(name, 34));
        let (low, high) = (x.at(time.mean - half(time)), x.at(time.mean + half(time)));
        out.line(class(i), (low, y), (high, y), "stroke-width=\"3\"");
        out.disc(class(i), (x.at(time.mean), y), 5.0, told);
        if time.censored > 0 {
            out.text("ink", (high + 7.0, y + 4.0), "≥");
        }
    }
    Some(out)
}

fn described(name: &str, time: &Time, unit: &str) -> String {
    let bound = if time.censored > 0 { "at least " } else { "" };
    let half = match time.half_width {
        Some(half) => format!(" ± {}", number(half)),
        None => String::new(),
    };
    format!("{name}: {bound}{}{half} {unit}", number(time.mean))
}
