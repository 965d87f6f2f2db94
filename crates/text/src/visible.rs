//! Invisible characters in foreign texts.
use std::fmt::Write as _;

/// Returns whether a character controls terminals or browsers, changes the reading direction, is
/// invisible, or is forbidden in XML.
///
/// These are control characters and the code points that Unicode calls default ignorable.
pub fn is_invisible(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{AD}'
                | '\u{034F}'
                | '\u{061C}'
                | '\u{115F}'..='\u{1160}'
                | '\u{17B4}'..='\u{17B5}'
                | '\u{180B}'..='\u{180F}'
                | '\u{200B}'..='\u{200F}'
                | '\u{2028}'..='\u{202E}'
                | '\u{2060}'..='\u{206F}'
                | '\u{3164}'
                | '\u{FE00}'..='\u{FE0F}'
                | '\u{FEFF}'
                | '\u{FFA0}'
                | '\u{FFF0}'..='\u{FFFB}'
                | '\u{FFFE}'
                | '\u{FFFF}'
                | '\u{1BCA0}'..='\u{1BCA3}'
                | '\u{1D173}'..='\u{1D17A}'
                | '\u{E0000}'..='\u{E0FFF}'
        )
}

/// Returns the text with its invisible characters spelled out, such as `⟨U+202E⟩` for a change of
/// direction. The result has no hidden or reordered characters, and cannot end a line or a
/// document.
pub fn visible(text: &str) -> String {
    spelled_out(text, is_invisible)
}

/// Returns the text like [`visible`], but keeps line ends and tabs.
pub fn visible_lines(text: &str) -> String {
    spelled_out(text, |c| is_invisible(c) && !matches!(c, '\n' | '\t'))
}

/// Returns the [`visible`] text, escaped for any place in XML or HTML, including attributes.
pub fn escaped(text: &str) -> String {
    let text = visible(text).replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

fn spelled_out(text: &str, is_spelled_out: impl Fn(char) -> bool) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if is_spelled_out(c) {
            // Writing to a string cannot fail.
            let _ = write!(out, "⟨U+{:04X}⟩", u32::from(c));
        } else {
            out.push(c);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_text_is_only_text() {
        let hostile = "a\u{1b}[31m\u{202e}b\n\tc\u{ad}\u{e0041}\0";
        let end = "c⟨U+00AD⟩⟨U+E0041⟩⟨U+0000⟩";
        let begin = "a⟨U+001B⟩[31m⟨U+202E⟩b";
        assert_eq!(visible(hostile), format!("{begin}⟨U+000A⟩⟨U+0009⟩{end}"));
        assert_eq!(visible_lines(hostile), format!("{begin}\n\t{end}"));
        assert_eq!(visible("шум ∞ ✓ 한 é"), "шум ∞ ✓ 한 é");
    }

    #[test]
    fn hostile_text_is_only_text_in_html() {
        assert_eq!(
            escaped("a</script>\"'&\u{202e}b\u{1b}\0"),
            "a&lt;/script&gt;&quot;&#39;&amp;⟨U+202E⟩b⟨U+001B⟩⟨U+0000⟩"
        );
        assert_eq!(escaped("шум ∞ ✓"), "шум ∞ ✓");
    }
}
