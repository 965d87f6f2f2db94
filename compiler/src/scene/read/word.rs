//! Reads the words of a scene in order.
use stochc_grammar::Span;
use stochc_grammar::tree::{Name, Term};
use stochc_ir::scene::schema::{CLAUSES, SchemaEntry};
use stochc_text::suggest::nearest;

use super::{SceneReader, named, span, words};
use crate::diagnostic::{Code, Diagnostic, Fix, report};

impl SceneReader<'_, '_> {
    /// Returns the next word that is in `known`. Skips other words and reports the first of them.
    /// Returns `None` at the end of the scene.
    pub(super) fn head(
        &mut self,
        known: &'static [SchemaEntry],
        noun: &str,
        present: &[Name],
    ) -> Option<(Name, &'static SchemaEntry)> {
        let mut reported = false;
        loop {
            let term = self.terms.next()?;
            if let Term::Word(name) = term {
                self.place = name.span;
                let word = self.word_of(*name);
                if let Some(entry) = known.iter().find(|entry| entry.word == word) {
                    return Some((*name, entry));
                }
                if !reported {
                    let location = self.location(name.span);
                    let title = format!("`{word}` is not a {noun}");
                    let mut suggestion = nearest(word, words(known));
                    if let Some(suggestion) = &mut suggestion {
                        // A word that the scene already has is not suggested as a safe fix.
                        suggestion.clear &=
                            named(present, &suggestion.word, self.symbols).is_none();
                    }
                    let diagnostic = Diagnostic::new(Code::UnknownTerm, title)
                        .label(location, "unknown word")
                        .suggest(location, suggestion, || {
                            format!("write one of {}", words(known).join(", "))
                        });
                    report(self.diagnostics, diagnostic);
                }
            } else if !reported {
                let span = span(term);
                let help = format!("write one of {}", words(known).join(", "));
                let title = format!("expected a {noun}");
                self.report(
                    Code::UnknownTerm,
                    title,
                    span,
                    "this cannot stand here",
                    help,
                );
            }
            reported = true;
        }
    }

    /// Reads a word that selects a kind. Returns `None` and reports an error for any other word.
    pub(super) fn kind(
        &mut self,
        of: &'static [SchemaEntry],
        noun: &str,
    ) -> Option<&'static SchemaEntry> {
        let known = &words(of)[..];
        let (expected, help) = match known {
            [only] => (
                format!("`{only}`"),
                format!("write `{only}`, the only kind"),
            ),
            _ => {
                let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) {
                    "an"
                } else {
                    "a"
                };
                (
                    format!("{article} {noun}"),
                    format!("write one of {}", known.join(", ")),
                )
            }
        };
        let next = self.terms.peek().copied();
        let (found, span) = match next {
            Some(Term::Word(name)) if self.begins_clause(*name) => ("nothing", self.place),
            Some(Term::Word(name)) => {
                let found = self.word_of(*name);
                if let Some(kind) = of.iter().find(|kind| kind.word == found) {
                    self.place = name.span;
                    self.terms.next();
                    return Some(kind);
                }
                self.terms.next();
                let location = self.location(name.span);
                let title = format!("expected {expected}, found `{found}`");
                let diagnostic = Diagnostic::new(Code::UnknownTerm, title)
                    .label(location, "cannot stand here")
                    .help(help);
                let fix = match (nearest(found, known), known) {
                    (Some(suggestion), _) => Some(Fix::word(location, &suggestion)),
                    (None, [only]) => Some(
                        Fix::replace(location, *only, format!("write `{only}`")).unsafe_if(true),
                    ),
                    _ => None,
                };
                let diagnostic = match fix {
                    Some(fix) => diagnostic.fix(fix),
                    None => diagnostic,
                };
                report(self.diagnostics, diagnostic);
                return None;
            }
            Some(term) => ("something else", span(term)),
            None => ("nothing", self.place),
        };
        let title = format!("expected {expected}, found {found}");
        let location = self.location(span);
        let diagnostic = Diagnostic::new(Code::UnknownTerm, title)
            .label(location, "the kind is missing")
            .help(help);
        let diagnostic = match (found, known) {
            ("nothing", [first, ..]) => {
                let behind = self.location(Span::new(span.end, span.end));
                let fix = Fix::replace(behind, format!(" {first}"), format!("add `{first}`"));
                diagnostic.fix(fix.unsafe_if(true))
            }
            _ => diagnostic,
        };
        report(self.diagnostics, diagnostic);
        None
    }

    fn begins_clause(&self, name: Name) -> bool {
        let word = self.word_of(name);
        CLAUSES.iter().any(|clause| clause.word == word)
    }

    pub(super) fn next_is(&mut self, word: &str) -> bool {
        let Some(&&Term::Word(name)) = self.terms.peek() else {
            return false;
        };
        let is_next = self.word_of(name) == word;
        if is_next {
            self.place = name.span;
            self.terms.next();
        }
        is_next
    }

    pub(super) fn once(&mut self, seen: &mut Vec<Name>, name: Name) {
        if let Some(old) = seen.iter().find(|old| old.symbol == name.symbol) {
            let word = self.word_of(name);
            let diagnostic =
                Diagnostic::new(Code::DuplicateTerm, format!("`{word}` is given twice"))
                    .label(self.location(name.span), "second value")
                    .label(self.location(old.span), "first value")
                    .help("remove one of them");
            report(self.diagnostics, diagnostic);
        }
        seen.push(name);
    }
}
