//! Advice and fixes for the most frequent syntax errors.
use stochc_grammar::{BEGINNINGS, is_unit};
use stochc_ir::scene::quantity::QuantityKind;
use stochc_ir::scene::units::{corrected, suggested_unit};
use stochc_text::suggest::{Suggestion, nearest};

use super::{Code, Diagnostic, Edit, Fix};
use crate::{SourceLocation, Span};

/// An unexpected word with its context.
pub struct SyntaxHint<'a> {
    pub location: SourceLocation,
    /// The word, shortened.
    pub found: &'a str,
    /// Words that are valid at this location.
    pub expected: &'a [&'static str],
    /// First word of the statement, if `found` is the second word. Otherwise empty.
    pub after: &'a str,
    /// Source of the whole file.
    pub text: &'a str,
}

/// Keywords of other languages, with the advice.
const FOREIGN: [(&[&str], &str); 4] = [
    (
        &["elif", "elsif", "unless", "when", "match", "switch", "case"],
        "write `if n > 2 { ... } else if n > 0 { ... } else { ... }`; conditions compare numbers",
    ),
    (
        &["while", "loop", "repeat", "until", "foreach"],
        "repeat with `for i in 1..4 { ... }`",
    ),
    (
        &["fn", "func", "function", "def", "proc", "macro"],
        "name a group of statements with `pattern tower(base, height) { ... }`",
    ),
    (&["var", "const", "int"], "name a number with `let n = 6`"),
];

