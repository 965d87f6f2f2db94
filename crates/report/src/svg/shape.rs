//! What pictures are made of.
use super::style::Style;

/// A place, or a size, in units of the drawing; down is positive.
pub(crate) type Point = (f64, f64);

/// A part of a picture.
#[derive(Clone, Debug)]
pub(crate) struct DrawnShape {
    /// Classes of its style, with blanks between them.
    pub class: String,
    /// What counts before them.
    pub own: Style,
    pub form: Form,
    /// What a pointer over it shows; empty: nothing.
    pub tooltip: String,
}

/// The form of a part.
#[derive(Clone, Debug)]
pub(crate) enum Form {
    Line(Point, Point),
    /// A line through places, in dashes: their lengths, empty for none.
    Curve(Vec<Point>, &'static str),
    /// An area between places.
    Area(Vec<Point>),
    /// From its upper left corner, so wide and so high.
    Rectangle(Point, Point),
    /// Around a centre.
    Disc(Point, f64),
    /// A line of text.
    Text(Point, TextAnchor, String),
    /// An axis begins: what follows as far as its end is its line, its marks, and its name with its unit.
    PlotAxis,
    /// It ends.
    AxisEnd,
}

/// Where a line of text is, as seen from its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TextAnchor {
    /// It begins there.
    Start,
    /// It is around it.
    Middle,
    /// It ends there.
    End,
}

/// A mark around a point, told apart by its shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marker {
    Disc,
    /// A disc that is not filled.
    Ring,
    Square,
    Triangle,
    Diamond,
}

impl Marker {
    /// The form, about `2 size` wide.
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
