//! Values of numbers, counters and parameters during the expansion. `names` resolves the words.
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use stochc_grammar::Symbol;
use stochc_ir::Face;

use crate::SourceLocation;
use crate::expanded::NameKey;
use crate::names::{Definition, ValueKind};

/// Value of a word that does not name a block directly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoundValue {
    Number(i64),
    /// A block, as an argument.
    Block(NameKey),
    /// A face, as an argument.
    Face(Face),
    /// Unknown because of an error, which has been reported.
    Unknown,
}

impl BoundValue {
    /// Returns the kind, if the value is known.
    pub fn kind(self) -> Option<ValueKind> {
        match self {
            BoundValue::Block(_) => Some(ValueKind::Block),
            BoundValue::Number(_) => Some(ValueKind::Number),
            BoundValue::Face(_) => Some(ValueKind::Face),
            BoundValue::Unknown => None,
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Binding {
    definition: Option<Definition>,
    value: BoundValue,
    location: SourceLocation,
    /// Nesting level of the block of statements that defines the word.
    level: u32,
}

/// Values of words, looked up by block of statements.
#[derive(Debug, Default)]
pub struct Scope {
    words: FxHashMap<Symbol, SmallVec<[Binding; 1]>>,
    /// Defined words in order. The end of a block of statements removes the words that it defines.
    defined: Vec<Symbol>,
    level: u32,
    /// Nesting level of the current instance's body. 0 outside of instances.
    floor: u32,
    /// Number of the current instance.
    pub instance: u32,
}

/// State that is restored at the end of a block of statements.
#[derive(Clone, Copy, Debug)]
pub struct ScopeMark {
    defined: usize,
    level: u32,
    floor: u32,
    instance: u32,
}

impl Scope {
    /// Opens a block of statements and returns a mark to close it.
    pub fn mark(&mut self) -> ScopeMark {
        let mark = ScopeMark {
            defined: self.defined.len(),
            level: self.level,
            floor: self.floor,
            instance: self.instance,
        };
        self.level += 1;
        mark
    }

    /// Opens the body of an instance and returns a mark to close it.
    pub fn enter_instance(&mut self, instance: u32) -> ScopeMark {
        let mark = self.mark();
        self.floor = self.level;
        self.instance = instance;
        mark
    }

    /// Closes a block of statements or an instance.
    pub fn restore(&mut self, mark: ScopeMark) {
        for word in self.defined.drain(mark.defined..) {
            if let Some(bindings) = self.words.get_mut(&word) {
                bindings.pop();
            }
        }
        self.level = mark.level;
        self.floor = mark.floor;
        self.instance = mark.instance;
    }

    /// Sets the value of a definition. Returns the location of its previous value in the same block
    /// of statements, if there is one.
    pub fn define(
        &mut self,
        (word, definition): (Symbol, Option<Definition>),
        value: BoundValue,
        location: SourceLocation,
    ) -> Option<SourceLocation> {
        let bindings = self.words.entry(word).or_default();
        let old = bindings.last().filter(|old| old.level == self.level);
        let old = old.map(|old| old.location);
        bindings.push(Binding {
            definition,
            value,
            location,
            level: self.level,
        });
        self.defined.push(word);
        old
    }

    /// Makes a parameter or counter unknown after an error.
    pub fn forget(&mut self, word: Symbol, definition: Definition) {
        let floor = self.floor;
        let bindings = self.words.get_mut(&word).into_iter().flatten();
        let last = bindings.rev().find(|it| it.definition == Some(definition));
        if let Some(binding) = last.filter(|binding| binding.level >= floor && floor > 0) {
            binding.value = BoundValue::Unknown;
        }
    }

    /// Returns the value of a definition, and the location of that value. Returns `None` if the
    /// definition has no value in the current scope.
    pub fn get(
        &self,
        word: Symbol,
        definition: Definition,
    ) -> Option<(BoundValue, SourceLocation)> {
        let mut bindings = self.words.get(&word)?.iter().rev();
        let binding = bindings.find(|it| it.definition == Some(definition))?;
        Some((binding.value, binding.location))
    }

    /// Returns the location of any definition of a word. Returns `None` if the word is not defined.
    pub fn any(&self, word: Symbol) -> Option<SourceLocation> {
        Some(self.words.get(&word)?.last()?.location)
    }

    /// Returns every word that names a number, for suggestions.
    pub fn words(&self) -> impl Iterator<Item = Symbol> {
        self.words
            .iter()
            .filter(|(_, bindings)| !bindings.is_empty())
            .map(|(&word, _)| word)
    }
}
