//! Patterns, shapes and scenes by their words.
use rustc_hash::FxHashMap;
use stochc_grammar::Symbol;

use super::{Definition, NameKind};
use crate::{FileId, SourceLocation};

/// A pattern or a shape.
#[derive(Clone, Copy, Debug)]
pub struct DeclaredName {
    pub definition: Definition,
    /// Where it is declared.
    pub location: SourceLocation,
}

/// Those of a block.
pub type DeclaredWords = FxHashMap<(NameKind, Symbol), DeclaredName>;

/// Those of all files and their assemblies.
#[derive(Clone, Debug, Default)]
pub struct DeclaredNames {
    /// Patterns and shapes of the files, which all see.
    pub shared: DeclaredWords,
    /// Patterns and shapes of each assembly, which it alone sees.
    pub own: Vec<DeclaredWords>,
    /// The numbers of the assemblies, by the places of their names.
    pub assemblies: FxHashMap<(FileId, u32), usize>,
    /// Scenes, declared or built in.
    pub scenes: FxHashMap<Symbol, Definition>,
}

impl DeclaredNames {
    /// What a word stands for in an assembly, or outside of all: what the assembly declares hides what the files do.
    pub fn seen_from(
        &self,
        assembly: Option<usize>,
        kind: NameKind,
        word: Symbol,
    ) -> Option<DeclaredName> {
        let own = assembly.and_then(|number| self.own.get(number)?.get(&(kind, word)));
        own.or_else(|| self.shared.get(&(kind, word))).copied()
    }
}
