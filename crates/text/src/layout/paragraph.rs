//! Sentences in lines.
use crate::visible;

/// Between words that belong together; no name has it.
const TIE: char = '~';

/// A sentence in lines of `width` characters, all but the first of them indented; it is not broken
/// at `~`, which becomes a space. What is invisible in it is shown.
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
