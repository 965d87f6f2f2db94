//! Draws one layer of a structure as text.
use std::ops::RangeInclusive;

/// Returns the rows of a layer as text, with their y coordinates and the range of x. The
/// northernmost row comes first. `sign` returns the character of a cell.
pub fn layer_picture(
    x: RangeInclusive<i32>,
    y: RangeInclusive<i32>,
    sign: impl Fn(i32, i32) -> char,
) -> String {
    let mut text = String::new();
    for y in y.rev() {
        let signs: Vec<String> = x.clone().map(|x| sign(x, y).to_string()).collect();
        text.push_str(&format!("{}   (y = {y})\n", signs.join(" ")));
    }
    text.push_str(&format!("from x = {} to {}", x.start(), x.end()));
    text
}
