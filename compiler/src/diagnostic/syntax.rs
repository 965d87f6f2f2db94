//! Converts syntax errors to diagnostics.
use stochc_grammar::{
    BYTE_ORDER_MARK, MAX_DEPTH, MAX_ERRORS, MAX_STATEMENT, MAX_TERMS, SyntaxError,
    SyntaxErrorKind as K, code, is_comment,
};

use stochc_grammar::tree::Function;
use stochc_text::series;

use super::syntax_hints::{SyntaxHint, spelt};
use super::{Code, Diagnostic, Edit, Fix};
use crate::{FileId, SourceLocation, Span};

impl Diagnostic {
    /// Returns the diagnostic of a syntax error. `text` is the source of the whole file.
    pub fn from_syntax(file: FileId, error: &SyntaxError, text: &str) -> Diagnostic {
        let location = SourceLocation {
            file,
            span: error.span,
        };
        let mut diagnostic = Diagnostic::from_kind(location, error, text);
        diagnostic.fix = diagnostic.fix.take().or_else(|| fix(location, error, text));
        diagnostic
    }

    fn from_kind(location: SourceLocation, error: &SyntaxError, text: &str) -> Diagnostic {
        match &error.kind {
            K::Unexpected {
                found,
                expected,
                after,
            } => unexpected(&SyntaxHint {
                location,
                found,
                expected,
                after,
                text,
            }),
            K::Unclosed => unclosed(location, text),
            K::MissingBrace { what } => missing_brace(location, what, text),
            K::ClosedEarly { what } => Diagnostic::new(
                Code::StrayBrace,
                format!("this `}}` closes {what} too early"),
            )
            .label(location, format!("more of {what} follows"))
            .help("remove it, or add the missing `{` before it"),
            K::Unopened => Diagnostic::new(Code::StrayBrace, "unexpected `}`")
                .label(location, "no block is open here")
                .help("remove it, or check whether an earlier `}` closed its block too soon"),
            K::Misplaced {
                what,
                within,
                belongs,
                ..
            } => misplaced(location, what, within, belongs, text),
            K::Parentheses { word } => {
                Diagnostic::new(Code::Syntax, format!("`{word}` takes no parentheses"))
                    .label(location, "a list in parentheses")
                    .help(format!("write `{word} A`"))
            }
            K::MissingNumber => Diagnostic::new(Code::Syntax, "a unit has no number before it")
                .label(location, "the number is missing")
                .help("write a number and its unit, such as `25 N/m`"),
            K::ReservedWord { word } => {
                Diagnostic::new(Code::ReservedWord, format!("`{word}` is a keyword"))
                    .label(location, "it cannot be a name")
                    .help(format!("choose another name, such as `{word}_1`"))
            }
            K::FaceMisused { hint } => {
                let face = text.get(location.span.start as usize..location.span.end as usize);
                let title = format!("unexpected face `{}`", spelt(face.unwrap_or_default()));
                Diagnostic::new(Code::FaceMisused, title)
                    .label(location, "no face can stand here")
                    .help(*hint)
            }
            K::NumberAsCondition | K::ConditionAsNumber | K::WrongFunction { .. } => {
                in_expression(location, &error.kind)
            }
            K::NumberTooLarge => {
                let number = text.get(location.span.start as usize..location.span.end as usize);
                number_too_large(location, number.unwrap_or_default())
            }
            K::TooDeep => Diagnostic::new(
                Code::TooDeep,
                format!("nested more than {MAX_DEPTH} levels deep"),
            )
            .label(location, format!("this is level {}", MAX_DEPTH + 1))
            .help("move the inner part into a pattern or a `let`"),
            K::TooManyTerms => Diagnostic::new(
                Code::TooDeep,
                format!("an expression has more than {MAX_TERMS} numbers and names"),
            )
            .label(location, "the expression is too long")
            .help("name a part of it: `let part = ...`"),
            K::StatementTooLong => Diagnostic::new(
                Code::StatementTooLong,
                format!("a statement has more than {MAX_STATEMENT} bytes"),
            )
            .label(location, "the statement begins here")
            .help("split it: the next statement can continue a chain from its last block"),
            K::MissingReason => missing_reason(location, text),
            K::DanglingDoc => {
                Diagnostic::new(Code::DanglingDoc, "a `///` comment documents nothing")
                    .label(location, "no declaration or statement follows")
                    .help("write `//`, or move the comment above a statement")
            }
            K::TooMany => Diagnostic::new(
                Code::TooManyErrors,
                format!("more than {MAX_ERRORS} errors of syntax"),
            )
            .label(location, "the file was not read from here on")
            .help("fix the errors above first"),
            K::Json => Diagnostic::new(Code::Syntax, "the file is JSON, not a program")
                .label(location, "JSON begins here")
                .help(
                    "pass a program (`*.sa`); rates are passed with `--rates`, results as a folder",
                ),
            K::FileTooLarge => Diagnostic::new(Code::FileTooLarge, "the file has 4 GiB or more")
                .help("split it into several files and `import` them"),
        }
    }
}

