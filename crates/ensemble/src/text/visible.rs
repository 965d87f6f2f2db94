//! Text of others, shown as what it is.
pub use stochc_ir::visible;

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
