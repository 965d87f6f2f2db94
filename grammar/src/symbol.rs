use std::hash::BuildHasherDefault;

use rustc_hash::FxHasher;
use string_interner::backend::StringBackend;
use string_interner::symbol::SymbolU32;
use string_interner::{StringInterner, Symbol as _};

/// A word as a number. Valid only with the [`Symbols`] that created it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Symbol(pub u32);

/// Keywords that begin a statement or declaration. Only the last five may be names.
pub const BEGINNINGS: [&str; 19] = [
    "assembly",
    "else",
    "for",
    "if",
    "import",
    "layer",
    "let",
    "pattern",
    "phase",
    "release",
    "scene",
    "seed",
    "shape",
    "yields",
    "aggregate",
    "expect",
    "on",
    "retry",
    "wait",
];

/// Number of the last [`BEGINNINGS`] that may be names.
const SOFT: usize = 5;

/// Keywords within a statement or declaration. Only the last one may be a name.
pub const CONTINUATIONS: [&str; 13] = [
    "after", "and", "as", "at", "from", "in", "mirrored", "not", "or", "plate", "timeout",
    "turned", "to",
];

const FACES: [&str; 6] = ["up", "down", "north", "south", "east", "west"];

/// Number of words that cannot be names.
const RESERVED: usize = BEGINNINGS.len() - SOFT + CONTINUATIONS.len() - 1 + FACES.len();

/// All words of a program's files, without duplicates.
#[derive(Clone, Debug)]
pub struct Symbols(StringInterner<StringBackend<SymbolU32>, BuildHasherDefault<FxHasher>>);

impl Default for Symbols {
    fn default() -> Symbols {
        Symbols::new()
    }
}

impl Symbols {
    /// Creates a table that contains only the reserved words.
    pub fn new() -> Symbols {
        let mut symbols = Symbols(StringInterner::new());
        let (beginnings, _) = BEGINNINGS.split_at(BEGINNINGS.len() - SOFT);
        let [continuations @ .., _] = CONTINUATIONS;
        let beginnings = beginnings.iter().copied();
        for word in beginnings.chain(continuations).chain(FACES) {
            symbols.intern(word);
        }
        symbols
    }

    /// Returns the symbol of `word`.
    pub fn intern(&mut self, word: &str) -> Symbol {
        Symbol(self.0.get_or_intern(word).to_usize() as u32)
    }

    /// Returns the symbol of `word`. Returns `None` if the table does not contain the word.
    pub fn get(&self, word: &str) -> Option<Symbol> {
        self.0
            .get(word)
            .map(|symbol| Symbol(symbol.to_usize() as u32))
    }

    /// Returns the word of a symbol.
    pub fn word(&self, symbol: Symbol) -> &str {
        SymbolU32::try_from_usize(symbol.0 as usize)
            .and_then(|symbol| self.0.resolve(symbol))
            .unwrap_or_default()
    }

    pub(crate) fn is_reserved(&self, symbol: Symbol) -> bool {
        (symbol.0 as usize) < RESERVED
    }

    /// Returns the number of different words.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns `false`, because the table always has the reserved words.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
