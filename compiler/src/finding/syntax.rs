//! The grammar's errors as findings.
use stochc_grammar::{
    MAX_DEPTH, MAX_ERRORS, MAX_STATEMENT, MAX_TERMS, SyntaxError, SyntaxErrorKind as K,
};

use super::{Code, Finding};
use crate::suggest::suggest;
use crate::{FileId, Site};

impl Finding {
    /// A finding for a place where a text is not a program.
    pub fn from_syntax(file: FileId, error: &SyntaxError) -> Finding {
        let site = Site {
            file,
            span: error.span,
        };
        match &error.kind {
            K::Unexpected {
                found,
                expected,
                behind,
            } => unexpected(site, found, expected, behind),
            K::Unclosed => Finding::new(Code::UnclosedBrace, "a block is not closed")
                .label(site, "opened here")
                .help("write `}` where the block ends"),
            K::Unopened => Finding::new(Code::StrayBrace, "a `}` without a block to close")
                .label(site, "nothing is open here")
                .help("remove it, or look for a block closed too early above"),
            K::Misplaced {
                what,
                within,
                belongs,
            } => Finding::new(
                Code::Misplaced,
                format!("{what} does not belong in {within}"),
            )
            .label(site, format!("{what}, in {within}"))
            .help(match *within {
                // Where one stands in the other, the first has probably been left open.
                "a phase" | "a seed plate"
                    if what.starts_with("a phase") || what.starts_with("a seed plate") =>
                {
                    format!("it belongs in {belongs}: is the `}}` of {within} missing before it?")
                }
                _ => format!("it belongs in {belongs}"),
            }),
            K::ReservedWord { word } => Finding::new(
                Code::ReservedWord,
                format!("`{word}` is a word of the language"),
            )
            .label(site, "used as a name")
            .help(format!("choose another name, such as `{word}_1`")),
            K::FaceMisused { hint } => {
                Finding::new(Code::FaceMisused, "a face does not fit here").label(site, *hint)
            }
            K::NumberTooLarge => Finding::new(Code::NumberTooLarge, "a number is too large")
                .label(site, "too many digits")
                .help("whole numbers have 64 bits; values of a scene are double precision"),
            K::TooDeep => Finding::new(
                Code::TooDeep,
                format!("nested more than {MAX_DEPTH} levels deep"),
            )
            .label(site, "one level too many")
            .help("move the inner part into a pattern or a `let`"),
            K::TooManyTerms => Finding::new(
                Code::TooDeep,
                format!("an expression of more than {MAX_TERMS} numbers and names"),
            )
            .label(site, "too many to work out at once")
            .help("name a part of it with a `let`"),
            K::StatementTooLong => Finding::new(
                Code::StatementTooLong,
                format!("a statement of more than {MAX_STATEMENT} bytes"),
            )
            .label(site, "begins here")
            .help("break it up: a chain may go on in the next statement with its last block"),
            K::MissingReason => Finding::new(Code::MissingReason, "no reason is given")
                .label(site, "why?")
                .help("say in quotation marks why: `allow unused-seed \"it marks the corner\"`"),
            K::DanglingDoc => Finding::new(Code::DanglingDoc, "a `///` comment with nothing below")
                .label(site, "belongs to nothing")
                .help("use `//` for a free comment"),
            K::TooMany => Finding::new(
                Code::TooManyErrors,
                format!("more than {MAX_ERRORS} errors; the rest of the file was not read"),
            )
            .label(site, "reading stopped here")
            .help("mend the errors above first"),
            K::FileTooLarge => Finding::new(Code::FileTooLarge, "a file of 4 GiB or more")
                .help("split it into several files and `import` them"),
        }
    }
}

fn unexpected(site: Site, found: &str, expected: &[&str], behind: &str) -> Finding {
    if found.starts_with('\u{feff}') {
        return Finding::new(Code::Syntax, "a byte-order mark")
            .label(site, "an invisible sign of three bytes")
            .help("save the file as UTF-8 without a byte-order mark");
    }
    let list = alternatives(expected);
    let shown = match found {
        "" => "the end of the file".to_owned(),
        word => format!("`{}`", visible(word)),
    };
    let title = match list.as_str() {
        "" => format!("did not expect {shown}"),
        list => format!("expected {list}, found {shown}"),
    };
    let label = if expected.is_empty() {
        "not part of the language"
    } else {
        "here"
    };
    let finding = Finding::new(Code::Syntax, title).label(site, label);
    match advice(found, expected, behind) {
        Some(help) => finding.help(help),
        None => finding,
    }
}

/// What to do about the most frequent slips.
fn advice(found: &str, expected: &[&str], behind: &str) -> Option<String> {
    /// Words that begin something.
    const FIRST: [&str; 12] = [
        "assembly", "for", "import", "layer", "let", "pattern", "phase", "release", "scene",
        "seed", "shape", "yields",
    ];
    let is_expected = |sign: &str| expected.contains(&sign);
    if is_expected("`->`") && !behind.is_empty() && !FIRST.contains(&behind) {
        return Some(suggest(behind, FIRST).unwrap_or_else(|| {
            let behind = visible(behind);
            format!("`{behind}` alone is no statement: is a comma or a brace missing before it?")
        }));
    }
    let help = match found {
        ";" => "remove it: nothing stands between two statements",
        "/" => "a comment runs from `//` to the end of its line",
        "#" if !is_expected("a row of `#` and `.`") => {
            "a comment runs from `//` to the end of its line"
        }
        "\"" | "'" => "a file name stands between two `\"`, in one line",
        "=" | "-" | "\u{2192}" | "\u{2013}" | "\u{2014}" if is_expected("`->`") => {
            "an arrow is written `->`, and `->>` for a row of blocks"
        }
        _ => return None,
    };
    Some(help.to_owned())
}

/// Spells out what would not be seen, such as a character without width.
fn visible(word: &str) -> String {
    let mut text = String::new();
    for c in word.chars() {
        match c {
            '\'' | '"' | '\\' => text.push(c),
            _ => text.extend(c.escape_debug()),
        }
    }
    text
}

/// `a`, `a or b`, `a, b or c`.
pub(super) fn alternatives(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [init @ .., last] => format!("{} or {last}", init.join(", ")),
    }
}
