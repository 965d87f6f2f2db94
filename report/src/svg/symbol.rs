//! Marks of points that are told apart by their shapes.

/// A shape around a point.
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
    /// The element, about `2 size` wide.
    pub fn element(self, (x, y): (f64, f64), size: f64) -> String {
        let m = size;
        let polygon = |corners: &[(f64, f64)]| {
            let corners = (corners.iter()).map(|(dx, dy)| format!("{:.1},{:.1}", x + dx, y + dy));
            format!(
                "<polygon points=\"{}\"/>",
                corners.collect::<Vec<_>>().join(" ")
            )
        };
        match self {
            Marker::Disc => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{m}\"/>"),
            Marker::Ring => format!(
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{m}\" fill=\"none\" stroke-width=\"2\"/>"
            ),
            Marker::Square => polygon(&[(-m, -m), (m, -m), (m, m), (-m, m)]),
            Marker::Triangle => {
                polygon(&[(0.0, -1.2 * m), (1.15 * m, 0.9 * m), (-1.15 * m, 0.9 * m)])
            }
            Marker::Diamond => polygon(&[
                (0.0, -1.4 * m),
                (1.4 * m, 0.0),
                (0.0, 1.4 * m),
                (-1.4 * m, 0.0),
            ]),
        }
    }
}
