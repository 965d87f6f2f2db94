//! Reads scenes according to the schema.
mod value;
mod word;

#[cfg(test)]
mod tests;

use stochc_grammar::tree::{Name, Term};
use stochc_grammar::{Span, Symbols};
use stochc_ir::scene::Scene;
use stochc_ir::scene::schema::{
    self, Absent, CLAUSES, Either, FieldAlternative, FieldGroup, REQUIREMENTS, SchemaEntry,
    SchemaNumber, SchemaPart,
};
use stochc_text::series;

use crate::diagnostic::{Code, Diagnostic, Fix, report};
use crate::{FileId, SourceLocation};

/// Reads a scene and applies it to its base.
///
/// Returns `None` if the scene has errors, which have been reported.
pub fn read(
    scene: &stochc_grammar::tree::SceneDeclaration,
    base: Option<Scene>,
    file: FileId,
    symbols: &Symbols,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Scene> {
    let before = diagnostics.len();
    let is_derived = base.is_some();
    let mut draft = base.unwrap_or_else(schema::unspecified);
    symbols.word(scene.name.symbol).clone_into(&mut draft.name);
    let mut reader = SceneReader {
        terms: scene.terms.iter().peekable(),
        place: scene.name.span,
        file,
        symbols,
        diagnostics,
    };
    let mut seen: Vec<Name> = Vec::new();
    let mut wrong: Vec<&str> = Vec::new();
    while let Some((name, clause)) = reader.head(&CLAUSES, "clause of a scene", &seen) {
        reader.once(&mut seen, name);
        let mut content = ClauseContent::default();
        match reader.entry(name, clause, &mut content) {
            Some(()) => content.put(&mut draft),
            None => wrong.push(clause.word),
        }
    }
    reader.requirements(&draft, &seen, &wrong);
    if !is_derived {
        wrong.extend(reader.missing_clauses(scene.name, &seen));
    }
    (wrong.is_empty() && diagnostics.len() == before).then_some(draft)
}

/// Content of a clause whose kind is not known yet.
#[derive(Default)]
struct ClauseContent {
    makes: Vec<fn(&mut Scene)>,
    numbers: Vec<(&'static SchemaNumber, f64)>,
}

impl ClauseContent {
    fn put(self, scene: &mut Scene) {
        for make in self.makes {
            make(scene);
        }
        for (number, value) in self.numbers {
            number.put(scene, value);
        }
    }
}

struct SceneReader<'a, 'f> {
    terms: std::iter::Peekable<std::slice::Iter<'a, Term>>,
    /// Location of the last word, for messages about a missing word after it.
    place: Span,
    file: FileId,
    symbols: &'a Symbols,
    diagnostics: &'f mut Vec<Diagnostic>,
}

impl<'a> SceneReader<'a, '_> {
    /// Reads the rest of an entry in `clause`. Returns `None` if it has errors, which have been
    /// reported.
    fn entry(
        &mut self,
        clause: Name,
        entry: &'static SchemaEntry,
        content: &mut ClauseContent,
    ) -> Option<()> {
        content.makes.push(entry.make);
        let mut read_all = Some(());
        for part in entry.parts {
            let read = match part {
                SchemaPart::Number(number) => self.number(number, content),
                SchemaPart::Range { low, high } => self.range(low, high, content),
                SchemaPart::OneOf { noun, of } => match self.kind(of, noun) {
                    Some(kind) => self.entry(clause, kind, content),
                    None => {
                        self.skip(of, entry)?;
                        None
                    }
                },
                SchemaPart::Then(then) => self.then(clause, then, content),
                SchemaPart::Fields(fields, group) => self.fields(clause, fields, group, content),
            };
            read_all = read_all.and(read);
        }
        read_all
    }

    /// Skips the fields of an unknown kind. Returns `None` if the rest of `entry` is missing.
    fn skip(&mut self, kinds: &[SchemaEntry], entry: &SchemaEntry) -> Option<()> {
        match self.terms.peek() {
            Some(Term::Block(..)) if kinds.iter().any(|kind| kind.fields().is_some()) => {
                self.terms.next();
                None
            }
            Some(Term::Quantity(_)) => Some(()),
            _ => entry.fields().map(|_| ()),
        }
    }

    /// Reads an optional keyword with its arguments. Returns `None` and reports an error if it is
    /// wrong.
    fn then(
        &mut self,
        clause: Name,
        then: &'static SchemaEntry,
        content: &mut ClauseContent,
    ) -> Option<()> {
        if self.next_is(then.word) {
            return self.entry(clause, then, content);
        }
        let Absent::Message { title, label, help } = then.absent else {
            return Some(());
        };
        let here = self.terms.peek().map_or(self.place, |term| span(term));
        self.report(
            Code::MissingTerm,
            title.to_owned(),
            here,
            label,
            help.to_owned(),
        );
        None
    }

    /// Reads the fields in the braces of a clause, in any order. Returns `None` and reports an
    /// error if one is wrong.
    fn fields(
        &mut self,
        clause: Name,
        fields: &'static [SchemaEntry],
        group: &'static FieldGroup,
        content: &mut ClauseContent,
    ) -> Option<()> {
        let Some(Term::Block(terms, span)) = self.terms.peek() else {
            self.without_braces(clause, fields, group);
            return None;
        };
        self.terms.next();
        let before = self.diagnostics.len();
        let mut inner = SceneReader {
            terms: terms.iter().peekable(),
            place: *span,
            file: self.file,
            symbols: self.symbols,
            diagnostics: &mut *self.diagnostics,
        };
        let mut seen: Vec<Name> = Vec::new();
        let mut valid_fields: Vec<&str> = Vec::new();
        while let Some((name, field)) = inner.head(fields, "field", &seen) {
            inner.once(&mut seen, name);
            let mut own = ClauseContent::default();
            if inner.entry(name, field, &mut own).is_some() {
                valid_fields.push(field.word);
                content.makes.append(&mut own.makes);
                content.numbers.append(&mut own.numbers);
            }
        }
        let fits = match group {
            FieldGroup::Free => Some(()),
            FieldGroup::Any { needed, help } => {
                if seen.is_empty() && self.diagnostics.len() == before {
                    let diagnostic = self.without(clause, &[needed]).help(*help);
                    report(self.diagnostics, diagnostic);
                }
                valid_fields.first().map(|_| ())
            }
            FieldGroup::Either(either) => {
                let is_wrong = self.diagnostics.len() > before;
                self.either(clause, either, &seen, is_wrong)
                    .filter(|chosen| valid_fields.contains(&chosen.fields[0]))
                    .map(|chosen| content.makes.push(chosen.make))
            }
        };
        let needed = fields.iter().filter(|field| field.absent.is_needed());
        let needed: Vec<&str> = needed.map(|field| field.word).collect();
        let missing = (needed.iter().copied())
            .filter(|field| named(&seen, field, self.symbols).is_none())
            .collect::<Vec<_>>();
        if !missing.is_empty() {
            let examples = fields.iter().filter(|field| missing.contains(&field.word));
            let examples: Option<Vec<String>> = examples.map(example).collect();
            let mut diagnostic = self.without(clause, &missing);
            if let Some(examples) = examples {
                diagnostic = diagnostic.help(format!("add it, such as `{}`", examples.join("  ")));
            }
            report(self.diagnostics, diagnostic);
        }
        let complete = fits.filter(|()| needed.iter().all(|field| valid_fields.contains(field)));
        self.place = *span;
        complete
    }

    /// Returns the alternative that the given fields select. Reports an error and returns `None` if
    /// they do not select one.
    fn either(
        &mut self,
        clause: Name,
        either: &'static Either,
        seen: &[Name],
        is_wrong: bool,
    ) -> Option<&'static FieldAlternative> {
        let symbols = self.symbols;
        let first = |i: usize| {
            let mut fields = either.of[i].fields.iter();
            fields.find_map(|field| named(seen, field, symbols))
        };
        let chosen = match (first(0), first(1)) {
            (Some(one), Some(other)) => {
                let diagnostic = Diagnostic::new(Code::ConflictingTerms, either.both)
                    .label(self.location(other.span), either.of[1].label)
                    .label(self.location(one.span), either.of[0].label)
                    .help(either.help);
                report(self.diagnostics, diagnostic);
                return None;
            }
            (None, None) if is_wrong => return None,
            (_, None) => &either.of[0],
            (None, Some(_)) => &either.of[1],
        };
        let needed = chosen.fields[0];
        if named(seen, needed, symbols).is_none() {
            let diagnostic = self.without(clause, &[needed]).help(chosen.missing);
            report(self.diagnostics, diagnostic);
            return None;
        }
        Some(chosen)
    }

    /// Reports a clause without braces, with a list of its fields.
    fn without_braces(&mut self, clause: Name, fields: &[SchemaEntry], group: &FieldGroup) {
        let word = self.word_of(clause);
        // One of the alternatives is enough.
        let other: &[&str] = match group {
            FieldGroup::Either(either) => either.of[1].fields,
            FieldGroup::Free | FieldGroup::Any { .. } => &[],
        };
        let shown = words(fields)
            .into_iter()
            .filter(|field| !other.contains(field));
        let shown = shown.collect::<Vec<_>>().join(" ... ");
        let diagnostic = Diagnostic::new(
            Code::MissingTerm,
            format!("`{word}` has no fields in braces"),
        )
        .label(self.location(clause.span), "this clause needs fields")
        .help(format!("write `{word} ... {{ {shown} }}`"));
        let symbols = self.symbols;
        let is = |term: &Term, words: &[SchemaEntry]| matches!(term, Term::Word(name) if words.iter().any(|entry| entry.word == symbols.word(name.symbol)));
        if !(self.terms.peek()).is_some_and(|term| is(term, fields)) {
            return report(self.diagnostics, diagnostic);
        }
        let behind = self.location(Span::new(self.place.end, self.place.end));
        report(
            self.diagnostics,
            diagnostic.fix(Fix::replace(behind, " {", "write the `{`")),
        );
        // The fields of the unknown kind may follow without braces.
        while self.terms.next_if(|term| !is(term, &CLAUSES)).is_some() {}
    }

    /// Returns the error for missing fields of a clause.
    fn without(&self, clause: Name, fields: &[&str]) -> Diagnostic {
        let (word, list) = (self.word_of(clause), quoted(fields));
        let (noun, are) = match fields.len() {
            1 => ("field", "is"),
            _ => ("fields", "are"),
        };
        Diagnostic::new(Code::MissingTerm, format!("`{word}` lacks {list}")).label(
            self.location(clause.span),
            format!("a {noun} of this clause {are} missing"),
        )
    }

    /// Reports and returns the missing clauses of a scene.
    fn missing_clauses(&mut self, scene: Name, seen: &[Name]) -> Vec<&'static str> {
        let examples = CLAUSES.iter().filter_map(|clause| match clause.absent {
            Absent::Example(example) => Some((clause.word, example)),
            _ => None,
        });
        let missing = examples.filter(|(word, _)| named(seen, word, self.symbols).is_none());
        let (words, examples): (Vec<_>, Vec<_>) = missing.unzip();
        if !words.is_empty() {
            let title = format!("scene `{}` lacks {}", self.word_of(scene), quoted(&words));
            let help = format!(
                "add the missing clauses, for instance:\n    {}\nor start from a built-in scene: `scene {} from hemisphere {{ ... }}`",
                examples.join("\n    "),
                self.word_of(scene),
            );
            let label = "every scene needs `tick`, `block`, `free` and `enclosure`";
            self.report(Code::MissingTerm, title, scene.span, label, help);
        }
        words
    }

    /// Checks that the scene has all terms that its other terms require. Clauses in `wrong` have
    /// been reported.
    fn requirements(&mut self, draft: &Scene, seen: &[Name], wrong: &[&str]) {
        let mut reported = wrong.to_vec();
        for it in &REQUIREMENTS {
            if reported.contains(&it.clause) || wrong.contains(&it.needs) || !(it.is_broken)(draft)
            {
                continue;
            }
            reported.push(it.clause);
            let name = named(seen, it.clause, self.symbols);
            let span = name.map_or(self.place, |name| name.span);
            let (title, help) = (it.title.to_owned(), it.help.to_owned());
            self.report(Code::MissingTerm, title, span, it.label, help);
        }
    }

    fn report(&mut self, code: Code, title: String, span: Span, label: &str, help: String) {
        let location = self.location(span);
        report(
            self.diagnostics,
            Diagnostic::new(code, title)
                .label(location, label)
                .help(help),
        );
    }

    fn word_of(&self, name: Name) -> &'a str {
        self.symbols.word(name.symbol)
    }

    fn location(&self, span: Span) -> SourceLocation {
        SourceLocation {
            file: self.file,
            span,
        }
    }
}

/// Returns the first of these names with this word. Returns `None` if there is none.
fn named(names: &[Name], word: &str, symbols: &Symbols) -> Option<Name> {
    let mut names = names.iter().copied();
    names.find(|name| symbols.word(name.symbol) == word)
}

/// Returns words in backticks as a list: `a`, `b` and `c`.
fn quoted(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
    series(&quoted, "and")
}

/// Returns an example of a field with a unit, such as `side 20cm`. Returns `None` for a field
/// without a single number.
fn example(field: &SchemaEntry) -> Option<String> {
    let SchemaPart::Number(number) = field.parts.first()? else {
        return None;
    };
    let example = number.kind.noun.split('`').nth(1)?;
    (field.parts.len() == 1).then(|| format!("{} {example}", field.word))
}

fn words(entries: &[SchemaEntry]) -> Vec<&'static str> {
    entries.iter().map(|entry| entry.word).collect()
}

fn span(term: &Term) -> Span {
    match term {
        Term::Word(name) => name.span,
        Term::Quantity(quantity) => quantity.span,
        Term::Range(first, last) => first.span.to(last.span),
        Term::Block(_, span) => *span,
    }
}
