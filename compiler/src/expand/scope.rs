//! The values of numbers, counters and parameters while a program is written out; which of them a word means, `names` knows.
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use stochc_grammar::Symbol;
use stochc_ir::Face;

use crate::SourceLocation;
use crate::names::{Definition, ValueKind};
use crate::plan::NameKey;

/// What a word stands for, other than a block of its own name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoundValue {
    /// A number.
    Number(i64),
    /// A block given to a pattern.
    Block(NameKey),
    /// A face given to a pattern.
    Face(Face),
    /// Something that could not be worked out; it has been told of.
    Unknown,
}

impl BoundValue {
    /// Its kind, if it could be worked out.
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
    /// What has the value.
    definition: Option<Definition>,
    value: BoundValue,
    location: SourceLocation,
    /// How many blocks were open when it was made.
    level: u32,
}

/// The words that have a value, by block.
#[derive(Debug, Default)]
pub struct Scope {
    words: FxHashMap<Symbol, SmallVec<[Binding; 1]>>,
    /// The order of definition, so that the end of a block can take its own back.
    defined: Vec<Symbol>,
    level: u32,
    /// The level at which the instance begins; 0: none.
    floor: u32,
    /// The instance whose names are spoken of.
    pub instance: u32,
}

/// The state to which the end of a block returns.
#[derive(Clone, Copy, Debug)]
pub struct ScopeMark {
    defined: usize,
    level: u32,
    floor: u32,
    instance: u32,
}

impl Scope {
    /// Opens a block.
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

    /// Opens an instance.
    pub fn enter_instance(&mut self, instance: u32) -> ScopeMark {
        let mark = self.mark();
        self.floor = self.level;
        self.instance = instance;
        mark
    }

    /// Closes a block or instance.
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

    /// Gives a definition a value, under its word; the place of the old one if the word has one in this very block.
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

    /// Makes a parameter or counter stand for nothing that is known, once it has been told of.
    pub fn forget(&mut self, word: Symbol, definition: Definition) {
        let floor = self.floor;
        let bindings = self.words.get_mut(&word).into_iter().flatten();
        let last = bindings.rev().find(|it| it.definition == Some(definition));
        if let Some(binding) = last.filter(|binding| binding.level >= floor && floor > 0) {
            binding.value = BoundValue::Unknown;
        }
    }

    /// The value of a definition with this word, and where it has got it.
    pub fn get(
        &self,
        word: Symbol,
        definition: Definition,
    ) -> Option<(BoundValue, SourceLocation)> {
        let mut bindings = self.words.get(&word)?.iter().rev();
        let binding = bindings.find(|it| it.definition == Some(definition))?;
        Some((binding.value, binding.location))
    }

    /// Where something with this word, whatever it is, has got a value.
    pub fn any(&self, word: Symbol) -> Option<SourceLocation> {
        Some(self.words.get(&word)?.last()?.location)
    }

    /// Every word that stands for a number, for suggestions.
    pub fn words(&self) -> impl Iterator<Item = Symbol> {
        self.words
            .iter()
            .filter(|(_, bindings)| !bindings.is_empty())
            .map(|(&word, _)| word)
    }
}
