//! Declared patterns, shapes and scenes by word.
use rustc_hash::FxHashMap;
use stochc_grammar::Symbol;

use super::{Definition, NameKind};
use crate::{FileId, SourceLocation};

#[derive(Clone, Copy, Debug)]
pub struct DeclaredName {
    pub definition: Definition,
    pub location: SourceLocation,
}

/// Words that a block declares: patterns and shapes.
pub type DeclaredWords = FxHashMap<(NameKind, Symbol), DeclaredName>;

/// Declared patterns, shapes and scenes of all files, including declarations inside assemblies.
#[derive(Clone, Debug, Default)]
pub struct DeclaredNames {
    /// Patterns and shapes of the files, for all programs.
    pub shared: DeclaredWords,
    /// Patterns and shapes inside each assembly. Only that assembly can use them.
    pub own: Vec<DeclaredWords>,
    /// Indices of the assemblies by the locations of their names.
    pub assemblies: FxHashMap<(FileId, u32), usize>,
    /// Scenes, declared or built in.
    pub scenes: FxHashMap<Symbol, Definition>,
}

impl DeclaredNames {
    /// Returns the declaration of a word in an assembly, or outside of every assembly. Declarations
    /// of the assembly hide declarations of the files. Returns `None` if the word is not declared.
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