/// Returns the error of a block without its closing brace. Its fix adds `}` where the indentation
/// ends.
fn unclosed(location: SourceLocation, text: &str) -> Diagnostic {
    let start = location.span.start as usize;
    let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
    let line = &text[line_start..start];
    let title = match block_name(line) {
        Some(name) => format!("missing `}}` for `{name}`"),
        None => "missing `}`".to_owned(),
    };
    let depth = indentation(line);
    let ends = |line: &str| {
        let is_brace = line.trim_start().starts_with('}');
        !line.trim().is_empty() && indentation(line) + usize::from(is_brace) <= depth
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
    // Its own `}` closes a block in it.
    if at == text.len()
        && let Some(inner) = closed_by_outer_brace(text, line_start)
    {
        let span = Span::new(inner as u32, inner as u32 + 1);
        return unclosed(SourceLocation { span, ..location }, text);
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
            "the indentation suggests a `}}` after line {above}"
        ))
        .fix(Fix::replace(end, brace, "add the `}`").unsafe_if(true))
}

fn indentation(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// Returns the first inner `{` that a `}` with less indentation closes. The search begins in the
/// line at `start`, the head of the outer block.
fn closed_by_outer_brace(text: &str, start: usize) -> Option<usize> {
    let mut open: Vec<(usize, usize)> = Vec::new();
    let text = &text[start..];
    let signs = code(text).flat_map(|(at, code)| {
        (code.match_indices(['{', '}'])).map(move |(column, sign)| (at + column, sign))
    });
    for (at, sign) in signs {
        let line_start = text[..at].rfind('\n').map_or(0, |end| end + 1);
        let depth = indentation(&text[line_start..at]);
        if sign == "{" {
            open.push((start + at, depth));
            continue;
        }
        let (inner, inner_depth) = open.pop()?;
        if at == line_start + depth && depth < inner_depth && !open.is_empty() {
            return Some(inner);
        }
    }
    None
}

/// Returns up to two words from the start of the head of a block, such as `phase grow`. Returns
/// `None` if the head has no words.
fn block_name(head: &str) -> Option<String> {
    let words: Vec<&str> = head.split_whitespace().take(2).collect();
    (!words.is_empty()).then(|| spelt(&words.join(" ")))
}

/// Returns the error of a block without its opening brace.
fn missing_brace(location: SourceLocation, what: &str, text: &str) -> Diagnostic {
    let before = text.get(..location.span.start as usize).unwrap_or_default();
    let head = before.lines().next_back().unwrap_or_default().trim();
    let title = match block_name(head) {
        Some(name) => format!("missing `{{` for `{name}`"),
        None => format!("missing `{{` for {what}"),
    };
    let diagnostic = Diagnostic::new(Code::MissingBrace, title).label(location, "`{` belongs here");
    // The head may begin on an earlier line, or be long.
    match head.len() {
        1..=60 => diagnostic.help(format!("write `{} {{`", spelt(head))),
        _ => diagnostic.help("write `{`"),
    }
}

/// Returns the error of an `allow` or `deny` without its reason.
fn missing_reason(location: SourceLocation, text: &str) -> Diagnostic {
    let code = text.get(location.span.start as usize..location.span.end as usize);
    let code = spelt(code.unwrap_or_default());
    let before = text.get(..location.span.start as usize).unwrap_or_default();
    let is_deny = before.trim_end().ends_with("deny");
    let verdict = if is_deny { "deny" } else { "allow" };
    let title = format!("`{verdict} {code}` needs a reason");
    Diagnostic::new(Code::MissingReason, title)
        .label(location, "the reason must follow this code")
        .help(format!("write `{verdict} {code} \"it marks the corner\"`"))
}

fn number_too_large(location: SourceLocation, number: &str) -> Diagnostic {
    /// Integers with fewer digits are compared with the 64-bit limit in the message. Longer
    /// integers are compared with the limit of floating-point numbers.
    const DIGITS: usize = 300;
    let is_whole = number.bytes().all(|byte| byte.is_ascii_digit()) && number.len() < DIGITS;
    let (title, limit) = if is_whole {
        ("does not fit in 64 bits", i64::MAX.to_string())
    } else {
        ("is too large", format!("{:e}", f64::MAX))
    };
    Diagnostic::new(Code::NumberTooLarge, format!("`{}` {title}", spelt(number)))
        .label(location, "this number is above the limit")
        .help(format!("write at most {limit}"))
}

/// Returns the error of a statement or block in the wrong surroundings.
fn misplaced(
    location: SourceLocation,
    what: &'static str,
    within: &'static str,
    belongs: &'static str,
    text: &str,
) -> Diagnostic {
    /// Length of the longest statement that a help repeats \[bytes\].
    const LONGEST: usize = 60;
    let is_block = what.starts_with("a phase") || what.starts_with("a seed plate");
    let written = text.get(location.span.start as usize..location.span.end as usize);
    let written = written.filter(|it| it.len() <= LONGEST && !it.contains('\n'));
    let help = match within {
        // A block inside another one of its kind: the outer one probably lacks its brace.
        "a phase" | "a seed plate" if is_block => {
            format!("add the missing `}}` of {within} before it")
        }
        "an instance of a pattern" if what == "an `after`" => {
            "move it into the pattern, after a capture; the block that it waits for can be an \
             argument: `pattern tower(base, first) { base.up -> T after first }`"
                .to_owned()
        }
        within if within.starts_with("a loop") => format!("move the loop into {belongs}"),
        _ => match written {
            Some(written) if belongs.starts_with("a phase") => {
                format!("wrap it: `phase NAME {{ {} }}`", spelt(written))
            }
            _ => format!("move it into {belongs}"),
        },
    };
    let place = belongs.split_once(": ").map_or(belongs, |(place, _)| place);
    let label = match within {
        "the file" => "this one is outside of every block".to_owned(),
        within => format!("this one is in {within}"),
    };
    Diagnostic::new(Code::Misplaced, format!("{what} must be inside {place}"))
        .label(location, label)
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
        return Diagnostic::new(Code::Syntax, "a byte-order mark inside the file")
            .label(location, "three invisible bytes")
            .help("save the file as UTF-8 without a byte-order mark")
            .fix(Fix::remove(mark, "remove the mark"));
    }
    if let Some(diagnostic) = hint.timeout() {
        return diagnostic;
    }
    if let Some(diagnostic) = hint.value() {
        return diagnostic;
    }
    if let Some((word, title, help)) = hint.foreign() {
        return Diagnostic::new(Code::Syntax, title)
            .label(word, "unknown keyword")
            .help(help);
    }
    let list = series(expected, "or");
    let shown = match found {
        "" => "the end of the file".to_owned(),
        word => format!("`{}`", spelt(word)),
    };
    let title = match list.as_str() {
        "" => format!("unexpected {shown}"),
        list => format!("expected {list}, found {shown}"),
    };
    let mut diagnostic = Diagnostic::new(Code::Syntax, title).label(location, "cannot stand here");
    (diagnostic.help, diagnostic.fix) = hint.advice();
    diagnostic
}

