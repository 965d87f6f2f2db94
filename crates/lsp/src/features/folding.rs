//! Ranges that can be folded: blocks and comments.
use gen_lsp_types::{FoldingRange, FoldingRangeKind};
use stochc_grammar::{PartKind, parts};

/// Returns the blocks in braces and the comments of more than one line. The line of a closing
/// brace stays visible.
pub fn ranges(text: &str) -> Vec<FoldingRange> {
    let mut ranges = Vec::new();
    let mut braces = Vec::new();
    let mut comment = Comment::default();
    let mut line = 0;
    let mut is_line_empty = true;
    for part in parts(text) {
        match part.kind {
            PartKind::Comment if is_line_empty => comment.add(line, &mut ranges),
            PartKind::Comment | PartKind::String { .. } => is_line_empty = false,
            PartKind::Code => {
                for byte in text[part.range].bytes() {
                    match byte {
                        b'{' => braces.push(line),
                        b'}' => {
                            if let Some(first) = braces.pop() {
                                fold(first, line.saturating_sub(1), None, &mut ranges);
                            }
                        }
                        _ => {}
                    }
                    line += usize::from(byte == b'\n');
                    is_line_empty = byte == b'\n' || is_line_empty && byte.is_ascii_whitespace();
                }
            }
        }
    }
    comment.end(&mut ranges);
    ranges
}

/// Lines of the last comment.
#[derive(Default)]
struct Comment(Option<(usize, usize)>);

impl Comment {
    /// Adds a line. A line that does not follow the last one begins another comment.
    fn add(&mut self, line: usize, ranges: &mut Vec<FoldingRange>) {
        match &mut self.0 {
            Some((_, last)) if *last + 1 == line => *last = line,
            _ => {
                self.end(ranges);
                self.0 = Some((line, line));
            }
        }
    }

    fn end(&mut self, ranges: &mut Vec<FoldingRange>) {
        if let Some((first, last)) = self.0.take() {
            fold(first, last, Some(FoldingRangeKind::Comment), ranges);
        }
    }
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
