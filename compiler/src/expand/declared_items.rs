//! Declared patterns and shapes, looked up by definition.
use rustc_hash::FxHashMap;
use stochc_grammar::tree::{Item, ItemKind, Name, Pattern, Shape};
use stochc_grammar::{Symbol, Symbols};

use super::duplicate;
use crate::diagnostic::Diagnostic;
use crate::names::{Definition, NameKind, Names};
use crate::{FileId, SourceLocation};

/// Maps each definition of a pattern to the pattern and its file.
pub type Patterns<'a> = FxHashMap<Definition, (FileId, &'a Pattern)>;

/// Maps each definition of a shape to the shape and its file.
pub type Shapes<'a> = FxHashMap<Definition, (FileId, &'a Shape)>;

/// Declared patterns and shapes.
#[derive(Clone, Default)]
pub struct DeclaredItems<'a> {
    pub patterns: Patterns<'a>,
    pub shapes: Shapes<'a>,
    /// Location of the latest declaration of each word.
    locations: FxHashMap<(NameKind, Symbol), SourceLocation>,
}

impl<'a> DeclaredItems<'a> {
    /// Adds a pattern or a shape. Ignores other items. Returns an error if its name is already
    /// declared.
    pub fn declare(
        &mut self,
        (file, item): (FileId, &'a Item),
        names: &Names,
        symbols: &Symbols,
    ) -> Option<Diagnostic> {
        let definition = |name: Name| names.definition(file, name.span);
        let (kind, name) = match &item.kind {
            ItemKind::Pattern(pattern) => {
                let name = pattern.name;
                self.patterns.insert(definition(name)?, (file, pattern));
                (NameKind::Pattern, name)
            }
            ItemKind::Shape(shape) => {
                let name = shape.name;
                self.shapes.insert(definition(name)?, (file, shape));
                (NameKind::Shape, name)
            }
            _ => return None,
        };
        let span = name.span;
        let location = SourceLocation { file, span };
        let old = self.locations.insert((kind, name.symbol), location)?;
        let word = symbols.word(name.symbol);
        Some(duplicate(word, old, location, item.noun(), symbols))
    }
}
