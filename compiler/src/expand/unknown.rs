//! Names that stand for nothing here, or for something else.
use stochc_grammar::tree::{Item, ItemKind, Name};
use stochc_grammar::{Span, Symbol};

use super::Expander;
use super::scope::BoundValue;
use crate::SourceLocation;
use crate::diagnostic::{Code, Diagnostic, meant, parameter_hint};
use crate::names::ValueKind;

impl Expander<'_, '_> {
    /// Tells of a name that stands for something else than what is needed.
    pub(super) fn wrong_kind(&mut self, named: Name, value: BoundValue, needed: ValueKind) {
        let name = self.symbols.word(named.symbol);
        let given = value.kind().map_or("something else", ValueKind::noun);
        let (title, label) = if value.kind() == Some(needed) {
            (
                format!("`{name}` is one block here"),
                "it has no indices".to_owned(),
            )
        } else {
            (
                format!("`{name}` is {given} here, not {}", needed.noun()),
                format!("used as {}", needed.noun()),
            )
        };
        let mut diagnostic = Diagnostic::new(Code::WrongKind, title)
            .label(self.location(named.span), label)
            .help(match needed {
                ValueKind::Face => "a face is one of up, down, north, south, east and west",
                _ => "blocks, numbers and parameters need different names",
            });
        let definition = self.names.definition(self.file, named.span);
        let known = definition.and_then(|definition| self.scope.get(named.symbol, definition));
        if let Some((_, location)) = known {
            diagnostic = diagnostic.label(location, format!("{given} from here on"));
        }
        self.diagnostics.push(self.in_instance(diagnostic));
        if let Some(definition) = definition {
            self.scope.forget(named.symbol, definition);
        }
    }

    /// Tells of a name that no number has here.
    pub(super) fn unknown_number(&mut self, word: Symbol, span: Span) {
        let name = self.symbols.word(word);
        let location = self.location(span);
        let diagnostic = if let Some((let_, named)) = self.let_below(word) {
            let diagnostic = Diagnostic::new(
                Code::UnknownName,
                format!("`{name}` is used before its `let`"),
            );
            if let_.file == location.file && (let_.span.start..let_.span.end).contains(&span.start)
            {
                (diagnostic.label(location, "used in its own value"))
                    .help("give it a value that can be worked out without it")
            } else {
                (diagnostic
                    .label(location, "not known yet")
                    .label(named, "known from here on"))
                .help("move the `let` up: a number is known from its `let` to the end of the block")
            }
        } else if let Some((around, grown)) = self.scope.any(word).zip(self.grown()) {
            let pattern = self.symbols.word(grown.pattern);
            Diagnostic::new(
                Code::UnknownName,
                format!("the pattern `{pattern}` does not see `{name}`"),
            )
            .label(location, "not known inside of the pattern")
            .label(around, "a number around the place where it grows")
            .help(parameter_hint(self.sources, &grown, name, name))
        } else {
            let known = self.scope.words().map(|word| self.symbols.word(word));
            Diagnostic::new(Code::UnknownName, format!("no number is called `{name}`"))
                .label(location, "not known here")
                .suggest(location, meant(self.diagnostics, name, known), || {
                    format!("define it: `let {name} = 3`")
                })
        };
        self.diagnostics.push(diagnostic);
    }

    /// The instance that is being written out.
    pub(super) fn grown(&self) -> Option<crate::plan::PatternInstance> {
        let number = (self.scope.instance as usize).checked_sub(1)?;
        self.plan.grown.get(number).copied()
    }

    /// A `let` of a block around the statement at hand whose name is not known yet, and its name.
    fn let_below(&self, word: Symbol) -> Option<(SourceLocation, SourceLocation)> {
        let names = |item: &Item| match &item.kind {
            ItemKind::Let(let_) if let_.name.symbol == word => Some((item.span, let_.name.span)),
            _ => None,
        };
        let own = self.plan.location.file;
        for (number, block) in self.blocks.iter().enumerate().rev() {
            // The outermost block is that of the assembly, all others are of the pattern that grows.
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
