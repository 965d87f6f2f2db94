//! Advice to pass an argument to a pattern.
use super::LONG;
use crate::Sources;
use crate::expanded::PatternInstance;

/// Returns the advice to pass `argument` to a pattern as a new parameter `name`.
pub(crate) fn parameter_hint(
    sources: &Sources,
    grown: &PatternInstance,
    name: &str,
    argument: &str,
) -> String {
    let declared = sources
        .file(grown.declared.file)
        .text
        .get(grown.declared.span.start as usize..);
    let header = declared.and_then(|text| {
        let end = text.bytes().take(LONG).position(|byte| byte == b')')?;
        one_more(&text[..=end], name)
    });
    let call = sources.text(grown.call).trim_end();
    let call = call.strip_suffix("as").map_or(call, str::trim_end);
    match header.zip(one_more(call, argument)) {
        Some((header, call)) => {
            format!("pass it as an argument: `pattern {header}` and `{call}`")
        }
        None => format!("add a parameter to the pattern and pass `{argument}`"),
    }
}

/// Returns a list in parentheses with one more entry. Returns `None` if the list is long or
/// contains a comment.
fn one_more(text: &str, entry: &str) -> Option<String> {
    const LONGEST: usize = 60;
    let list = text.strip_suffix(')')?;
    if text.len() > LONGEST || text.contains(['\n', '/']) {
        return None;
    }
    let comma = if list.trim_end().ends_with('(') {
        ""
    } else {
        ", "
    };
    Some(format!("{}{comma}{entry})", list.trim_end()))
}
