//! Parts that the figures of a sweep share.
use stochc_experiments::sweep::{Sweep, SweepPoint, SweptValue};
use stochc_text::number;

use crate::figures::EDGE;
use crate::svg::letters::fitted;
use crate::svg::{
    Drawing, LegendEntry, LegendSymbol, Medium, PlotAxis, Scale, class, dashes, plot_height,
};

/// Figure of a sweep with its axes and scales.
pub(super) struct AxesFrame {
    pub out: Drawing,
    pub x: Scale,
    pub y: Scale,
    pub bottom: f64,
}

/// Returns the horizontal offset of curve `i` of `n`. The offset keeps the intervals of several
/// curves apart.
pub(super) fn aside(i: usize, n: usize) -> f64 {
    4.0 * (i as f64 - (n as f64 - 1.0) / 2.0)
}

/// Points of a sweep that are shown in one figure.
pub(super) struct Panel<'a> {
    pub medium: Medium,
    pub sweep: &'a Sweep,
    pub points: Vec<&'a SweepPoint>,
    /// Name of the figure's file, without the extension.
    pub name: String,
    /// Values of the third and later scene parameters, which all points share.
    pub rest: &'a [SweptValue],
}

/// Curve in a figure of a sweep: points in ascending order of the value.
pub(super) struct SweepCurve<'a> {
    pub name: String,
    pub points: Vec<(f64, &'a SweepPoint)>,
}

impl<'a> Panel<'a> {
    /// Returns a curve for each program and each value of the second scene parameter.
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

    /// Returns the values that all points share, such as `tick=10 ms`. Returns `None` if there are
    /// none.
    pub fn fixed(&self) -> Option<String> {
        let further = self.sweep.axes.iter().skip(2).zip(self.rest);
        let values: Vec<String> = further.map(|(dial, value)| dial.at(*value)).collect();
        (!values.is_empty()).then(|| values.join(", "))
    }

    /// Returns the shared values as the end of a title, such as ` at tick=10 ms`.
    pub fn at(&self) -> String {
        let fixed = self.fixed();
        fixed.map_or(String::new(), |fixed| format!(" at {fixed}"))
    }

    pub fn axis(&self, i: usize) -> PlotAxis {
        let number = &self.sweep.axes[i];
        PlotAxis::new(&number.name, &number.unit)
    }

    /// Draws the axes and the legend of a figure. The first scene parameter is the horizontal axis,
    /// and `of` is the vertical one. `label` returns the text of a vertical tick.
    pub fn frame(
        &self,
        name: &str,
        (title, description): (&str, &str),
        curves: &[SweepCurve],
        (of, scale): (&PlotAxis, YScale),
        (notes, label): (&[&str], impl Fn(f64) -> String),
    ) -> AxesFrame {
        let title = format!("{title}{}", self.at());
        let mut out = Drawing::new(self.medium, name, &title, description);
        let empty = scale.at((1.0, 0.0));
        let (left, right) = (Drawing::left_of(&empty, &label), self.medium.width() - 24.0);
        let top = out.head(&of.on(&empty));
        let bottom = top + plot_height(right - left);
        let values = || curves.iter().flat_map(|curve| &curve.points).map(|it| it.0);
        let least = values().fold(f64::INFINITY, f64::min);
        let most = values().fold(f64::NEG_INFINITY, f64::max);
        let ends = (left + 14.0, right - 14.0);
        let x = if least > 0.0 && most / least > DECADE {
            Scale::logarithmic((least, most), ends)
        } else {
            Scale::linear((least, most), ends)
        };
        let y = scale.at((bottom, top));
        let foot = out.across(&x, (left, right), bottom, top, &self.axis(0));
        out.upward(&y, (bottom, top), left, right, of, label);
        let keys: Vec<LegendEntry> = (curves.iter().enumerate())
            .map(|(i, curve)| LegendEntry {
                class: class(i).to_owned(),
                sample: LegendSymbol::Line(dashes(i)),
                meaning: fitted(&curve.name, 500.0),
            })
            .collect();
        let wide = self.medium.width() - EDGE;
        let mut foot = out.keys((EDGE, foot), wide, &keys);
        let fixed = self.fixed();
        for note in fixed.as_deref().iter().chain(notes) {
            foot = out.paragraph("dim", (EDGE, foot), wide - EDGE, note) + 2.0;
        }
        let out = out.high(foot - 8.0);
        AxesFrame { out, x, y, bottom }
    }
}

/// Smallest ratio of the largest to the smallest value for a logarithmic axis.
pub(super) const DECADE: f64 = 10.0;

#[derive(Clone, Copy, Debug)]
pub(super) enum YScale {
    Linear(f64, f64),
    Logarithmic(f64, f64),
}

impl YScale {
    fn at(self, ends: (f64, f64)) -> Scale {
        match self {
            YScale::Linear(from, to) => Scale::linear((from, to), ends),
            YScale::Logarithmic(from, to) => Scale::logarithmic((from, to), ends),
        }
    }
}

/// Returns a sentence for each curve. `each` describes one of its points.
pub(super) fn description(curves: &[SweepCurve], each: impl Fn(&SweepPoint) -> String) -> String {
    let curve = |curve: &SweepCurve| {
        let points = (curve.points.iter())
            .map(|(value, point)| format!("{} at {}", each(point), number(*value)));
        format!("{}: {}", curve.name, points.collect::<Vec<_>>().join(", "))
    };
    let curves: Vec<_> = curves.iter().map(curve).collect();
    format!("{}.", curves.join(". "))
}
