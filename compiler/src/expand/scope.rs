//! What the words of a program stand for.
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use stochc_grammar::Symbol;
use stochc_ir::Face;

use crate::Site;
use crate::plan::Key;

/// What a word stands for, other than a block of its own name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(i64),
    /// A block given to a pattern.
    Block(Key),
    /// A face given to a pattern.
    Face(Face),
    /// Something that could not be worked out; it has been told of.
    Unknown,
}

#[derive(Clone, Copy, Debug)]
struct Binding {
    value: Value,
    site: Site,
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
    /// Words of the outer instance that an instance does not see: bindings below this level,
    /// except those of the file.
    floor: u32,
    /// The instance whose names are spoken of.
    pub instance: u32,
}

/// The state to which the end of a block returns.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    defined: usize,
    level: u32,
    floor: u32,
    instance: u32,
}

impl Scope {
    /// Opens a block.
    pub fn mark(&mut self) -> Mark {
        let mark = Mark {
            defined: self.defined.len(),
            level: self.level,
            floor: self.floor,
            instance: self.instance,
        };
        self.level += 1;
        mark
    }

    /// Opens an instance, which sees its own words and those of the whole assembly.
    pub fn enter_instance(&mut self, instance: u32) -> Mark {
        let mark = self.mark();
        self.floor = self.level;
        self.instance = instance;
        mark
    }

    /// Closes a block or instance.
    pub fn restore(&mut self, mark: Mark) {
        for word in self.defined.drain(mark.defined..) {
            if let Some(bindings) = self.words.get_mut(&word) {
                bindings.pop();
            }
        }
        self.level = mark.level;
        self.floor = mark.floor;
        self.instance = mark.instance;
    }

    /// Gives a word a value; the place of the old one if it has one in this very block.
    pub fn define(&mut self, word: Symbol, value: Value, site: Site) -> Option<Site> {
        let bindings = self.words.entry(word).or_default();
        let old = bindings.last().filter(|old| old.level == self.level);
        let old = old.map(|old| old.site);
        bindings.push(Binding {
            value,
            site,
            level: self.level,
        });
        self.defined.push(word);
        old
    }

    /// Makes a parameter or counter stand for nothing that is known, once it has been told of.
    pub fn forget(&mut self, word: Symbol) {
        let floor = self.floor;
        let last = self
            .words
            .get_mut(&word)
            .and_then(|bindings| bindings.last_mut());
        if let Some(binding) = last.filter(|binding| binding.level >= floor && floor > 0) {
            binding.value = Value::Unknown;
        }
    }

    /// What a word stands for.
    pub fn get(&self, word: Symbol) -> Option<Value> {
        self.visible(word).map(|binding| binding.value)
    }

    fn visible(&self, word: Symbol) -> Option<&Binding> {
        /// The levels of the file and of the assembly.
        const GLOBAL: u32 = 1;
        let bindings = self.words.get(&word)?;
        let visible = |binding: &&Binding| binding.level >= self.floor || binding.level <= GLOBAL;
        bindings.iter().rev().find(visible)
    }

    /// Where a word has got the value that it has here.
    pub fn site(&self, word: Symbol) -> Option<Site> {
        self.visible(word).map(|binding| binding.site)
    }

    /// Where a word has got a value that an instance does not see.
    pub fn hidden(&self, word: Symbol) -> Option<Site> {
        let last = self.words.get(&word)?.last()?;
        self.visible(word).is_none().then_some(last.site)
    }

    /// Every word that stands for a number, for suggestions.
    pub fn words(&self) -> impl Iterator<Item = Symbol> {
        self.words
            .iter()
            .filter(|(_, bindings)| !bindings.is_empty())
            .map(|(&word, _)| word)
    }
}
