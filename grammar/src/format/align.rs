//! Aligns seeds and trailing comments in columns.
use super::line::{FormattedLine, LineKind, SEAT_GAP, columns};
use super::{INDENT, WIDTH};

/// Columns between the longest code of a group of lines and the comments next to it.
const NOTE_GAP: usize = 3;

/// Returns the lines as text, with comments and the parts of lines aligned in columns.
pub fn write(mut lines: Vec<FormattedLine>) -> String {
    let mut start = 0;
    while start < lines.len() {
        let end = end_of(&lines, start, |line| line.kind == LineKind::Seats);
        align_seats(&mut lines[start..end]);
        start = end;
    }
    let mut out = String::new();
    let mut start = 0;
    while start < lines.len() {
        let is_code = |line: &FormattedLine| {
            matches!(
                line.kind,
                LineKind::Plain
                    | LineKind::Wrapped
                    | LineKind::Seats
                    | LineKind::Terms
                    | LineKind::Continued
            )
        };
        let end = end_of(&lines, start, is_code);
        write_group(&lines[start..end], &mut out);
        start = end;
    }
    out
}

/// Returns the end of a group of lines that begins at `start`.
fn end_of(
    lines: &[FormattedLine],
    start: usize,
    belongs: impl Fn(&FormattedLine) -> bool,
) -> usize {
    let first = &lines[start];
    let mut end = start + 1;
    while let Some(next) = lines.get(end) {
        let continues = next.kind == LineKind::Continued;
        let beside = belongs(first) && belongs(next) && next.depth == first.depth;
        if next.blank || !(continues || beside) {
            break;
        }
        end += 1;
    }
    end
}

/// Aligns seeds of consecutive lines in columns, if they fit.
fn align_seats(lines: &mut [FormattedLine]) {
    let mut widths: Vec<usize> = Vec::new();
    for line in lines.iter().filter(|line| line.kind == LineKind::Seats) {
        for (i, cell) in line.cells.iter().enumerate() {
            // The last cell of a line moves no other cell.
            let width = if i + 1 < line.cells.len() {
                columns(cell)
            } else {
                0
            };
            match widths.get_mut(i) {
                Some(widest) => *widest = width.max(*widest),
                None => widths.push(width),
            }
        }
    }
    let aligned = |cells: &[String], widths: &[usize]| {
        let mut code = String::new();
        for (i, cell) in cells.iter().enumerate() {
            code.push_str(cell);
            if i + 1 < cells.len() {
                pad(
                    &mut code,
                    widths[i].saturating_sub(columns(cell)) + SEAT_GAP,
                );
            }
        }
        code
    };
    let fits = lines.iter().all(|line| {
        INDENT * line.depth + columns(&aligned(&line.cells, &widths)) <= WIDTH
            || line.cells.len() < 2
    });
    if !fits {
        widths.fill(0);
    }
    for line in lines.iter_mut().filter(|line| line.kind == LineKind::Seats) {
        line.cells = vec![aligned(&line.cells, &widths)];
    }
}

fn write_group(lines: &[FormattedLine], out: &mut String) {
    // The continuation of a comment follows the others at any indentation.
    let leads = |line: &&FormattedLine| line.note.is_some() && line.kind != LineKind::Continued;
    let with_note = lines.iter().filter(leads);
    let column = with_note.map(FormattedLine::width).max().unwrap_or(0) + NOTE_GAP;
    for line in lines {
        if line.blank {
            out.push('\n');
        }
        let start = out.len();
        let code: usize = line.cells.iter().map(|cell| columns(cell)).sum();
        if code > 0 {
            pad(out, INDENT * line.depth);
        }
        out.extend(line.cells.iter().map(String::as_str));
        if let Some(note) = &line.note {
            match line.kind {
                LineKind::Comment => pad(out, INDENT * line.depth),
                _ => {
                    let written = columns(&out[start..]);
                    pad(out, column.saturating_sub(written));
                }
            }
            out.push_str(note);
        }
        out.push('\n');
    }
}

fn pad(out: &mut String, blanks: usize) {
    out.extend(std::iter::repeat_n(' ', blanks));
}
