//! The grammar's errors as findings.
use stochc_grammar::{
    BYTE_ORDER_MARK, MAX_DEPTH, MAX_ERRORS, MAX_STATEMENT, MAX_TERMS, SyntaxError,
    SyntaxErrorKind as K, is_comment,
};

use stochc_ir::series;

use super::syntax_hints::{SyntaxHint, spelt};
use super::{Code, Diagnostic, Edit, Fix};
use crate::{FileId, SourceLocation, Span};

impl Diagnostic {
    /// A finding for a place where a text is not a program; `text` is all of it.
    pub fn from_syntax(file: FileId, error: &SyntaxError, text: &str) -> Diagnostic {
        let location = SourceLocation {
            file,
            span: error.span,
        };
        let mut diagnostic = Diagnostic::of_kind(location, error, text);
        diagnostic.fix = diagnostic.fix.take().or_else(|| fix(location, error, text));
        diagnostic
    }

    fn of_kind(location: SourceLocation, error: &SyntaxError, text: &str) -> Diagnostic {
        match &error.kind {
            K::Unexpected {
                found,
                expected,
                behind,
            } => unexpected(&SyntaxHint {
                location,
                found,
                expected,
                behind,
                text,
            }),
            K::Unclosed => unclosed(location, text),
            K::MissingBrace { what } => {
                Diagnostic::new(Code::MissingBrace, format!("{what} without its `{{`"))
                    .label(location, "`{` is missing here")
                    .help("the statements of a block stand between `{` and `}`")
            }
            K::ClosedEarly { what } => {
                Diagnostic::new(Code::StrayBrace, format!("a `}}` closes {what} too early"))
                    .label(location, "more of it follows")
                    .help("remove it, or look for a `{` that is missing before it")
            }
            K::Unopened => Diagnostic::new(Code::StrayBrace, "a `}` without a block to close")
                .label(location, "nothing is open here")
                .help("remove it, or look for a block closed too early above"),
            K::Misplaced {
                what,
                within,
                belongs,
                ..
            } => misplaced(location, what, within, belongs),
            K::Parentheses { word } => {
                Diagnostic::new(Code::Syntax, format!("parentheses round what `{word}` names"))
                    .label(location, "not needed")
                    .help(format!("write it without: `{word} A`"))
            }
            K::MissingNumber => Diagnostic::new(Code::Syntax, "a unit without its number")
                .label(location, "how much?")
                .help("write the number before it, such as `25 N/m`"),
            K::ReservedWord { word } => Diagnostic::new(
                Code::ReservedWord,
                format!("`{word}` is a keyword"),
            )
            .label(location, "used as a name")
            .help(format!("choose another name, such as `{word}_1`")),
            K::FaceMisused { hint } => {
                Diagnostic::new(Code::FaceMisused, "a face does not fit here").label(location, *hint)
            }
            K::NumberTooLarge => {
                let number = text.get(location.span.start as usize..location.span.end as usize);
                let title = format!("`{}` is too large", spelt(number.unwrap_or_default()));
                Diagnostic::new(Code::NumberTooLarge, title)
                    .label(location, "more than can be stored")
                    .help(format!(
                        "whole numbers go up to {}, values of a scene up to {:e}",
                        i64::MAX,
                        f64::MAX
                    ))
            }
            K::TooDeep => Diagnostic::new(
                Code::TooDeep,
                format!("nested more than {MAX_DEPTH} levels deep"),
            )
            .label(location, "one level too many")
            .help("move the inner part into a pattern or a `let`"),
            K::TooManyTerms => Diagnostic::new(
                Code::TooDeep,
                format!("an expression of more than {MAX_TERMS} numbers and names"),
            )
            .label(location, "too many to work out at once")
            .help("name a part of it with a `let`"),
            K::StatementTooLong => Diagnostic::new(
                Code::StatementTooLong,
                format!("a statement of more than {MAX_STATEMENT} bytes"),
            )
            .label(location, "begins here")
            .help("break it up: a chain may go on in the next statement with its last block"),
            K::MissingReason => {
                let code = text.get(location.span.start as usize..location.span.end as usize);
                let code = spelt(code.unwrap_or_default());
                Diagnostic::new(Code::MissingReason, format!("`{code}` needs a reason"))
                    .label(location, "no reason follows")
                    .help(format!("write it in quotation marks: `{code} \"it marks the corner\"`"))
            }
            K::DanglingDoc => Diagnostic::new(Code::DanglingDoc, "a `///` comment with nothing below")
                .label(location, "belongs to nothing")
                .help("use `//` for a free comment"),
            K::TooMany => Diagnostic::new(
                Code::TooManyErrors,
                format!("more than {MAX_ERRORS} errors; the rest of the file was not read"),
            )
            .label(location, "reading stopped here")
            .help("fix the errors above first"),
            K::Json => Diagnostic::new(Code::Syntax, "the file is JSON, and no program")
                .label(location, "begins here")
                .help("what `stochc` has written is read by the option that it is for: rates by `--rates`, a manifest by `stochc repeat`"),
            K::FileTooLarge => Diagnostic::new(Code::FileTooLarge, "a file of 4 GiB or more")
                .help("split it into several files and `import` them"),
        }
    }
}

