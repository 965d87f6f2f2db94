//! Ranges that can be folded: blocks and comments.
use gen_lsp_types::{FoldingRange, FoldingRangeKind};

/// Returns the blocks in braces and the comments of more than one line. The line of a closing
/// brace stays visible.
pub fn ranges(text: &str) -> Vec<FoldingRange> {
    let mut ranges = Vec::new();
    let mut braces = Vec::new();
    let mut comment = None;
    let mut last = 0;
    for (number, line) in text.lines().enumerate() {
        last = number;
        if line.trim_start().starts_with("//") {
            comment.get_or_insert(number);
            continue;
        }
        if let Some(first) = comment.take() {
            fold(
                first,
                number - 1,
                Some(FoldingRangeKind::Comment),
                &mut ranges,
            );
        }
        let mut is_string = false;
        let code = line.find("//").map_or(line, |at| &line[..at]);
        for byte in code.bytes() {
            match byte {
                b'"' => is_string = !is_string,
                b'{' if !is_string => braces.push(number),
                b'}' if !is_string => {
                    if let Some(first) = braces.pop() {
                        fold(first, number.saturating_sub(1), None, &mut ranges);
                    }
                }
                _ => {}
            }
        }
    }
    if let Some(first) = comment {
        fold(first, last, Some(FoldingRangeKind::Comment), &mut ranges);
    }
    ranges
}

fn fold(first: usize, last: usize, kind: Option<FoldingRangeKind>, out: &mut Vec<FoldingRange>) {
    if last > first {
        out.push(FoldingRange {
            start_line: first as u32,
            end_line: last as u32,
            kind,
            ..FoldingRange::default()
        });
    }
}
