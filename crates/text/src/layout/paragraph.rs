//! Wraps sentences into lines.
use crate::visible;

/// Non-breaking space in sentences. Names do not contain it.
const TIE: char = '~';

/// Breaks a sentence into lines of `width` characters. All lines except the first are indented. A
/// `~` becomes a non-breaking space. Invisible characters become visible.
pub fn paragraph(text: &str, width: usize) -> String {
    let mut out = String::new();
    let mut used = 0;
    for word in visible(text).split(' ') {
        let fits = used + 1 + word.chars().count() <= width;
        let gap = match (used, fits) {
            (0, _) => "",
            (_, true) => " ",
            (_, false) => {
                used = 0;
                "\n  "
            }
        };
        out += gap;
        out += &word.replace(TIE, " ");
        used += gap.trim_start_matches('\n').len() + word.chars().count();
    }
    out.push('\n');
    out
}
