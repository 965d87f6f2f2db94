//! Separates code from comments and strings, in sources that may have syntax errors.
use std::ops::Range;

/// Kind of a part of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartKind {
    /// Neither comment nor string.
    Code,
    /// A comment or documentation, without the end of its line.
    Comment,
    /// A string with its quotation marks. A string without an end is cut at the end of its line.
    String {
        /// Whether the string has its second quotation mark.
        is_closed: bool,
    },
}

/// A part of a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Kind of the part.
    pub kind: PartKind,
    /// Bytes of the part.
    pub range: Range<usize>,
}

/// Returns the parts of a source. They are not empty, and together they are the whole source.
pub fn parts(text: &str) -> impl Iterator<Item = Part> + '_ {
    let mut at = 0;
    std::iter::from_fn(move || {
        let rest = text.get(at..).filter(|rest| !rest.is_empty())?;
        let (kind, length) = first(rest);
        let range = at..at + length;
        at = range.end;
        Some(Part { kind, range })
    })
}

/// Returns the position and text of each part of a source that is code.
pub fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let parts = parts(text).filter(|part| part.kind == PartKind::Code);
    parts.map(|part| (part.range.start, &text[part.range]))
}

/// Returns the kind and length of the first part of a text.
fn first(text: &str) -> (PartKind, usize) {
    let line = || text.find('\n').unwrap_or(text.len());
    if text.starts_with("//") {
        return (PartKind::Comment, line());
    }
    if let Some(content) = text.strip_prefix('"') {
        let end = content.find(['"', '\n']);
        let is_closed = end.is_some_and(|end| content[end..].starts_with('"'));
        let length = end.map_or(text.len(), |end| 1 + end + usize::from(is_closed));
        return (PartKind::String { is_closed }, length);
    }
    let is_end = |at: &usize| text[*at..].starts_with('"') || text[*at..].starts_with("//");
    let mut ends = text.match_indices(['"', '/']).map(|(at, _)| at);
    (PartKind::Code, ends.find(is_end).unwrap_or(text.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_and_comments_are_not_code() {
        let text = "a / b // \"c\nimport \"d//{\" e\nimport \"f\n/// g";
        let found: Vec<_> = parts(text)
            .map(|part| (part.kind, &text[part.range]))
            .collect();
        let string = |is_closed| PartKind::String { is_closed };
        let expected = [
            (PartKind::Code, "a / b "),
            (PartKind::Comment, "// \"c"),
            (PartKind::Code, "\nimport "),
            (string(true), "\"d//{\""),
            (PartKind::Code, " e\nimport "),
            (string(false), "\"f"),
            (PartKind::Code, "\n"),
            (PartKind::Comment, "/// g"),
        ];
        assert_eq!(found, expected);
        assert_eq!(
            code("{ \"}\" }").map(|(_, code)| code).collect::<String>(),
            "{  }"
        );
        assert_eq!(parts("").next(), None);
    }
}
