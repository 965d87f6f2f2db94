//! What a scene may say, as data: its words, numbers, equations and conditions.
//!
//! The reader, the writer and the descriptions of scenes, sweeps, editors and the reference of the language follow
//! these tables; none of them knows a term of its own.
mod clauses;
mod equations;
mod number;
pub mod numbers;
mod reference;
mod requirements;

pub use clauses::{CLAUSES, unsaid};
pub use equations::{Derived, Equation, EquationSymbol};
pub use number::{Range, SchemaNumber};
pub use requirements::{REQUIREMENTS, Requirement};

use super::Scene;

/// A word of a scene, and what stands behind it: a clause, the kind of one, or a field.
#[derive(Debug)]
pub struct SchemaEntry {
    /// The word.
    pub word: &'static str,
    /// What it means, as a clause; empty: its numbers say it all.
    pub meaning: &'static str,
    /// What stands behind it, one after the other.
    pub parts: &'static [SchemaPart],
    /// What holds where it is absent.
    pub absent: Absent,
    /// What it makes a runtime compute.
    pub equations: &'static [&'static Equation],
    /// Makes a place for its numbers in a scene, not numbers all.
    pub make: fn(&mut Scene),
    /// Whether a scene says it; `None`: where it has the numbers of it that it needs.
    is: Option<fn(&Scene) -> bool>,
}

