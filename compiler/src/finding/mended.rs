//! A text with the changes that mend findings.
use std::collections::BTreeMap;

use super::{Edit, Fix};
use crate::FileId;

/// The text of a file with every change that fits, and how many those are.
///
/// Changes of other files do not fit, nor those that overlap with an earlier one: once the text has
/// been checked again, they may be offered again.
pub fn mended<'a>(
    text: &str,
    file: FileId,
    fixes: impl IntoIterator<Item = &'a Fix>,
) -> (String, usize) {
    let mut count = 0;
    // By the first byte that goes: the one past the last, and what comes.
    let mut edits: BTreeMap<usize, (usize, &str)> = BTreeMap::new();
    for fix in fixes {
        let range = |edit: &Edit| (edit.site.span.start as usize, edit.site.span.end as usize);
        let mut put = Vec::new();
        let fits = fix.edits.iter().all(|edit| {
            let (start, end) = range(edit);
            let fits = edit.site.file == file
                && text.get(start..end).is_some()
                && is_free(&edits, start, end);
            if fits {
                edits.insert(start, (end, &edit.text));
                put.push(start);
            }
            fits
        });
        if fits {
            count += usize::from(!put.is_empty());
        } else {
            put.iter().for_each(|start| {
                edits.remove(start);
            });
        }
    }
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    for (start, (end, new)) in edits {
        out.push_str(&text[at..start]);
        out.push_str(new);
        at = end;
    }
    out.push_str(&text[at..]);
    (out, count)
}

/// Whether no change has been made to a part of the text.
fn is_free(edits: &BTreeMap<usize, (usize, &str)>, start: usize, end: usize) -> bool {
    let before = edits.range(..=start).next_back();
    let behind = edits.range(start..).next();
    before.is_none_or(|(&at, &(until, _))| until <= start && at != start)
        && behind.is_none_or(|(&at, _)| at >= end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Site, Span};

    fn fix(edits: &[(u32, u32, &str)]) -> Fix {
        let edits = edits.iter().map(|&(start, end, text)| Edit {
            site: Site {
                file: FileId(0),
                span: Span::new(start, end),
            },
            text: text.to_owned(),
        });
        Fix {
            title: String::new(),
            edits: edits.collect(),
            safe: true,
        }
    }

    #[test]
    fn the_first_of_two_overlapping_changes_counts() {
        let mended = |fixes: &[Fix]| mended("0123456789", FileId(0), fixes);
        assert_eq!(
            mended(&[fix(&[(1, 3, "a")]), fix(&[(2, 4, "b")])]),
            ("0a3456789".into(), 1)
        );
        assert_eq!(
            mended(&[fix(&[(2, 4, "b")]), fix(&[(1, 3, "a")])]),
            ("01b456789".into(), 1)
        );
        assert_eq!(
            mended(&[fix(&[(1, 3, "a")]), fix(&[(3, 4, "b")])]),
            ("0ab456789".into(), 2)
        );
        assert_eq!(
            mended(&[fix(&[(1, 1, "a")]), fix(&[(1, 1, "b")])]),
            ("0a123456789".into(), 1)
        );
        assert_eq!(
            mended(&[fix(&[(0, 10, "")]), fix(&[(5, 5, "b")])]),
            (String::new(), 1)
        );
    }

    #[test]
    fn a_change_is_made_as_a_whole_or_not_at_all() {
        let two = fix(&[(8, 9, "x"), (1, 2, "y")]);
        assert_eq!(
            mended("0123456789", FileId(0), &[fix(&[(1, 3, "a")]), two.clone()]),
            ("0a3456789".into(), 1)
        );
        assert_eq!(
            mended("0123456789", FileId(0), [&two]),
            ("0y234567x9".into(), 1)
        );
        assert_eq!(mended("012", FileId(0), [&two]), ("012".into(), 0));
        assert_eq!(
            mended("0123456789", FileId(1), [&two]),
            ("0123456789".into(), 0)
        );
        assert_eq!(
            mended("0µ2", FileId(0), &[fix(&[(2, 3, "x")])]),
            ("0µ2".into(), 0)
        );
    }
}
