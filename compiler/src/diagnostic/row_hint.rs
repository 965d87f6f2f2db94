//! Suggests a row of blocks instead of a loop whose rounds all capture with the same face.
use super::{Fix, LONG};
use crate::{SourceLocation, Sources, Span};

/// Returns the row that a loop with one capture probably means, and the change that writes it.
///
/// `for i in 1..3 { A.up -> L[i] }` becomes `A.up ->> L[1..3]`. Returns `None` for any other loop.
pub(crate) fn row_hint(sources: &Sources, capture: SourceLocation) -> Option<(String, Fix)> {
    let text = &*sources.file(capture.file).text;
    let (start, end) = (capture.span.start as usize, capture.span.end as usize);
    let head = text[..start].trim_end().strip_suffix('{')?;
    let line = head
        .char_indices()
        .rev()
        .take(LONG)
        .find(|&(_, c)| c == '\n');
    let line = line.map_or(0, |(at, _)| at + 1);
    let word = line + head.get(line..)?.rfind("for ")?;
    let (counter, range) = head[word..].strip_prefix("for ")?.split_once(" in ")?;
    let (counter, range) = (counter.trim(), range.trim());
    let behind = text[end..].trim_start();
    let close = text.len() - behind.len();
    let (parent, child) = text[start..end].split_once("->")?;
    let name = child.trim().strip_suffix(&format!("[{counter}]"))?;
    let is_plain = |text: &str| {
        text.bytes()
            .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
    };
    let is_row = behind.starts_with('}') && range.contains("..") && !range.contains(['{', '}']);
    if !is_row || !is_plain(name) || !is_plain(counter) || parent.contains('[') {
        return None;
    }
    let row = format!("{} ->> {name}[{range}]", parent.trim());
    let span = Span::new(word as u32, close as u32 + 1);
    let location = SourceLocation { span, ..capture };
    let fix = Fix::replace(location, &row, format!("write `{row}`")).unsafe_if(true);
    Some((row, fix))
}
