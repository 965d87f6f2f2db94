//! Widths of text in the embedded font. Helvetica and Arial have the same widths.
use std::sync::LazyLock;

use ttf_parser::Face;

use super::medium::TYPE;
use stochc_text::short;

/// Font file of Liberation Sans, unchanged.
pub(crate) const FONT: &[u8] = include_bytes!("../../fonts/LiberationSans-Regular.ttf");

/// The parsed font.
pub(crate) static FACE: LazyLock<Face<'static>> = LazyLock::new(|| {
    // A test parses the font.
    Face::parse(FONT, 0).expect("the included font is valid")
});

/// Returns the width of a line of text, in units of a drawing.
pub(crate) fn width(text: &str) -> f64 {
    // A character that the font lacks is assumed to be as wide as high.
    let widths = text.chars().map(|sign| advance(sign).unwrap_or(TYPE));
    widths.sum()
}

/// Returns the width of a line of text. Returns `None` if the text is empty or the font lacks one
/// of its characters.
pub(crate) fn known_width(text: &str) -> Option<f64> {
    let width: Option<f64> = text.chars().map(advance).sum();
    width.filter(|&width| width > 0.0)
}

/// Returns the width of a character. Returns `None` if the font lacks it.
fn advance(sign: char) -> Option<f64> {
    let glyph = FACE.glyph_index(sign)?;
    let width = f64::from(FACE.glyph_hor_advance(glyph)?);
    Some(TYPE * width / f64::from(FACE.units_per_em()))
}

/// Returns the width of the widest line.
pub(crate) fn widest<'a>(lines: impl IntoIterator<Item = &'a str>) -> f64 {
    lines.into_iter().map(width).fold(0.0, f64::max)
}

/// Shortens a name to a width by replacing its middle.
pub(crate) fn fitted(name: &str, most: f64) -> String {
    let whole = short(name, usize::MAX);
    if width(&whole) <= most {
        return whole;
    }
    let (mut fits, mut too_many) = (1, whole.chars().count());
    while fits + 1 < too_many {
        let letters = usize::midpoint(fits, too_many);
        if width(&short(name, letters)) <= most {
            fits = letters
        } else {
            too_many = letters
        }
    }
    short(name, fits)
}

/// Breaks text between words into lines of limited width. Shortens a word that is wider.
pub(crate) fn wrapped(text: &str, most: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    // Non-breaking spaces keep words together.
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        let longer = lines.last().map(|line| format!("{line} {word}"));
        match (longer, lines.last_mut()) {
            (Some(longer), Some(line)) if width(&longer) <= most => *line = longer,
            _ => lines.push(fitted(word, most)),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the widths of characters with the widths of Helvetica that Adobe published, in
    /// thousandths of the font size.
    #[test]
    fn the_font_has_the_widths_of_helvetica() {
        for (letter, thousandths) in [(' ', 278), ('a', 556), ('i', 222), ('M', 833), ('7', 556)] {
            let expected = TYPE * f64::from(thousandths) / 1000.0;
            let found = width(&letter.to_string());
            assert!((found - expected).abs() < 0.01, "{letter}: {found}");
        }
    }

    #[test]
    fn fitted_text_is_shortened_only_as_needed() {
        let name = "M.up -> a_rather_long_name_of_a_block";
        for most in [30.0, 60.0, 100.0, 150.0] {
            let found = fitted(name, most);
            assert!(width(&found) <= most, "{found}");
            assert!(
                found.contains('…') && width(&found) > most - 16.0,
                "{found}"
            );
        }
        assert_eq!(fitted("A.up -> B", 100.0), "A.up -> B");
        // Without any space, one character remains.
        assert_eq!(fitted("ABC", 0.0).chars().count(), 1);
    }

    #[test]
    fn wrapped_lines_fit_and_lose_no_word() {
        let text = "entries of blocks into the reach of the pull [number, logarithmic]";
        for most in [80.0, 200.0, 900.0] {
            let lines = wrapped(text, most);
            assert!(lines.iter().all(|line| width(line) <= most), "{lines:?}");
            assert_eq!(lines.join(" "), text);
        }
    }
}
