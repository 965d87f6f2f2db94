//! A picture with a name, a title, and words for those who cannot see it.
use std::fmt::Write as _;

use stochc_ensemble::text::{escaped, number};

use super::element::{line, text};
use super::{Marker, STYLE, Scale};

/// A picture that grows; lengths are in its own units, of which a letter is about 7 wide.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Its file, without `.svg`; letters, digits and `-`.
    pub name: String,
    /// In a few words.
    pub title: String,
    /// What there is to see in it.
    pub description: String,
    size: (f64, f64),
    body: String,
}

/// Height of letters.
const LETTERS: f64 = 12.0;

impl Drawing {
    /// An empty picture of `width` x `height`.
    pub(crate) fn new(name: &str, title: &str, description: &str, size: (f64, f64)) -> Drawing {
        Drawing {
            name: name.to_owned(),
            title: title.to_owned(),
            description: description.to_owned(),
            size,
            body: String::new(),
        }
    }

    /// As a file of its own.
    pub fn file(&self) -> String {
        let rest = format!(
            "<style>{}</style>\n<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n{}",
            *STYLE, self.body
        );
        self.element("xmlns=\"http://www.w3.org/2000/svg\" ", "", &rest)
    }

    /// As a part of a page, which brings [`STYLE`]; `prefix` keeps its names apart from those of
    /// other pictures.
    pub(crate) fn inline(&self, prefix: &str) -> String {
        self.element("", prefix, &self.body)
    }

    fn element(&self, more: &str, prefix: &str, content: &str) -> String {
        let (width, height) = self.size;
        let name = format!("{prefix}{}", self.name);
        format!(
            "<svg {more}viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
             height=\"{height:.0}\" \
             font-family=\"Helvetica, Arial, sans-serif\" font-size=\"{LETTERS}\" role=\"img\" \
             aria-labelledby=\"{name}-title {name}-description\">\n\
             <title id=\"{name}-title\">{}</title>\n\
             <desc id=\"{name}-description\">{}</desc>\n{content}</svg>\n",
            escaped(&self.title),
            escaped(&self.description),
        )
    }

    /// A straight line.
    pub(crate) fn line(&mut self, class: &str, from: (f64, f64), to: (f64, f64), more: &str) {
        line(&mut self.body, class, from, to, more);
    }

    /// A line of text that begins at `place`.
    pub(crate) fn text(&mut self, class: &str, place: (f64, f64), content: &str) {
        text(&mut self.body, class, place, "", content);
    }

    /// A line of text that ends at `place`.
    pub(crate) fn text_before(&mut self, class: &str, place: (f64, f64), content: &str) {
        text(&mut self.body, class, place, "text-anchor=\"end\"", content);
    }

    /// A line of text around `place`.
    pub(crate) fn text_around(&mut self, class: &str, place: (f64, f64), content: &str) {
        text(
            &mut self.body,
            class,
            place,
            "text-anchor=\"middle\"",
            content,
        );
    }

    /// A line of text around `place`, upwards.
    pub(crate) fn text_upward(&mut self, class: &str, (x, y): (f64, f64), content: &str) {
        let more = format!("text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\"");
        text(&mut self.body, class, (x, y), &more, content);
    }

    /// A mark at a point; `told` is what a pointer over it shows.
    pub(crate) fn mark(
        &mut self,
        class: &str,
        symbol: Marker,
        centre: (f64, f64),
        size: f64,
        told: &str,
    ) {
        let title = match told {
            "" => String::new(),
            _ => format!("<title>{}</title>", escaped(told)),
        };
        let element = symbol.element(centre, size);
        let _ = writeln!(self.body, "<g class=\"{class}\">{title}{element}</g>");
    }

    /// A rectangle, from its upper left corner.
    pub(crate) fn rectangle(
        &mut self,
        class: &str,
        corner: (f64, f64),
        size: (f64, f64),
        told: &str,
    ) {
        let shape = format!(
            "<rect class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"",
            corner.0,
            corner.1,
            size.0.max(0.0),
            size.1
        );
        self.shape(&shape, "rect", told);
    }