/// Returns the fix of an error other than a wrong word. Returns `None` if no fix is known.
fn fix(location: SourceLocation, error: &SyntaxError, text: &str) -> Option<Fix> {
    let (start, end) = (location.span.start as usize, location.span.end as usize);
    let part = |start: usize, end: usize| SourceLocation {
        span: Span::new(start as u32, end as u32),
        ..location
    };
    Some(match &error.kind {
        K::DanglingDoc => {
            let mut fix = Fix {
                title: "write `//`".to_owned(),
                edits: Vec::new(),
                safe: true,
            };
            // Comments on the following lines are part of it.
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
        K::FaceMisused { hint } if hint.starts_with("write the block without") => {
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

/// Returns the diagnostic of an error in a condition or function.
fn in_expression(location: SourceLocation, kind: &K) -> Diagnostic {
    match kind {
        K::NumberAsCondition => {
            Diagnostic::new(Code::WrongKind, "a condition is required, not a number")
                .label(location, "this is a number")
                .help("compare it with another number, such as `n > 0`")
        }
        K::WrongFunction { word } => {
            let is_known = Function::ALL.iter().any(|it| it.word() == word);
            let title = if is_known {
                format!("`{word}` has one argument")
            } else {
                format!("cannot find function `{}`", spelt(word))
            };
            Diagnostic::new(Code::UnknownName, title)
                .label(location, "in this expression")
                .help(
                    "write `min(a, b)`, `max(a, b)` or `abs(a)`, or for faces `opposite(f)`, \
                     `left(f)` or `right(f)`",
                )
        }
        _ => Diagnostic::new(Code::WrongKind, "a number is required, not a condition")
            .label(location, "this is a condition")
            .help("join conditions by `and` or `or`, such as `1 < n and n < 4`"),
    }
}