/// Returns the error of a block without its closing brace, with a `}` where the indentation ends.
fn unclosed(location: SourceLocation, text: &str) -> Diagnostic {
    let start = location.span.start as usize;
    let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
    let line = &text[line_start..start];
    let words: Vec<&str> = line.split_whitespace().take(2).collect();
    let title = match &words[..] {
        [] => "missing `}`".to_owned(),
        words => format!("missing `}}` of `{}`", spelt(&words.join(" "))),
    };
    let indentation = |line: &str| line.len() - line.trim_start().len();
    let depth = indentation(line);
    let ends = |line: &str| {
        let is_outside = !line.trim().is_empty() && indentation(line) <= depth;
        is_outside && !line.trim_start().starts_with('}')
    };
    let mut at = start
        + text[start..]
            .find('\n')
            .map_or(text.len() - start, |end| end + 1);
    for line in text[at..].split_inclusive('\n') {
        if ends(line) {
            break;
        }
        at += line.len();
    }
    let is_line = at == 0 || text[..at].ends_with('\n');
    let brace = format!(
        "{}{}}}\n",
        if is_line { "" } else { "\n" },
        " ".repeat(depth)
    );
    let above = text[..at].lines().count();
    let end = SourceLocation {
        span: Span::new(at as u32, at as u32),
        ..location
    };
    Diagnostic::new(Code::UnclosedBrace, title)
        .label(location, "this `{` is never closed")
        .help(format!(
            "write `}}` where the block ends; by the indentation, that is after line {above}"
        ))
        .fix(Fix::replace(end, brace, "add the `}`").unsafe_if(true))
}

/// Returns the error of a statement or block in the wrong surroundings.
fn misplaced(
    location: SourceLocation,
    what: &'static str,
    within: &'static str,
    belongs: &'static str,
) -> Diagnostic {
    let is_block = what.starts_with("a phase") || what.starts_with("a seed plate");
    let help = match within {
        // Where one stands in the other, the first has probably been left open.
        "a phase" | "a seed plate" if is_block => {
            format!("it belongs in {belongs}: is the `}}` of {within} missing before it?")
        }
        "an instance of a pattern" if what == "an `after`" => {
            "put it in the pattern, behind the captures that have to wait; what they wait \
             for may be an argument: `pattern tower(base, first) { base.up -> T after first }`"
                .to_owned()
        }
        within if within.starts_with("a loop") => format!("move the loop into {belongs}"),
        _ => format!("it belongs in {belongs}"),
    };
    let title = format!("{what} does not belong in {within}");
    Diagnostic::new(Code::Misplaced, title)
        .label(location, format!("{what}, in {within}"))
        .help(help)
}

fn unexpected(hint: &SyntaxHint<'_>) -> Diagnostic {
    let &SyntaxHint {
        location,
        found,
        expected,
        ..
    } = hint;
    if found.starts_with(BYTE_ORDER_MARK) {
        let start = location.span.start;
        let mark = SourceLocation {
            span: Span::new(start, start + BYTE_ORDER_MARK.len() as u32),
            ..location
        };
        return Diagnostic::new(Code::Syntax, "a byte-order mark")
            .label(location, "an invisible sign of three bytes")
            .help("save the file as UTF-8 without a byte-order mark")
            .fix(Fix::remove(mark, "remove the mark"));
    }
    if let Some(diagnostic) = hint.timeout() {
        return diagnostic;
    }
    if let Some((word, title, help)) = hint.foreign() {
        return Diagnostic::new(Code::Syntax, title)
            .label(word, "not part of the language")
            .help(help);
    }
    let list = series(expected, "or");
    let shown = match found {
        "" => "the end of the file".to_owned(),
        word => format!("`{}`", spelt(word)),
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
    let mut diagnostic = Diagnostic::new(Code::Syntax, title).label(location, label);
    (diagnostic.help, diagnostic.fix) = hint.advice();
    diagnostic
}

/// How errors of syntax other than a wrong word are fixed.
fn fix(location: SourceLocation, error: &SyntaxError, text: &str) -> Option<Fix> {
    let (start, end) = (location.span.start as usize, location.span.end as usize);
    let part = |start: usize, end: usize| SourceLocation {
        span: Span::new(start as u32, end as u32),
        ..location
    };
    Some(match &error.kind {
        K::DanglingDoc => {
            let mut fix = Fix {
                title: "make it a free comment with `//`".to_owned(),
                edits: Vec::new(),
                safe: true,
            };
            // The lines right below are part of it.
            let mut at = start;
            for line in text.get(start..)?.split_inclusive('\n') {
                let doc = line.trim_start();
                if !doc.starts_with("///") || is_comment(doc.as_bytes()) {
                    break;
                }
                let slashes = at + line.len() - doc.len();
                fix.edits.push(Edit {
                    location: part(slashes, slashes + 3),
                    text: "//".to_owned(),
                });
                at += line.len();
            }
            fix
        }
        K::FaceMisused { hint } if hint.starts_with("a block is meant") => {
            let dot = text.get(..start)?.strip_suffix('.')?.len();
            Fix::remove(part(dot, end), "leave the face out")
        }
        K::Parentheses { .. } => {
            let before = text.get(..start)?;
            let space = if before.ends_with(char::is_whitespace) {
                ""
            } else {
                " "
            };
            let mut fix = Fix::replace(part(start, start + 1), space, "remove the parentheses");
            fix.edits.push(Edit {
                location: part(end - 1, end),
                text: String::new(),
            });
            fix
        }
        K::ReservedWord { word } => {
            let name = format!("{word}_1");
            Fix::replace(location, &name, format!("call it `{name}`")).unsafe_if(true)
        }
        K::MissingBrace { .. } => Fix::replace(location, " {", "write the `{`"),
        K::MissingReason => {
            let reason = " \"it marks the corner\"";
            Fix::replace(part(end, end), reason, "add a reason").unsafe_if(true)
        }
        K::Unopened | K::ClosedEarly { .. } => Fix::remove(location, "remove it").unsafe_if(true),
        _ => return None,
    })
}