/// What may stand behind a word.
#[derive(Debug)]
pub enum SchemaPart {
    /// A value.
    Number(&'static SchemaNumber),
    /// A range of values, or a single one.
    Range {
        /// The lower end.
        low: &'static SchemaNumber,
        /// The upper end.
        high: &'static SchemaNumber,
    },
    /// One of several words.
    OneOf {
        /// What they are the kinds of.
        noun: &'static str,
        /// The words.
        of: &'static [SchemaEntry],
    },
    /// A further word, and what belongs to it.
    Then(&'static SchemaEntry),
    /// Words between braces, in any order, each once.
    Fields(&'static [SchemaEntry], FieldGroup),
}

/// Which fields go with each other.
#[derive(Debug)]
pub enum FieldGroup {
    /// Each as it likes.
    Free,
    /// At least one.
    Any {
        /// The one that is asked for where there is none.
        needed: &'static str,
        /// What to do then.
        help: &'static str,
    },
    /// One of two alternatives.
    Either(&'static Either),
}

/// Fields that are alternatives.
#[derive(Debug)]
pub struct Either {
    /// The two of them.
    pub of: [FieldAlternative; 2],
    /// What it is to say both, as a title.
    pub both: &'static str,
    /// What to do about that.
    pub help: &'static str,
}

/// Fields of which the first is needed, if any of them is there.
#[derive(Debug)]
pub struct FieldAlternative {
    /// Their words.
    pub fields: &'static [&'static str],
    /// What they say.
    pub label: &'static str,
    /// What to do where the first is missing.
    pub missing: &'static str,
    /// Makes a place for them in a scene.
    pub make: fn(&mut Scene),
}

/// What holds where a word is absent.
#[derive(Clone, Copy, Debug)]
pub enum Absent {
    /// Nothing: it is needed.
    Needed,
    /// Nothing: every scene needs it, such as this.
    Example(&'static str),
    /// Nothing: it is needed, and asked for in words of its own.
    Message {
        /// What is wrong.
        title: &'static str,
        /// What belongs there.
        label: &'static str,
        /// What to do about it.
        help: &'static str,
    },
    /// A default.
    Default(&'static str),
    /// A term does not exist: what that means.
    NoTerm(&'static str),
    /// The same, but in some scenes nobody would expect it.
    NoTermWhere(&'static str, fn(&Scene) -> bool),
}

impl Absent {
    /// Whether the word has to be there.
    pub fn is_needed(self) -> bool {
        matches!(
            self,
            Absent::Needed | Absent::Example(_) | Absent::Message { .. }
        )
    }

    /// What holds then; `None`: the word is needed.
    pub fn meaning(self) -> Option<&'static str> {
        match self {
            Absent::Default(it) | Absent::NoTerm(it) | Absent::NoTermWhere(it, _) => Some(it),
            Absent::Needed | Absent::Example(_) | Absent::Message { .. } => None,
        }
    }

    /// What it means for a scene that a term does not exist in it.
    pub fn term(self, scene: &Scene) -> Option<&'static str> {
        match self {
            Absent::NoTerm(meaning) => Some(meaning),
            Absent::NoTermWhere(meaning, is_expected) => is_expected(scene).then_some(meaning),
            _ => None,
        }
    }
}

impl SchemaEntry {
    const fn new(word: &'static str, parts: &'static [SchemaPart]) -> SchemaEntry {
        SchemaEntry {
            word,
            meaning: "",
            parts,
            absent: Absent::Needed,
            equations: &[],
            make: |_| {},
            is: None,
        }
    }

    const fn means(self, meaning: &'static str) -> SchemaEntry {
        SchemaEntry { meaning, ..self }
    }

    const fn absent(self, absent: Absent) -> SchemaEntry {
        SchemaEntry { absent, ..self }
    }

    const fn otherwise(self, default: &'static str) -> SchemaEntry {
        self.absent(Absent::Default(default))
    }

    const fn equations(self, equations: &'static [&'static Equation]) -> SchemaEntry {
        SchemaEntry { equations, ..self }
    }

    const fn make(self, make: fn(&mut Scene)) -> SchemaEntry {
        SchemaEntry { make, ..self }
    }

    const fn is(self, is: fn(&Scene) -> bool) -> SchemaEntry {
        SchemaEntry {
            is: Some(is),
            ..self
        }
    }

    /// Whether a scene says it.
    pub fn is_in(&self, scene: &Scene) -> bool {
        let is_said = |part: &SchemaPart| match part {
            SchemaPart::Number(number) | SchemaPart::Range { high: number, .. } => {
                number.get(scene).is_some()
            }
            SchemaPart::OneOf { of, .. } => of.iter().any(|kind| kind.is_in(scene)),
            SchemaPart::Then(then) => !then.absent.is_needed() || then.is_in(scene),
            SchemaPart::Fields(fields, _) => {
                let mut needed = fields.iter().filter(|it| it.absent.is_needed()).peekable();
                match needed.peek() {
                    Some(_) => needed.all(|field| field.is_in(scene)),
                    None => fields.iter().any(|field| field.is_in(scene)),
                }
            }
        };
        self.is
            .map_or_else(|| self.parts.iter().all(is_said), |is| is(scene))
    }

    /// The words between its braces, if it has any.
    pub fn fields(&self) -> Option<(&'static [SchemaEntry], &'static FieldGroup)> {
        self.parts.iter().find_map(|part| match part {
            SchemaPart::Fields(fields, group) => Some((*fields, group)),
            _ => None,
        })
    }

    /// All that may come next behind it, in the order of the reference.
    pub fn words(&self) -> impl Iterator<Item = &'static SchemaEntry> {
        self.parts.iter().flat_map(|part| match part {
            SchemaPart::OneOf { of, .. } => of,
            SchemaPart::Then(entry) => std::slice::from_ref(*entry),
            SchemaPart::Fields(fields, _) => fields,
            SchemaPart::Number(_) | SchemaPart::Range { .. } => &[],
        })
    }
}

/// Every number of an entry, in the order of the reference.
pub fn numbers(entry: &SchemaEntry) -> Vec<&'static SchemaNumber> {
    let mut out: Vec<&'static SchemaNumber> = Vec::new();
    for part in entry.parts {
        match part {
            SchemaPart::Number(number) => out.push(number),
            SchemaPart::Range { low, high } => out.extend([high, low]),
            SchemaPart::OneOf { of: more, .. } | SchemaPart::Fields(more, _) => {
                out.extend(more.iter().flat_map(numbers));
            }
            SchemaPart::Then(entry) => out.extend(numbers(entry)),
        }
    }
    out
}

/// Whether a word means something in a scene.
pub fn is_word(word: &str) -> bool {
    fn has(entry: &SchemaEntry, word: &str) -> bool {
        entry.word == word || entry.words().any(|entry| has(entry, word))
    }
    CLAUSES.iter().any(|clause| has(clause, word))
}
