//! Safe embedding of text from files in a page.
use std::fmt::Write as _;

/// Returns JSON for a script element. The JSON cannot end the element and contains no line breaks.
pub(super) fn json(value: &serde_json::Value) -> String {
    let mut safe = String::new();
    // In JSON, these characters occur only in strings.
    for c in value.to_string().chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                let _ = write!(safe, "\\u{:04x}", u32::from(c));
            }
            _ => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_cannot_end_its_element() {
        let value = serde_json::json!({ "a": "</script><!--\u{2028}&\"'" });
        let text = json(&value);
        assert!(!text.contains(['<', '>', '&', '\u{2028}']), "{text}");
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(&text).unwrap(),
            value
        );
    }
}
