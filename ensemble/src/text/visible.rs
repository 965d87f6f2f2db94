//! Text of others, shown as what it is.
use std::fmt::Write as _;

use stochc_ir::is_invisible;

/// The text with its invisible signs spelled out, such as `⟨U+202E⟩` for one that turns the
/// direction of reading: nothing in it can look like something else, or end a document.
pub fn visible(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for sign in text.chars() {
        if is_invisible(sign) {
            // Writing to a string cannot fail.
            let _ = write!(out, "⟨U+{:04X}⟩", u32::from(sign));
        } else {
            out.push(sign);
        }
    }
    out
}

/// [`visible`] text as it may stand anywhere in XML or HTML, in attributes too.
pub fn escaped(text: &str) -> String {
    let text = visible(text).replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_text_is_only_text() {
        assert_eq!(
            escaped("a</script>\"'&\u{202e}b\u{1b}\0"),
            "a&lt;/script&gt;&quot;&#39;&amp;⟨U+202E⟩b⟨U+001B⟩⟨U+0000⟩"
        );
        assert_eq!(escaped("шум ∞ ✓"), "шум ∞ ✓");
    }
}
