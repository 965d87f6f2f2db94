//! Shapes that drawings consist of.
use super::style::Style;

/// Position or size, in units of the drawing. The second coordinate increases downwards.
pub(crate) type Point = (f64, f64);

/// Shape of a drawing, with its style.
#[derive(Clone, Debug)]
pub(crate) struct DrawnShape {
    /// Style classes, separated by spaces.
    pub class: String,
    /// Style of this shape, which overrides its classes.
    pub own: Style,
    pub form: Form,
    /// Text of the tooltip. Empty if there is none.
    pub tooltip: String,
}

/// Geometry of a shape.
#[derive(Clone, Debug)]
pub(crate) enum Form {
    Line(Point, Point),
    /// Line through points, with its dash pattern. The pattern of a solid line is empty.
    Curve(Vec<Point>, &'static str),
    Area(Vec<Point>),
    /// Rectangle: upper left corner and size.
    Rectangle(Point, Point),
    /// Disc: centre and radius.
    Disc(Point, f64),
    Text(Point, TextAnchor, String),
    /// Start of an axis. The shapes up to [`Form::AxisEnd`] are its line, its ticks and its label.
    PlotAxis,
    /// End of an axis.
    AxisEnd,
}

/// Horizontal position of a text relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TextAnchor {
    Start,
    Middle,
    End,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marker {
    Disc,
    /// Circle without fill.
    Ring,
    Square,
    Triangle,
    Diamond,
}

impl Marker {
    /// Returns the geometry of the marker, with a width of about `2 size`.
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
