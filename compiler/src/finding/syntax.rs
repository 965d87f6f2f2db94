//! The grammar's errors as findings.
use stochc_grammar::{
    MAX_DEPTH, MAX_ERRORS, MAX_STATEMENT, MAX_TERMS, SyntaxError, SyntaxErrorKind as K,
};

use super::{Code, Finding};
use crate::{FileId, Site};

impl Finding {
    /// A finding for a place where a text is not a program.
    pub fn from_syntax(file: FileId, error: &SyntaxError) -> Finding {
        let site = Site {
            file,
            span: error.span,
        };
        match &error.kind {
            K::Unexpected { found, expected } => unexpected(site, found, expected),
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
            .help(format!("it belongs in {belongs}")),
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

fn unexpected(site: Site, found: &str, expected: &[&str]) -> Finding {
    if found.starts_with('\u{feff}') {
        return Finding::new(Code::Syntax, "a byte-order mark")
            .label(site, "an invisible sign of three bytes")
            .help("save the file as UTF-8 without a byte-order mark");
    }
    let list = alternatives(expected);
    let found = match found {
        "" => "the end of the file".to_owned(),
        word => format!("`{}`", visible(word)),
    };
    let title = match list.as_str() {
        "" => format!("did not expect {found}"),
        list => format!("expected {list}, found {found}"),
    };
    let label = if expected.is_empty() {
        "not part of the language"
    } else {
        "here"
    };
    Finding::new(Code::Syntax, title).label(site, label)
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
