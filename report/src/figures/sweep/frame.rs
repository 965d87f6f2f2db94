//! What figures over a number that was varied have in common.
use stochc_ensemble::sweep::{Sweep, SweepPoint, SweptValue};
use stochc_ensemble::text::number;

use super::WIDTH;
use crate::svg::{DASHES, Drawing, Scale, class};
use crate::text::short;

pub(super) const TOP: f64 = 34.0;
pub(super) const BOTTOM: f64 = 300.0;
pub(super) const LEFT: f64 = 70.0;
pub(super) const RIGHT: f64 = WIDTH - 24.0;
/// Height of a line of the legend.
const ROW: f64 = 19.0;

/// How far curve number `i` of `n` is moved aside, so that its intervals hide no others.
pub(super) fn aside(i: usize, n: usize) -> f64 {
    4.0 * (i as f64 - (n as f64 - 1.0) / 2.0)
}

/// The points of one figure.
pub(super) struct Panel<'a> {
    pub sweep: &'a Sweep,
    pub points: Vec<&'a SweepPoint>,
    /// Of its file, without the ending.
    pub name: String,
    /// The values of the third number and those after it, which all its points share.
    pub rest: &'a [SweptValue],
}

/// The points that are joined by a line, by value.
pub(super) struct SweepCurve<'a> {
    pub name: String,
    pub points: Vec<(f64, &'a SweepPoint)>,
}

impl<'a> Panel<'a> {
    /// A curve for each program and each value of the second number.
    pub fn curves(&self) -> Vec<SweepCurve<'a>> {
        let several = self.sweep.programs().len() > 1;
        let second = |point: &SweepPoint| point.values.get(1).copied();
        let mut keys: Vec<(&str, Option<SweptValue>)> = Vec::new();
        for point in &self.points {
            let key = (&*point.program, second(point));
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
        let curve = |(program, value): (&str, Option<SweptValue>)| {
            let own = (self.points.iter())
                .filter(|point| (&*point.program, second(point)) == (program, value));
            let mut points: Vec<(f64, &SweepPoint)> = own
                .filter_map(|point| Some((point.values.first()?.value, *point)))
                .collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let value = value.map(|value| self.sweep.axes[1].at(value));
            let name = match (several, value) {
                (_, None) => program.to_owned(),
                (false, Some(value)) => value,
                (true, Some(value)) => format!("{program}, {value}"),
            };
            SweepCurve { name, points }
        };
        keys.into_iter().map(curve).collect()
    }

    /// What is the same in all of it, for its title: ` at tick=10 ms`.
    pub fn at(&self) -> String {
        let further = self.sweep.axes.iter().skip(2).zip(self.rest);
        let values: Vec<String> = further.map(|(dial, value)| dial.at(*value)).collect();
        match values.is_empty() {
            true => String::new(),
            false => format!(" at {}", values.join(", ")),
        }
    }

    /// A figure with the axis of the first number, and the lines of a legend below it.
    pub fn drawing(
        &self,
        name: &str,
        title: &str,
        told: &str,
        curves: &[SweepCurve],
        notes: &[&str],
    ) -> (Drawing, Scale) {
        let values = || curves.iter().flat_map(|curve| &curve.points).map(|it| it.0);
        let least = values().fold(f64::INFINITY, f64::min);
        let most = values().fold(f64::NEG_INFINITY, f64::max);
        let places = (LEFT + 14.0, RIGHT - 14.0);
        let is_logarithmic = least > 0.0 && most / least > 10.0;
        let x = match is_logarithmic {
            true => Scale::logarithmic((least, most), places),
            false => Scale::linear((least, most), places),
        };
        let rows = (curves.len() + notes.len()) as f64;
        let size = (WIDTH, BOTTOM + 58.0 + ROW * rows);
        let title = format!("{title}{}", self.at());
        let mut out = Drawing::new(name, &title, told, size);
        let note = if is_logarithmic { " (logarithmic)" } else { "" };
        let of = format!("{}{note}", self.sweep.axes[0].label());
        out.across(&x, (LEFT, RIGHT), BOTTOM, TOP, &of);
        let line = |i: usize| BOTTOM + 58.0 + ROW * i as f64;
        for (i, curve) in curves.iter().enumerate() {
            let (at, dashes) = (line(i), DASHES[i % DASHES.len()]);
            out.curve(
                class(i),
                &[(LEFT, at - 4.0), (LEFT + 34.0, at - 4.0)],
                dashes,
            );
            out.text("ink", (LEFT + 42.0, at), &short(&curve.name, 80));
        }
        for (i, note) in notes.iter().enumerate() {
            out.text("dim", (LEFT, line(curves.len() + i)), note);
        }
        (out, x)
    }
}

/// One sentence for each curve, of what `each` says of its points.
pub(super) fn told(curves: &[SweepCurve], each: impl Fn(&SweepPoint) -> String) -> String {
    let curve = |curve: &SweepCurve| {
        let points = (curve.points.iter())
            .map(|(value, point)| format!("{} at {}", each(point), number(*value)));
        format!("{}: {}", curve.name, points.collect::<Vec<_>>().join(", "))
    };
    let curves: Vec<_> = curves.iter().map(curve).collect();
    format!("{}.", curves.join(". "))
}
