//! Conversion of a drawing to SVG.
use std::fmt::Write as _;

use stochc_text::escaped;

use super::drawing::Drawing;
use super::letters::known_width;
use super::medium::{Medium, TYPE};
use super::shape::{DrawnShape, Form, TextAnchor};
use super::style::stylesheet;

impl Drawing {
    /// Returns the drawing as the content of an SVG file.
    pub fn file(&self) -> String {
        let rest = format!(
            "<style>{}</style>\n<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n{}",
            stylesheet(self.medium),
            self.body()
        );
        self.element("xmlns=\"http://www.w3.org/2000/svg\" ", "", &rest)
    }

    /// Returns the drawing as an SVG element of an HTML page. The page must provide the styles.
    /// `prefix` makes the identifiers in the element unique on the page.
    pub(crate) fn inline(&self, prefix: &str) -> String {
        self.element("", prefix, &self.body())
    }

    fn element(&self, more: &str, prefix: &str, content: &str) -> String {
        let (width, height) = self.size();
        let name = format!("{prefix}{}", self.name);
        // In print, lengths are in points, and text is smaller.
        let (size, unit) = match self.medium {
            Medium::Screen => (
                format!(
                    "viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\""
                ),
                String::new(),
            ),
            Medium::Print(wide) => {
                let unit = self.medium.unit();
                let (width, height) = (unit * width, unit * height);
                let high = height / 72.0 * 25.4;
                (
                    format!(
                        "viewBox=\"0 0 {width:.2} {height:.2}\" width=\"{wide}mm\" height=\"{high:.2}mm\""
                    ),
                    format!(" transform=\"scale({unit:.6})\""),
                )
            }
        };
        format!(
            "<svg {more}{size} \
             font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\" font-size=\"{TYPE}\" role=\"img\" \
             aria-labelledby=\"{name}-title {name}-description\">\n\
             <title id=\"{name}-title\">{}</title>\n\
             <desc id=\"{name}-description\">{}</desc>\n<g{unit}>\n{content}</g>\n</svg>\n",
            escaped(&self.title),
            escaped(&self.description),
        )
    }

    fn body(&self) -> String {
        self.shapes().iter().fold(String::new(), |mut out, shape| {
            write(&mut out, shape);
            out
        })
    }
}

/// Writes the SVG element of a shape, then a line break.
fn write(out: &mut String, shape: &DrawnShape) {
    // Attributes have less weight than class rules, and more than inherited values.
    let own = shape.own.attributes();
    let (group, end, class) = if own.is_empty() {
        (String::new(), "", format!("class=\"{}\"", shape.class))
    } else {
        (
            format!("<g class=\"{}\">", shape.class),
            "</g>",
            own.trim_start().to_owned(),
        )
    };
    let (name, attributes) = match &shape.form {
        Form::Line(from, to) => (
            "line",
            format!(
                "{class} x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\"",
                from.0, from.1, to.0, to.1
            ),
        ),
        Form::Curve(points, dashes) => {
            let dashes = match *dashes {
                "" => String::new(),
                dashes => format!(" stroke-dasharray=\"{dashes}\""),
            };
            (
                "polyline",
                format!("{class} points=\"{}\"{dashes}", joined(points)),
            )
        }
        Form::Area(points) => ("polygon", format!("{class} points=\"{}\"", joined(points))),
        Form::Rectangle((x, y), (width, height)) => (
            "rect",
            format!(
                "{class} x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\""
            ),
        ),
        Form::Disc((x, y), radius) => (
            "circle",
            format!("{class} cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\""),
        ),
        Form::Text((x, y), anchor, content) => {
            let more = match anchor {
                TextAnchor::Start => "",
                TextAnchor::Middle => " text-anchor=\"middle\"",
                TextAnchor::End => " text-anchor=\"end\"",
            };
            // A fallback font such as DejaVu Sans has wider characters. Fit its text to the same
            // width.
            let room = known_width(content).map(|width| {
                format!(" textLength=\"{width:.1}\" lengthAdjust=\"spacingAndGlyphs\"")
            });
            let room = room.unwrap_or_default();
            // Writing to a string cannot fail.
            let _ = writeln!(
                out,
                "<text {class} x=\"{x:.1}\" y=\"{y:.1}\"{more}{room}>{}</text>",
                escaped(content)
            );
            return;
        }
        Form::PlotAxis => {
            *out += "<g class=\"of\">\n";
            return;
        }
        Form::AxisEnd => {
            *out += "</g>\n";
            return;
        }
    };
    let _ = match &*shape.tooltip {
        "" => writeln!(out, "{group}<{name} {attributes}/>{end}"),
        tooltip => writeln!(
            out,
            "{group}<{name} {attributes}><title>{}</title></{name}>{end}",
            escaped(tooltip)
        ),
    };
}

fn joined(points: &[(f64, f64)]) -> String {
    let points = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}"));
    points.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::letters::width;

    #[test]
    fn text_has_its_layout_width_in_any_font() {
        let mut drawing = Drawing::new(Medium::Screen, "name", "Title", "Description");
        let long = "serial, agitation.speed=0.4 m/s, free=600";
        drawing.text("ink", (10.0, 20.0), long);
        let file = drawing.file();
        let length = format!("textLength=\"{:.1}\" lengthAdjust", width(long));
        assert!(file.contains(&length), "{file}");
        // The width of these texts is unknown.
        for unknown in ["", "\u{5854}"] {
            let mut drawing = Drawing::new(Medium::Screen, "name", "Title", "Description");
            drawing.text("ink", (10.0, 20.0), unknown);
            assert!(!drawing.file().contains("textLength"), "{unknown}");
        }
    }
}
