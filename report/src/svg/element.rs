//! The two things that every picture is made of.
use std::fmt::Write as _;

use stochc_ensemble::text::escaped;

/// A straight line; `more` are further attributes.
pub(crate) fn line(out: &mut String, class: &str, from: (f64, f64), to: (f64, f64), more: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "<line class=\"{class}\" x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" {more}/>",
        from.0, from.1, to.0, to.1
    );
}

/// A line of text, which may hold anything; `more` are further attributes.
pub(crate) fn text(out: &mut String, class: &str, place: (f64, f64), more: &str, content: &str) {
    let _ = writeln!(
        out,
        "<text class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" {more}>{}</text>",
        place.0,
        place.1,
        escaped(content)
    );
}
