//! Graphical elements of drawings.
use super::style::Style;

/// A position or size, in units of the drawing. Positive is down.
pub(crate) type Point = (f64, f64);

/// A shape of a drawing.
#[derive(Clone, Debug)]
pub(crate) struct DrawnShape {
    /// Classes of its style, separated by spaces.
    pub class: String,
    /// Own style, which takes precedence over the classes.
    pub own: Style,
    pub form: Form,
    /// Tooltip text. Empty if there is none.
    pub tooltip: String,
}

/// Geometry of a shape.
#[derive(Clone, Debug)]
pub(crate) enum Form {
    Line(Point, Point),
    /// A line through points, with its dash pattern. Empty: a solid line.
    Curve(Vec<Point>, &'static str),
    /// An area between points.
    Area(Vec<Point>),
    /// A rectangle: upper left corner and size.
    Rectangle(Point, Point),
    /// A disc: centre and radius.
    Disc(Point, f64),
    /// A line of text.
    Text(Point, TextAnchor, String),
    /// Start of an axis. The shapes up to its end are its line, its ticks, and its name with the
    /// unit.
    PlotAxis,
    /// End of an axis.
    AxisEnd,
}

/// Horizontal position of a text relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TextAnchor {
    /// The text begins at the point.
    Start,
    /// The text is centred at the point.
    Middle,
    /// The text ends at the point.
    End,
}

/// Shape of a marker at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marker {
    Disc,
    /// A circle without fill.
    Ring,
    Square,
    Triangle,
    Diamond,
}

impl Marker {
    /// Returns the geometry, about `2 size` wide.
    pub fn form(self, (x, y): Point, size: f64) -> Form {
        let m = size;
        let corners = |corners: &[Point]| {
            Form::Area(corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect())
        };
        match self {
            Marker::Disc | Marker::Ring => Form::Disc((x, y), m),
            Marker::Square => corners(&[(-m, -m), (m, -m), (m, m), (-m, m)]),
            Marker::Triangle => {
                corners(&[(0.0, -1.2 * m), (1.15 * m, 0.9 * m), (-1.15 * m, 0.9 * m)])
            }
            Marker::Diamond => corners(&[
                (0.0, -1.4 * m),
                (1.4 * m, 0.0),
                (0.0, 1.4 * m),
                (-1.4 * m, 0.0),
            ]),
        }
    }
}
