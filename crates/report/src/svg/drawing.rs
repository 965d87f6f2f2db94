//! Drawing with a name, a title, and a description for screen readers.
use stochc_text::palette::Rgb;

use super::letters::{self, fitted, wrapped};
use super::medium::Medium;
use super::shape::{DrawnShape, Form, Marker, Point, TextAnchor};
use super::style::{Paint, Style};

/// Line height of text, in units of a drawing.
pub(crate) const LINE: f64 = 15.0;

/// Drawing under construction. Text is 12 units high.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Name of the drawing's file without extension: letters, digits and `-`.
    pub name: String,
    /// Title of the figure.
    pub title: String,
    /// Description of the figure's content.
    pub description: String,
    pub(super) medium: Medium,
    size: (f64, f64),
    shapes: Vec<DrawnShape>,
}

#[derive(Clone, Debug)]
pub(crate) struct LegendEntry {
    pub class: String,
    pub sample: LegendSymbol,
    pub meaning: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LegendSymbol {
    /// Bar with this kind of hatching.
    Bar(usize),
    Mark(Marker),
    /// Line with this dash pattern.
    Line(&'static str),
}

impl Drawing {
    /// Creates an empty drawing of the medium's default width.
    pub(crate) fn new(medium: Medium, name: &str, title: &str, description: &str) -> Drawing {
        Drawing::sized(medium, medium.width(), name, title, description)
    }

    /// Creates an empty drawing of another width.
    pub(crate) fn sized(
        medium: Medium,
        width: f64,
        name: &str,
        title: &str,
        description: &str,
    ) -> Drawing {
        Drawing {
            name: name.to_owned(),
            title: title.to_owned(),
            description: description.to_owned(),
            medium,
            size: (width, 0.0),
            shapes: Vec::new(),
        }
    }

    /// Sets the height of the drawing.
    pub(crate) fn high(mut self, height: f64) -> Drawing {
        self.size.1 = height;
        self
    }

    /// Returns the width and height of the drawing, in units.
    pub(crate) fn size(&self) -> (f64, f64) {
        self.size
    }

    pub(crate) fn shapes(&self) -> &[DrawnShape] {
        &self.shapes
    }

    pub(crate) fn push(&mut self, class: &str, own: Style, form: Form, tooltip: &str) {
        self.shapes.push(DrawnShape {
            class: class.to_owned(),
            own,
            form,
            tooltip: tooltip.to_owned(),
        });
    }

    pub(crate) fn line(&mut self, class: &str, from: Point, to: Point) {
        self.stroke(class, from, to, Style::default());
    }

    /// Draws a straight line with the style `own`.
    pub(crate) fn stroke(&mut self, class: &str, from: Point, to: Point, own: Style) {
        self.push(class, own, Form::Line(from, to), "");
    }

    /// Draws a line of text that starts at `point`.
    pub(crate) fn text(&mut self, class: &str, point: Point, content: &str) {
        self.words(class, point, TextAnchor::Start, content);
    }

    /// Draws a line of text that ends at `point`.
    pub(crate) fn text_before(&mut self, class: &str, point: Point, content: &str) {
        self.words(class, point, TextAnchor::End, content);
    }

    /// Draws a line of text centred at `point`.
    pub(crate) fn text_around(&mut self, class: &str, point: Point, content: &str) {
        self.words(class, point, TextAnchor::Middle, content);
    }

    fn words(&mut self, class: &str, point: Point, anchor: TextAnchor, content: &str) {
        let form = Form::Text(point, anchor, content.to_owned());
        self.push(class, Style::default(), form, "");
    }

    /// Breaks text into lines with a width of at most `most`, and draws them. `point` is the start
    /// of the first line. Returns the baseline after the last line.
    pub(crate) fn paragraph(&mut self, class: &str, point: Point, most: f64, content: &str) -> f64 {
        let mut y = point.1;
        for line in wrapped(content, most) {
            self.text(class, (point.0, y), &line);
            y += LINE;
        }
        y
    }

    /// Draws a marker at a point. A browser shows `tooltip` under the pointer.
    pub(crate) fn mark(
        &mut self,
        class: &str,
        marker: Marker,
        centre: Point,
        size: f64,
        tooltip: &str,
    ) {
        let own = match marker {
            Marker::Ring => Style {
                fill: Some(Paint::Nothing),
                ..Style::line(2.0)
            },
            _ => Style::default(),
        };
        self.push(class, own, marker.form(centre, size), tooltip);
    }

    /// Draws a rectangle from its upper left corner.
    pub(crate) fn rectangle(&mut self, class: &str, corner: Point, size: Point, tooltip: &str) {
        self.field(class, corner, size, Style::default(), tooltip);
    }

    /// Draws a rectangle with the style `own`.
    pub(crate) fn field(
        &mut self,
        class: &str,
        corner: Point,
        size: Point,
        own: Style,
        tooltip: &str,
    ) {
        let size = (size.0.max(0.0), size.1.max(0.0));
        self.push(class, own, Form::Rectangle(corner, size), tooltip);
    }

    /// Draws one of six kinds of hatching over a bar, so that bars differ not only by colour.
    pub(crate) fn hatch(&mut self, kind: usize, (x, y): (f64, f64), (width, height): (f64, f64)) {
        const APART: f64 = 6.0;
        let steps = |from: f64, to: f64| {
            let count = ((to - from) / APART).ceil().max(0.0) as usize;
            (0..count).map(move |i| from + APART * i as f64)
        };
        let mut lines: Vec<((f64, f64), (f64, f64))> = Vec::new();
        if matches!(kind % 6, 1 | 2 | 5) {
            for start in steps(-height, width) {
                // A line of the hatching runs from the left or bottom edge to the right or top
                // edge.
                let (first, last) = ((-start).max(0.0), height.min(width - start));
                let (left, right) = (x + start + first, x + start + last);
                if last > first && kind % 6 != 2 {
                    lines.push(((left, y + height - first), (right, y + height - last)));
                }
                if last > first && kind % 6 != 1 {
                    lines.push(((left, y + first), (right, y + last)));
                }
            }
        }
        if kind % 6 == 3 {
            lines.extend(steps(APART / 2.0, width).map(|at| ((x + at, y), (x + at, y + height))));
        }
        if kind % 6 == 4 {
            lines.extend(steps(APART / 2.0, height).map(|at| ((x, y + at), (x + width, y + at))));
        }
        for (from, to) in lines {
            self.line("hatch", from, to);
        }
    }

    /// Draws a disc. A browser shows `tooltip` under the pointer.
    pub(crate) fn disc(&mut self, class: &str, centre: Point, radius: f64, tooltip: &str) {
        self.push(class, Style::default(), Form::Disc(centre, radius), tooltip);
    }

    /// Draws a disc with the style `own`.
    pub(crate) fn spot(&mut self, centre: Point, radius: f64, own: Style) {
        self.push("", own, Form::Disc(centre, radius), "");
    }

    /// Draws a line through several points.
    pub(crate) fn curve(&mut self, class: &str, points: &[Point], dashes: &'static str) {
        let class = format!("curve {class}");
        self.push(
            &class,
            Style::default(),
            Form::Curve(points.to_vec(), dashes),
            "",
        );
    }

    /// Fills the area between several points.
    pub(crate) fn area(&mut self, class: &str, points: &[Point]) {
        let class = format!("band {class}");
        self.push(&class, Style::default(), Form::Area(points.to_vec()), "");
    }

    /// Fills an area with the style `own`.
    pub(crate) fn polygon(&mut self, points: &[Point], own: Style) {
        self.push("", own, Form::Area(points.to_vec()), "");
    }

    /// Draws a line of text centred at `point`, in the same colour on light and dark backgrounds.
    pub(crate) fn label(&mut self, point: Point, content: &str, colour: Rgb) {
        let form = Form::Text(point, TextAnchor::Middle, content.to_owned());
        self.push("", Style::area(colour), form, "");
    }

    /// Draws a legend in columns, up to the horizontal position `right`. `point` is the start of
    /// the first line of text. Returns the baseline after the last line.
    pub(crate) fn keys(&mut self, point: Point, right: f64, keys: &[LegendEntry]) -> f64 {
        const ROW: f64 = 19.0;
        const APART: f64 = 16.0;
        let sample = |key: &LegendEntry| match key.sample {
            LegendSymbol::Line(_) => 42.0,
            _ => 18.0,
        };
        let room = right - point.0;
        let widths = keys
            .iter()
            .map(|key| sample(key) + letters::width(&key.meaning) + APART);
        let column = widths.fold(1.0, f64::max).min(room);
        let columns = ((room + APART) / column).floor().max(1.0) as usize;
        for (i, key) in keys.iter().enumerate() {
            let x = point.0 + column * (i % columns) as f64;
            let y = point.1 + ROW * (i / columns) as f64;
            match key.sample {
                LegendSymbol::Bar(kind) => {
                    let (corner, size) = ((x, y - 10.0), (12.0, 12.0));
                    self.rectangle(&key.class, corner, size, "");
                    self.hatch(kind, corner, size);
                }
                LegendSymbol::Mark(marker) => {
                    self.mark(&key.class, marker, (x + 6.0, y - 4.0), 5.0, "")
                }
                LegendSymbol::Line(dashes) => {
                    self.curve(&key.class, &[(x, y - 4.0), (x + 34.0, y - 4.0)], dashes);
                }
            }
            let meaning = fitted(&key.meaning, column - sample(key));
            self.text("ink", (x + sample(key), y), &meaning);
        }
        point.1 + ROW * keys.len().div_ceil(columns) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_stay_within_their_bar_and_differ() {
        let mut kinds = Vec::new();
        for kind in 0..6 {
            let mut out = Drawing::new(Medium::Screen, "n", "t", "d");
            out.hatch(kind, (10.0, 20.0), (37.0, 15.0));
            for shape in &out.shapes {
                let Form::Line(from, to) = shape.form else {
                    panic!("{shape:?}");
                };
                for (x, y) in [from, to] {
                    let inside = (10.0..=47.0).contains(&x) && (20.0..=35.0).contains(&y);
                    assert!(inside, "{x} {y} of {kind}");
                }
            }
            assert_eq!(out.shapes.is_empty(), kind == 0);
            let drawn = format!("{:?}", out.shapes);
            assert!(!kinds.contains(&drawn), "{kind}");
            kinds.push(drawn);
        }
    }

    #[test]
    fn legends_use_the_available_columns() {
        let key = |meaning: &str| LegendEntry {
            class: "bar s0".into(),
            sample: LegendSymbol::Bar(0),
            meaning: meaning.into(),
        };
        let keys = ["one", "two", "three"].map(key);
        let mut out = Drawing::new(Medium::Screen, "n", "t", "d");
        assert_eq!(out.keys((0.0, 100.0), 300.0, &keys), 119.0);
        assert_eq!(out.keys((0.0, 100.0), 60.0, &keys), 157.0);
    }
}
