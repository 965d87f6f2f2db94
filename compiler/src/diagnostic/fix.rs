//! Changes of the source that fix diagnostics.
use stochc_text::suggest::Suggestion;

use super::{Edit, Fix};
use crate::{SourceLocation, Sources, Span};

impl Fix {
    /// Returns a safe fix that replaces the source at `location`.
    pub(crate) fn replace(
        location: SourceLocation,
        text: impl Into<String>,
        title: impl Into<String>,
    ) -> Fix {
        let text = text.into();
        Fix {
            title: title.into(),
            edits: vec![Edit { location, text }],
            safe: true,
        }
    }

    /// Returns a safe fix that removes the source at `location`.
    pub(crate) fn remove(location: SourceLocation, title: impl Into<String>) -> Fix {
        Fix::replace(location, "", title)
    }

    /// Returns a fix that replaces an unknown word by a known one. The fix is safe if only one
    /// known word is similar.
    pub(crate) fn word(location: SourceLocation, suggestion: &Suggestion) -> Fix {
        let title = format!("write `{}`", suggestion.word);
        Fix::replace(location, &suggestion.word, title).unsafe_if(!suggestion.clear)
    }

    #[must_use]
    pub(crate) fn unsafe_if(mut self, is_uncertain: bool) -> Fix {
        self.safe &= !is_uncertain;
        self
    }
}

/// Returns the range to remove with a statement: the surrounding space, or the whole line if it
/// contains only the statement.
pub(crate) fn removal(sources: &Sources, statement: SourceLocation) -> SourceLocation {
    let text = &sources.file(statement.file).text;
    let is_blank = |c: char| matches!(c, ' ' | '\t' | '\r');
    let (start, end) = (statement.span.start as usize, statement.span.end as usize);
    let (before, after) = (&text[..start], &text[end..]);
    let blanks_before = start - before.trim_end_matches(is_blank).len();
    let rest = after.trim_start_matches(is_blank);
    let blanks_after = after.len() - rest.len();
    let begins_line = before[..start - blanks_before].ends_with('\n') || start == blanks_before;
    let (start, end) = match rest.chars().next() {
        Some('\n') if begins_line => (start - blanks_before, end + blanks_after + 1),
        None if begins_line => (start - blanks_before, end + blanks_after),
        Some('\n' | '}' | '/') | None if !begins_line => (start - blanks_before, end),
        _ => (start, end + blanks_after),
    };
    SourceLocation {
        file: statement.file,
        span: Span::new(start as u32, end as u32),
    }
}

/// Returns the location of `name` at the start of `location`. Returns `None` if the source differs
/// there.
pub(crate) fn named(
    sources: &Sources,
    location: SourceLocation,
    name: &str,
) -> Option<SourceLocation> {
    let rest = sources.text(location).strip_prefix(name)?;
    let continues = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '[');
    let span = Span::new(location.span.start, location.span.start + name.len() as u32);
    (!rest.starts_with(continues)).then_some(SourceLocation { span, ..location })
}

/// Returns the location of `name` at the end of `location`. Returns `None` if the source differs
/// there.
pub(crate) fn last_named(
    sources: &Sources,
    location: SourceLocation,
    name: &str,
) -> Option<SourceLocation> {
    let before = sources.text(location).strip_suffix(name)?;
    let span = Span::new(location.span.start + before.len() as u32, location.span.end);
    let is_whole = before.ends_with(|c: char| c.is_whitespace() || c == '>');
    is_whole.then_some(SourceLocation { span, ..location })
}

/// Largest number of bytes that are searched in a line or inside braces. Bounds the work for long
/// ones.
pub(crate) const LONG: usize = 1 << 12;

/// Returns the range to remove with one entry of the list after `keyword`. It includes the comma
/// next to the entry, or the keyword if the entry is the only one.
///
/// Returns `None` if comments are in between, or if the removal would leave an `after` without a
/// statement.
pub(crate) fn entry(
    sources: &Sources,
    entry: SourceLocation,
    keyword: &str,
) -> Option<SourceLocation> {
    let text = &sources.file(entry.file).text;
    let (start, end) = (entry.span.start as usize, entry.span.end as usize);
    let location = |start: usize, end: usize| SourceLocation {
        span: Span::new(start as u32, end as u32),
        ..entry
    };
    let before = text[..start].trim_end();
    let line = before
        .bytes()
        .rev()
        .take(LONG)
        .take_while(|&byte| byte != b'\n');
    let length = line.count();
    if length == LONG || before.get(before.len() - length..)?.contains("//") {
        return None;
    }
    if let Some(rest) = before.strip_suffix(',') {
        return Some(location(rest.len(), end));
    }
    let word = before.strip_suffix(keyword)?.len();
    let after = text[end..].trim_start();
    if let Some(rest) = after.strip_prefix(',') {
        let rest = rest.trim_start_matches([' ', '\t']);
        return Some(location(start, text.len() - rest.len()));
    }
    let waits = keyword != "after" && after.starts_with("after");
    (!waits).then(|| removal(sources, location(word, end)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Removes the entry that is literally named `X` from a text.
    fn without(text: &str) -> String {
        let mut sources = Sources::default();
        let file = sources.add("a.sa", text);
        let at = text.find('X').unwrap_or(0) as u32;
        let location = SourceLocation {
            file,
            span: Span::new(at, at + 1),
        };
        let span = removal(&sources, location).span;
        format!(
            "{}{}",
            &text[..span.start as usize],
            &text[span.end as usize..]
        )
    }

    #[test]
    fn spaces_are_removed_with_a_statement() {
        for (before, after) in [
            ("a\n  X\n  b", "a\n  b"),
            ("a\n  X\r\nb", "a\nb"),
            ("{ X }", "{ }"),
            ("{ a  X }", "{ a }"),
            ("{ X  a }", "{ a }"),
            ("a X b", "a b"),
            ("  X  b", "  b"),
            ("a  X\nb", "a\nb"),
            ("a X // c", "a // c"),
            ("  X // c", "  // c"),
            ("X", ""),
            ("a\nX", "a\n"),
            ("{X}", "{}"),
        ] {
            assert_eq!(without(before), after, "{before:?}");
        }
    }
}
