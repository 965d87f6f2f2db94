//! Reports names that are unknown or have the wrong kind.
use stochc_grammar::tree::{Item, ItemKind, Name};
use stochc_grammar::{Span, Symbol};

use super::expander::Expander;
use super::scope::BoundValue;
use crate::SourceLocation;
use crate::diagnostic::{Code, Diagnostic, parameter_hint, suggestion};
use crate::names::ValueKind;

impl Expander<'_, '_> {
    /// Reports a name whose kind is not the required one.
    pub(super) fn wrong_kind(&mut self, named: Name, value: BoundValue, needed: ValueKind) {
        let name = self.symbols.word(named.symbol);
        let given = value.kind().map_or("something else", ValueKind::noun);
        let (title, label) = if value.kind() == Some(needed) {
            (
                format!("`{name}` is one block and has no indices"),
                "an index after a single block".to_owned(),
            )
        } else {
            (
                format!(
                    "expected {}, found {} `{name}`",
                    needed.noun(),
                    given.replacen("a ", "the ", 1)
                ),
                format!("{} must stand here", needed.noun()),
            )
        };
        let mut diagnostic = Diagnostic::new(Code::WrongKind, title)
            .label(self.location(named.span), label)
            .help(match needed {
                ValueKind::Face => "write up, down, north, south, east or west".to_owned(),
                _ => format!(
                    "rename one of the two: `{name}` cannot be {given} and {}",
                    needed.noun()
                ),
            });
        let definition = self.names.definition(self.file, named.span);
        let known = definition.and_then(|definition| self.scope.get(named.symbol, definition));
        if let Some((_, location)) = known {
            diagnostic = diagnostic.label(location, format!("`{name}` is declared as {given}"));
        }
        self.diagnostics.push(self.in_instance(diagnostic));
        if let Some(definition) = definition {
            self.scope.forget(named.symbol, definition);
        }
    }

    /// Reports a word that is not the name of a number here.
    pub(super) fn unknown_number(&mut self, word: Symbol, span: Span) {
        let name = self.symbols.word(word);
        let location = self.location(span);
        let diagnostic = if let Some((let_, named)) = self.let_below(word) {
            let diagnostic =
                Diagnostic::about(Code::UnknownName, "`{}` is used before its `let`", &[name]);
            if let_.file == location.file && (let_.span.start..let_.span.end).contains(&span.start)
            {
                (diagnostic.label(location, "it is part of its own value"))
                    .help("give it a value that does not contain it")
            } else {
                (diagnostic
                    .label(location, "used here")
                    .label(named, "declared here"))
                .help("move the `let` above its use")
            }
        } else if let Some((around, grown)) = self.scope.any(word).zip(self.grown()) {
            let pattern = self.symbols.word(grown.pattern);
            Diagnostic::about(
                Code::UnknownName,
                "pattern `{}` cannot use the number `{}`",
                &[pattern, name],
            )
            .label(location, "unknown inside the pattern")
            .label(around, "declared outside the pattern")
            .help(parameter_hint(self.sources, &grown, name, name))
        } else {
            let known = self.scope.words().map(|word| self.symbols.word(word));
            Diagnostic::about(Code::UnknownName, "cannot find number `{}`", &[name])
                .label(location, "no `let`, counter or parameter has this name")
                .suggest(location, suggestion(self.diagnostics, name, known), || {
                    format!("declare it: `let {name} = 3`")
                })
        };
        self.diagnostics.push(diagnostic);
    }

    /// Returns the instance that is being expanded. Returns `None` outside of all instances.
    pub(super) fn grown(&self) -> Option<crate::expanded::PatternInstance> {
        let number = (self.scope.instance as usize).checked_sub(1)?;
        self.plan.grown.get(number).copied()
    }

    /// Returns the locations of a `let` that declares this word below its use, and of the name in
    /// it. Returns `None` if there is no such `let`.
    ///
    /// Searches the blocks of statements around the current statement, then the top level of the
    /// files.
    fn let_below(&self, word: Symbol) -> Option<(SourceLocation, SourceLocation)> {
        let names = |item: &Item| match &item.kind {
            ItemKind::Let(let_) if let_.name.symbol == word => Some((item.span, let_.name.span)),
            _ => None,
        };
        let own = self.plan.location.file;
        for (number, block) in self.blocks.iter().enumerate().rev() {
            // The outermost block belongs to the assembly, all others to the pattern that is being
            // expanded.
            let file = if number == 0 { own } else { self.file };
            if let Some((item, name)) = block.iter().find_map(names) {
                let location = |span| SourceLocation { file, span };
                return Some((location(item), location(name)));
            }
        }
        self.lets.iter().find_map(|&(file, item)| {
            let (item, name) = names(item)?;
            let location = |span| SourceLocation { file, span };
            Some((location(item), location(name)))
        })
    }
}