    /// Strokes over a bar, of one of six kinds, so that colour is not the only difference.
    pub(crate) fn hatch(&mut self, kind: usize, (x, y): (f64, f64), (width, height): (f64, f64)) {
        const APART: f64 = 6.0;
        let steps = |from: f64, to: f64| {
            let count = ((to - from) / APART).ceil().max(0.0) as usize;
            (0..count).map(move |i| from + APART * i as f64)
        };
        let mut lines: Vec<((f64, f64), (f64, f64))> = Vec::new();
        if matches!(kind % 6, 1 | 2 | 5) {
            for start in steps(-height, width) {
                // From the left edge, or the bottom, as far as the right edge, or the top.
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
            self.line("hatch", from, to, "");
        }
    }

    /// A field of some strength, 0 to 1, from its upper left corner.
    pub(crate) fn shade(
        &mut self,
        class: &str,
        corner: (f64, f64),
        size: (f64, f64),
        strength: f64,
        told: &str,
    ) {
        let shape = format!(
            "<rect class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" \
             stroke-opacity=\"0.4\" fill-opacity=\"{strength:.2}\"",
            corner.0, corner.1, size.0, size.1
        );
        self.shape(&shape, "rect", told);
    }

    /// A disc; `told` is what a pointer over it shows.
    pub(crate) fn disc(&mut self, class: &str, centre: (f64, f64), radius: f64, told: &str) {
        let shape = format!(
            "<circle class=\"{class}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\"",
            centre.0, centre.1
        );
        self.shape(&shape, "circle", told);
    }

    fn shape(&mut self, shape: &str, element: &str, told: &str) {
        // Writing to a string cannot fail.
        let _ = match told {
            "" => writeln!(self.body, "{shape}/>"),
            _ => writeln!(
                self.body,
                "{shape}><title>{}</title></{element}>",
                escaped(told)
            ),
        };
    }

    /// A line through points.
    pub(crate) fn curve(&mut self, class: &str, points: &[(f64, f64)], dashes: &str) {
        let dashes = match dashes {
            "" => String::new(),
            _ => format!(" stroke-dasharray=\"{dashes}\""),
        };
        let points = joined(points);
        let _ = writeln!(
            self.body,
            "<polyline class=\"curve {class}\" fill=\"none\" points=\"{points}\"{dashes}/>"
        );
    }

    /// An area between points.
    pub(crate) fn area(&mut self, class: &str, points: &[(f64, f64)]) {
        let points = joined(points);
        let _ = writeln!(
            self.body,
            "<polygon class=\"band {class}\" points=\"{points}\"/>"
        );
    }

    /// A horizontal axis at height `y` with lines up to `top`, and what it shows.
    pub(crate) fn across(
        &mut self,
        scale: &Scale,
        (left, right): (f64, f64),
        y: f64,
        top: f64,
        of: &str,
    ) {
        for tick in scale.ticks(6) {
            let x = scale.at(tick);
            self.line("grid", (x, top), (x, y), "");
            self.text_around("dim", (x, y + 17.0), &number(tick));
        }
        self.line("axis", (left, y), (right, y), "");
        self.text_around("ink", ((left + right) / 2.0, y + 36.0), of);
    }

    /// A vertical axis at `x` with lines up to `right`, and above it what it shows.
    pub(crate) fn upward(
        &mut self,
        scale: &Scale,
        (bottom, top): (f64, f64),
        x: f64,
        right: f64,
        of: &str,
        label: impl Fn(f64) -> String,
    ) {
        for tick in scale.ticks(5) {
            let y = scale.at(tick);
            self.line("grid", (x, y), (right, y), "");
            self.text_before("dim", (x - 7.0, y + 4.0), &label(tick));
        }
        self.line("axis", (x, bottom), (x, top), "");
        self.text("ink", (8.0, top - 12.0), of);
    }
}

fn joined(points: &[(f64, f64)]) -> String {
    let points = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}"));
    points.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_stay_within_their_bar_and_differ() {
        let mut kinds = Vec::new();
        for kind in 0..6 {
            let mut out = Drawing::new("n", "t", "d", (100.0, 100.0));
            out.hatch(kind, (10.0, 20.0), (37.0, 15.0));
            for part in out.body.split_whitespace() {
                let Some((axis, value)) = part.split_once("=\"") else {
                    continue;
                };
                let Ok(value) = value.trim_end_matches('"').parse::<f64>() else {
                    continue;
                };
                let ends = if axis.starts_with('x') {
                    10.0..=47.0
                } else {
                    20.0..=35.0
                };
                assert!(ends.contains(&value), "{part} of {kind}");
            }
            assert_eq!(out.body.is_empty(), kind == 0);
            assert!(!kinds.contains(&out.body), "{kind}");
            kinds.push(out.body);
        }
    }
}
