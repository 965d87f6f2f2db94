//! Medium of a figure, which determines the size of the figure.
use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

/// Height of text, in units of a drawing.
pub(crate) const TYPE: f64 = 12.0;

/// Medium that a figure is laid out for. The height of text does not depend on the width.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Medium {
    /// Page in a browser, light or dark.
    #[default]
    Screen,
    /// Paper of a given width \[mm\]. Text has a height of [`Medium::POINTS`].
    Print(f64),
}

impl Medium {
    /// Height of text in print \[pt\].
    pub const POINTS: f64 = 7.0;
    /// Smallest and largest width of a figure in print \[mm\].
    const WIDTHS: (f64, f64) = (80.0, 300.0);

    /// Returns the number of points per unit of a drawing. On a screen, a unit is one pixel, which
    /// is three quarters of a point.
    pub(crate) fn unit(self) -> f64 {
        match self {
            Medium::Screen => 0.75,
            Medium::Print(_) => Medium::POINTS / TYPE,
        }
    }

    /// Returns the default width of a figure, in units.
    pub(crate) fn width(self) -> f64 {
        self.width_or(760.0)
    }

    /// Returns the width of a figure, in units. On a screen, this is `on_screen`.
    pub(crate) fn width_or(self, on_screen: f64) -> f64 {
        match self {
            Medium::Screen => on_screen,
            Medium::Print(width) => width / 25.4 * 72.0 / self.unit(),
        }
    }
}

/// Returns the height of a plot of this width, within limits that keep curves readable.
pub(crate) fn plot_height(width: f64) -> f64 {
    (0.39 * width).clamp(190.0, 330.0).round()
}

impl Display for Medium {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Medium::Screen => write!(out, "screen"),
            Medium::Print(width) => write!(out, "{width}mm"),
        }
    }
}

/// Error of parsing a medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InvalidMedium {
    /// The text does not have the form of a medium.
    #[error("give `screen`, or a width in print such as `89mm`")]
    Form,
    /// The width is outside of the limits.
    #[error("give a width from {}mm to {}mm", Medium::WIDTHS.0, Medium::WIDTHS.1)]
    Width,
}

impl FromStr for Medium {
    type Err = InvalidMedium;

    fn from_str(text: &str) -> Result<Medium, InvalidMedium> {
        if text == "screen" {
            return Ok(Medium::Screen);
        }
        let (least, most) = Medium::WIDTHS;
        let width = text.strip_suffix("mm").map(str::trim);
        let width: Option<f64> = width.and_then(|width| width.parse().ok());
        match width {
            Some(width) if (least..=most).contains(&width) => Ok(Medium::Print(width)),
            Some(_) => Err(InvalidMedium::Width),
            None => Err(InvalidMedium::Form),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_survive_a_round_trip() {
        for medium in [Medium::Screen, Medium::Print(89.0), Medium::Print(182.5)] {
            assert_eq!(medium.to_string().parse(), Ok(medium));
        }
        for wrong in ["", "89", "mm", "-89mm", "20mm", "1e9mm", "NaNmm", "89cm"] {
            assert!(wrong.parse::<Medium>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn printed_text_has_seven_points_at_any_width() {
        for width in [89.0, 183.0] {
            let medium = Medium::Print(width);
            assert!((TYPE * medium.unit() - 7.0).abs() < 1e-12);
            let points = medium.width() * medium.unit();
            assert!((points - width / 25.4 * 72.0).abs() < 1e-9);
        }
    }
}