impl SyntaxHint<'_> {
    /// Returns location, title and advice if the statement begins with a keyword of another
    /// programming language.
    pub fn foreign(&self) -> Option<(SourceLocation, String, &'static str)> {
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let before = self.before();
        let start = before.rfind(['\n', '{', '}']).map_or(0, |at| at + 1);
        let line = &self.text[start..];
        let start = start + line.len() - line.trim_start_matches([' ', '\t']).len();
        let line = self.text.get(start..)?;
        let word = &line[..line.find(|c| !is_word(c)).unwrap_or(line.len())];
        // A block may have this name.
        let rest = line[word.len()..].trim_start();
        if start > before.len() || rest.starts_with(['.', '[', '-']) {
            return None;
        }
        let (_, help) = FOREIGN.iter().find(|(words, _)| words.contains(&word))?;
        let title = format!("`{word}` is not part of the language");
        Some((self.span(start, start + word.len()), title, help))
    }

    /// Returns the error of a `timeout` after a capture, with the change that moves it to the
    /// phase. Returns `None` for other errors.
    pub fn timeout(&self) -> Option<Diagnostic> {
        if self.after != "timeout" {
            return None;
        }
        let at = self.location.span.start as usize;
        let before = &self.text[..at];
        let word = before.trim_end().strip_suffix("timeout")?.len();
        let rest = self.text[at..].split(['\n', '}']).next().unwrap_or("");
        let time = rest.split("//").next().unwrap_or("").trim_end();
        let number = time.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
        let unit = number.trim_start();
        if number.len() == time.len() || !unit.bytes().all(|byte| byte.is_ascii_alphabetic()) {
            return None;
        }
        let head = before.rfind("phase ")?;
        let brace = head + before[head..].find('{')?;
        let name = before[head..brace].strip_prefix("phase ")?.trim();
        let written = format!("phase {name} timeout {time}");
        let mut fix = Fix::replace(
            self.span(brace, brace),
            format!("timeout {time} "),
            "move it",
        );
        fix.title = format!("write `{written} {{`");
        fix.edits.push(Edit {
            location: self.span(before[..word].trim_end().len(), at + time.len()),
            text: String::new(),
        });
        let title = "`timeout` belongs to a phase, not to a capture";
        let diagnostic = Diagnostic::new(Code::Misplaced, title)
            .label(
                self.span(word, at + time.len()),
                "this one follows a capture",
            )
            .help(format!("write `{written} {{`"))
            .fix(fix.unsafe_if(name.contains("timeout")));
        Some(diagnostic)
    }

    /// Returns the error of a value with a sign or a unit that the grammar does not read, such as
    /// `26\u{b0}` or `1 g/ml`. Returns `None` for other errors.
    pub fn value(&self) -> Option<Diagnostic> {
        /// Length of the longest value \[bytes\].
        const LONGEST: usize = 60;
        if !self.expects("a value") {
            return None;
        }
        let at = self.location.span.start as usize;
        let before = self.before();
        let begins = |&(place, c): &(usize, char)| {
            c.is_ascii_digit() && before[..place].ends_with([' ', '\t', '\n'])
        };
        let line = before.rfind('\n').map_or(0, |line| line + 1);
        let mut numbers = before[line..]
            .char_indices()
            .map(|(i, c)| (line + i, c))
            .filter(begins);
        let (start, _) = numbers.next_back()?;
        let is_end = |c: char| c.is_whitespace() || matches!(c, '{' | '}' | '(' | ')' | ';');
        let end = at + self.text[at..].find(is_end).unwrap_or(self.text.len() - at);
        let written = &self.text[start..end];
        let value = Some(written).filter(|it| end > at && it.len() <= LONGEST);
        let value = corrected(value?)?;
        let title = match self.found {
            "," => format!("decimal comma in `{written}`"),
            _ => format!("unknown unit in `{}`", spelt(written)),
        };
        let here = self.span(start, end);
        let help = format!("write `{value}`");
        let diagnostic = Diagnostic::new(Code::Syntax, title)
            .label(here, "this value cannot be read")
            .help(help.clone())
            .fix(Fix::replace(here, value, help));
        Some(diagnostic)
    }

    pub fn advice(&self) -> (Option<String>, Option<Fix>) {
        if let Some((word, suggestion)) = self.misspelt() {
            return (Some(suggestion.help()), Some(Fix::word(word, &suggestion)));
        }
        let fix = self.fix();
        let after = self.after;
        if self.expects("`->`")
            && !after.is_empty()
            && !first_words().contains(&after)
            && fix.is_none()
        {
            let after = spelt(after);
            let help = format!(
                "`{after}` alone is not a statement: add the missing comma or brace before it"
            );
            return (Some(help), None);
        }
        if self.found == "{" && self.expects("a name") && !after.is_empty() {
            let help = format!("add a name: `{} NAME {{`", spelt(after));
            return (Some(help), None);
        }
        let help = match self.found {
            _ if self.size().is_some() => "write spaces around the `x` of a size: `3 x 1`",
            "\u{d7}" => "write a size with the letter `x`: `3 x 1`",
            found if found.starts_with(|c: char| c.is_alphabetic() && !c.is_ascii()) => {
                "write names with the letters `a` to `z` and `A` to `Z`, digits and `_`"
            }
            ";" => "remove it: statements need no separator",
            found if self.is_unit_on_next_line(found) => "write the unit on the line of its number",
            "/" if self.is_one_over() => "write `s^-1` for one over a unit",
            "/" => "begin the comment with `//`",
            "#" if !self.is_row() => "begin the comment with `//`",
            "///" => "begin a comment that documents nothing with `//`",
            "\"" | "'" => "write the file name between two `\"`, in one line",
            "=" | "-" | ">" | "\u{2192}" | "\u{2013}" | "\u{2014}" if self.expects("`->`") => {
                "write `->` to capture one block and `->>` for a row: `M.up ->> T[1..3]`"
            }
            "." | "=" if self.before().ends_with("..") => "write a range as `1..4`",
            "in" if self.loop_in_parentheses().is_some() => {
                "write a loop as `for i in 1..4 { ... }`"
            }
            _ => return (None, fix),
        };
        (Some(help.to_owned()), fix)
    }

    /// Returns a misspelt keyword or unit. Returns `None` if no word is similar.
    fn misspelt(&self) -> Option<(SourceLocation, Suggestion)> {
        let is_word = |text: &str| text.starts_with(|c: char| c.is_ascii_alphabetic());
        if is_word(self.found) {
            let before = self.before().trim_end_matches([' ', '\t']);
            if self.expects("`{`") && before.ends_with(|c: char| c.is_ascii_digit()) {
                let kinds = [QuantityKind::TIME, QuantityKind::TICKS];
                return suggested_unit(self.found, &kinds)
                    .map(|suggestion| (self.location, suggestion));
            }
            let words = self.expected.iter().map(|word| word.trim_matches('`'));
            let words = words.filter(|word| word.starts_with(|c: char| c.is_ascii_lowercase()));
            // Alternatives such as `a block` are not keywords.
            let suggestion = nearest(self.found, words.filter(|word| !word.contains(' ')));
            if let Some(suggestion) = suggestion.filter(|_| self.found.len() > 2) {
                return Some((self.location, suggestion));
            }
        }
        let word = self.word_behind()?;
        if !self.expects("`->`") || first_words().contains(&self.after) {
            return None;
        }
        nearest(self.after, first_words()).map(|suggestion| (word, suggestion))
    }

    /// Returns whether a unit follows a number at the end of the previous line.
    fn is_unit_on_next_line(&self, found: &str) -> bool {
        let before = self.before();
        let number = before.trim_end();
        before[number.len()..].contains('\n')
            && number.ends_with(|c: char| c.is_ascii_digit())
            && self.expects("`{`")
            && is_unit(found)
    }

    /// Returns the location of the word before the error if it is the first of its statement.
    fn word_behind(&self) -> Option<SourceLocation> {
        let before = self.before().trim_end();
        let start = before.strip_suffix(self.after)?.len();
        (!self.after.is_empty()).then(|| self.span(start, before.len()))
    }

    fn fix(&self) -> Option<Fix> {
        let at = self.location.span.start as usize;
        let rest = &self.text[at..];
        let here = |length: usize| self.span(at, at + length);
        Some(match self.found {
            found if self.size().is_some() => {
                let size = self.size()?;
                Fix::replace(here(found.len()), &size, format!("write `{}`", size.trim()))
            }
            ";" => {
                let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
                let joins = self.before().ends_with(is_word) && rest[1..].starts_with(is_word);
                Fix::replace(here(1), if joins { " " } else { "" }, "remove the `;`")
            }
            "#" if self.begins_statement() && !self.is_row() => {
                let length = rest.len() - rest.trim_start_matches('#').len();
                // Three slashes would document something.
                let slashes = if rest[length..].starts_with('/') {
                    "// "
                } else {
                    "//"
                };
                Fix::replace(here(length), slashes, "begin the comment with `//`")
            }
            "/" if rest.starts_with("/*") => {
                let line = rest.split('\n').next().unwrap_or(rest);
                let end = 2 + line.get(2..)?.find("*/")?;
                if !line[end + 2..].trim().is_empty() {
                    return None;
                }
                let location = self.span(at + end, at + end + 2);
                let mut fix = Fix::replace(here(2), "//", "begin the comment with `//`");
                fix.edits.push(Edit {
                    location,
                    text: String::new(),
                });
                fix
            }
            "/" if self.begins_statement() && !self.is_one_over() => {
                Fix::replace(here(1), "//", "begin the comment with `//`")
            }
            "///" => Fix::replace(here(3), "//", "begin the comment with `//`"),
            "." | "=" if self.before().ends_with("..") => {
                Fix::remove(here(1), "write the range with two dots")
            }
            "=" | "-" | ">" | "\u{2192}" | "\u{2013}" | "\u{2014}" if self.expects("`->`") => {
                self.arrow(rest)?
            }
            "in" => {
                let open = self.loop_in_parentheses()?;
                let head = rest.split(['\n', '{']).next().unwrap_or(rest);
                let end = head.rfind(')')?;
                let mut fix = Fix::remove(self.span(open, open + 1), "remove the parentheses");
                fix.edits.push(Edit {
                    location: self.span(at + end, at + end + 1),
                    text: String::new(),
                });
                fix
            }
            _ if self.expects("a file name in quotation marks") => {
                let name = rest.split([' ', '\t', '\r', '\n', ';']).next()?;
                let plain = name.trim_matches('\'');
                if !plain.ends_with(".sa") || plain.contains(['"', '\'']) {
                    return None;
                }
                let title = "put the file name in quotation marks";
                Fix::replace(here(name.len()), format!("\"{plain}\""), title)
            }
            _ => return None,
        })
    }

    /// Returns the corrected form of a plate size without spaces, such as `3 x 3` for `3x3`. The
    /// number after the `x` may be missing. Returns `None` for other words.
    fn size(&self) -> Option<String> {
        let before = self.before().trim_end();
        let (width, depth) = self.found.split_once(['x', 'X'])?;
        let is_number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        let is_size = before.ends_with("plate") && !width.is_empty();
        (is_size && is_number(width) && is_number(depth))
            .then(|| format!("{width} x {depth}").trim_end().to_owned())
    }

    /// Returns the position of the parenthesis of `for (i in`. Returns `None` for any other text.
    fn loop_in_parentheses(&self) -> Option<usize> {
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let open = self
            .before()
            .trim_end()
            .trim_end_matches(is_word)
            .trim_end();
        let before = open.strip_suffix('(')?;
        let head = before.trim_end().strip_suffix("for")?;
        (!head.ends_with(is_word)).then_some(before.len())
    }

    /// Returns a fix for arrows of other languages in the rest of the line. Only the first arrow is
    /// reported as an error. Returns `None` if there is no such arrow.
    fn arrow(&self, rest: &str) -> Option<Fix> {
        let is_part = |c: char| matches!(c, '=' | '-' | '>' | '\u{2192}' | '\u{2013}' | '\u{2014}');
        let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        let sign = &rest[..length];
        let arrow = match sign {
            "=>" | "-->" | ">" | "\u{2192}" | "\u{2013}>" | "\u{2014}>" => "->",
            "=>>" | "-->>" | ">>" | "\u{2192}>" | "\u{2013}>>" | "\u{2014}>>" => "->>",
            _ => return None,
        };
        let line = rest.split('\n').next().unwrap_or(rest);
        let code = line.split("//").next().unwrap_or(line);
        let is_alone = |&at: &usize| {
            !code[..at].ends_with(is_part) && !code[at + length..].starts_with(is_part)
        };
        let places = code.match_indices(sign).map(|(at, _)| at).filter(is_alone);
        let start = self.location.span.start as usize;
        let edits = places.map(|at| Edit {
            location: self.span(start + at, start + at + length),
            text: arrow.to_owned(),
        });
        Some(Fix {
            title: format!("write `{arrow}`"),
            edits: edits.collect(),
            safe: true,
        })
    }

    fn expects(&self, word: &str) -> bool {
        self.expected.contains(&word)
    }

    /// Returns whether the text is a row of a shape, even if misplaced.
    fn is_row(&self) -> bool {
        let rest = &self.text[self.location.span.start as usize..];
        let line = rest.split(['\n', '}']).next().unwrap_or(rest).trim();
        line.chars().all(|c| matches!(c, '#' | '.' | ' ' | '\t'))
    }

    /// Returns whether a statement can begin at the unexpected word.
    fn begins_statement(&self) -> bool {
        self.expects("`}`") || self.expects("`assembly`")
    }

    /// Returns whether the unexpected word is the slash of `1/s`.
    fn is_one_over(&self) -> bool {
        let after = &self.text[self.location.span.end as usize..];
        self.before().ends_with(" 1") && after.starts_with(|c: char| c.is_ascii_lowercase())
    }

    fn before(&self) -> &str {
        &self.text[..self.location.span.start as usize]
    }

    fn span(&self, start: usize, end: usize) -> SourceLocation {
        SourceLocation {
            file: self.location.file,
            span: Span::new(start as u32, end as u32),
        }
    }
}

/// Returns the words that begin a statement or a directive, and `after`.
fn first_words() -> Vec<&'static str> {
    [BEGINNINGS.as_slice(), &["after", "allow", "deny"]].concat()
}

/// Returns text with escapes for invisible characters.
pub(super) fn spelt(word: &str) -> String {
    let mut text = String::new();
    for c in word.chars() {
        match c {
            '\'' | '"' | '\\' => text.push(c),
            _ => text.extend(c.escape_debug()),
        }
    }
    text
}
