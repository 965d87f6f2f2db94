//! Axes of drawings: a line, ticks with their values, and a label with a unit.
use stochc_text::number;

use super::drawing::{Drawing, LINE};
use super::letters::{self, widest, wrapped};
use super::scale::Scale;
use super::shape::Form;
use super::style::Style;

/// Quantity and unit of an axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PlotAxis {
    name: String,
    unit: String,
}

impl PlotAxis {
    /// Creates the quantity of an axis. `unit` is `1` if the quantity has no dimension.
    pub fn new(name: &str, unit: &str) -> PlotAxis {
        PlotAxis {
            name: name.to_owned(),
            unit: if unit.is_empty() { "1" } else { unit }.to_owned(),
        }
    }

    /// Returns the label of an axis with this scale, such as `wait [s]` or `wait [s, logarithmic]`.
    pub fn on(&self, scale: &Scale) -> String {
        if scale.is_logarithmic() {
            format!("{} [{}, logarithmic]", self.name, self.unit)
        } else {
            self.label()
        }
    }

    /// Returns a value with the unit, such as `41.5 s` or `2,100 ticks`.
    pub fn value(&self, value: f64) -> String {
        let unit = self.unit.split(" of ").next().unwrap_or_default();
        format!("{} {unit}", number(value))
    }

    /// Returns the label of a linear or categorical axis.
    pub fn label(&self) -> String {
        format!("{} [{}]", self.name, self.unit)
    }
}

/// Position on an axis, and the label of its tick.
pub(crate) type AxisTick = (f64, String);

impl Drawing {
    /// Returns the values of ticks for a horizontal axis. Their labels do not overlap.
    pub(crate) fn ticks_across(&self, scale: &Scale) -> Vec<f64> {
        let fits = |ticks: &Vec<f64>| {
            let marks = ticks.iter().map(|&tick| {
                let text = number(tick);
                (self.within(scale.at(tick), &text), text)
            });
            are_apart(&marks.collect::<Vec<_>>())
        };
        let first = scale.ticks(1).into_iter().take(1).collect();
        let mut all = (1..=6).rev().map(|n| scale.ticks(n));
        all.find(fits).unwrap_or(first)
    }

    /// Returns the horizontal position of a centred text: the value nearest to `x` where the text
    /// fits into the drawing.
    pub(crate) fn within(&self, x: f64, text: &str) -> f64 {
        let half = letters::width(text) / 2.0 + 2.0;
        let last = (self.size().0 - half).max(half);
        x.clamp(half, last)
    }

    /// Draws a horizontal axis at the vertical position `y`, with grid lines up to `top` and its
    /// label below. Returns the baseline of the next line of text.
    pub(crate) fn across(
        &mut self,
        scale: &Scale,
        ends: (f64, f64),
        y: f64,
        top: f64,
        of: &PlotAxis,
    ) -> f64 {
        let ticks = self.ticks_across(scale).into_iter();
        let marks: Vec<AxisTick> = ticks.map(|tick| (scale.at(tick), number(tick))).collect();
        for (x, _) in &marks {
            self.line("grid", (*x, top), (*x, y));
        }
        self.marks_across(&marks, ends, y, &of.on(scale))
    }

    /// Draws a horizontal axis with ticks at given positions. Omits ticks whose labels would
    /// overlap.
    pub(crate) fn marks_across(
        &mut self,
        marks: &[AxisTick],
        (left, right): (f64, f64),
        y: f64,
        label: &str,
    ) -> f64 {
        self.push("", Style::default(), Form::PlotAxis, "");
        for (x, text) in self.apart(marks) {
            self.text_around("dim", (x, y + 17.0), &text);
        }
        self.line("axis", (left, y), (right, y));
        // The label may be slightly longer than the axis.
        let most = (right - left + 40.0).min(self.size().0 - 8.0);
        let lines = wrapped(label, most);
        let mut foot = y + 36.0;
        for line in &lines {
            self.text_around("ink", (self.within((left + right) / 2.0, line), foot), line);
            foot += LINE;
        }
        self.push("", Style::default(), Form::AxisEnd, "");
        foot + 7.0
    }

    /// Returns the ticks whose labels fit: all, or every nth.
    fn apart(&self, marks: &[AxisTick]) -> Vec<AxisTick> {
        let marks = marks.iter();
        let marks: Vec<AxisTick> = marks
            .map(|(x, text)| (self.within(*x, text), text.clone()))
            .collect();
        let every = |n: usize| marks.iter().step_by(n).cloned().collect::<Vec<_>>();
        let all = 1..=marks.len().max(1);
        let fits = |marks: &Vec<AxisTick>| are_apart(marks);
        all.map(every).find(fits).unwrap_or_default()
    }

    /// Returns the height of the label above a vertical axis.
    pub(crate) fn head(&self, label: &str) -> f64 {
        19.0 + LINE * wrapped(label, self.size().0 - 16.0).len() as f64
    }

    /// Returns the horizontal position of a vertical axis. It leaves space for the numbers to the
    /// left of the axis.
    pub(crate) fn left_of(scale: &Scale, label: impl Fn(f64) -> String) -> f64 {
        let labels: Vec<String> = scale.ticks(5).into_iter().map(label).collect();
        (widest(labels.iter().map(String::as_str)) + 15.0).max(40.0)
    }

    /// Draws a vertical axis at `x` with grid lines up to `right`, and its label above.
    pub(crate) fn upward(
        &mut self,
        scale: &Scale,
        ends: (f64, f64),
        x: f64,
        right: f64,
        of: &PlotAxis,
        label: impl Fn(f64) -> String,
    ) {
        let ticks = scale.ticks(5).into_iter();
        let marks: Vec<AxisTick> = ticks.map(|tick| (scale.at(tick), label(tick))).collect();
        for (y, _) in &marks {
            self.line("grid", (x, *y), (right, *y));
        }
        self.marks_upward(&marks, ends, (8.0, x), &of.on(scale));
    }

    /// Draws a vertical axis with ticks at given positions. Its label begins at the horizontal
    /// position `edge`.
    pub(crate) fn marks_upward(
        &mut self,
        marks: &[AxisTick],
        (bottom, top): (f64, f64),
        (edge, x): (f64, f64),
        label: &str,
    ) {
        self.push("", Style::default(), Form::PlotAxis, "");
        for (y, text) in marks {
            self.text_before("dim", (x - 7.0, y + 4.0), text);
        }
        self.line("axis", (x, bottom), (x, top));
        let lines = wrapped(label, self.size().0 - 16.0);
        for (above, line) in (0..lines.len()).rev().zip(&lines) {
            self.text("ink", (edge, top - 12.0 - LINE * above as f64), line);
        }
        self.push("", Style::default(), Form::AxisEnd, "");
    }
}

fn are_apart(marks: &[AxisTick]) -> bool {
    const APART: f64 = 8.0;
    let half = |mark: &AxisTick| letters::width(&mark.1) / 2.0;
    (marks.windows(2)).all(|pair| pair[0].0 + half(&pair[0]) + APART <= pair[1].0 - half(&pair[1]))
}
