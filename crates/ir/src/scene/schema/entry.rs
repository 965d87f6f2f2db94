//! Entries of the schema.
use super::equations::Equation;
use super::number::SchemaNumber;
use crate::scene::Scene;

/// Keyword of a scene with its arguments: a clause, a kind of clause, or a field.
#[derive(Debug)]
pub struct SchemaEntry {
    /// Keyword of the entry.
    pub word: &'static str,
    /// Meaning of the keyword, as part of a sentence. Empty if its parameters explain it.
    pub meaning: &'static str,
    /// Arguments of the keyword, in order.
    pub parts: &'static [SchemaPart],
    /// Meaning of a scene without this entry.
    pub absent: Absent,
    /// Physical laws of the entry.
    pub equations: &'static [&'static Equation],
    /// Function that adds the clause to a scene, with parameters not set.
    pub make: fn(&mut Scene),
    /// Function that returns whether a scene has the entry. `None` if the required parameters of
    /// the entry decide this.
    pub(super) is: Option<fn(&Scene) -> bool>,
}

/// Argument of a keyword.
#[derive(Debug)]
pub enum SchemaPart {
    /// A value.
    Number(&'static SchemaNumber),
    /// Range of values, or a single one.
    Range {
        /// Lower end of the range.
        low: &'static SchemaNumber,
        /// Upper end of the range.
        high: &'static SchemaNumber,
    },
    /// One of several keywords.
    OneOf {
        /// Noun for the kinds.
        noun: &'static str,
        /// Keywords to choose from.
        of: &'static [SchemaEntry],
    },
    /// Further keyword with its arguments.
    Then(&'static SchemaEntry),
    /// Fields in braces, in any order, each once.
    Fields(&'static [SchemaEntry], FieldGroup),
}

/// Combination rule for fields.
#[derive(Debug)]
pub enum FieldGroup {
    /// Fields are independent.
    Free,
    /// At least one field is needed.
    Any {
        /// Field that a diagnostic asks for if all fields are missing.
        needed: &'static str,
        /// Help if no field is given.
        help: &'static str,
    },
    /// One of two alternatives.
    Either(&'static Either),
}

/// Two alternatives. A scene may use either, but not both.
#[derive(Debug)]
pub struct Either {
    /// The two alternatives.
    pub of: [FieldAlternative; 2],
    /// Title of the diagnostic if both alternatives are given.
    pub both: &'static str,
    /// Help if both alternatives are given.
    pub help: &'static str,
}

/// Fields of an alternative. If any field is given, the first one is required.
#[derive(Debug)]
pub struct FieldAlternative {
    /// Keywords of the alternative.
    pub fields: &'static [&'static str],
    /// Label for these fields.
    pub label: &'static str,
    /// Help of the diagnostic if the first field is missing.
    pub missing: &'static str,
    /// Function that adds the fields to a scene.
    pub make: fn(&mut Scene),
}

/// Meaning of an absent keyword.
#[derive(Clone, Copy, Debug)]
pub enum Absent {
    /// The entry is required.
    Needed,
    /// The entry is required in every scene. Contains an example.
    Example(&'static str),
    /// The entry is required. Contains a specific message.
    Message {
        /// Title of the diagnostic.
        title: &'static str,
        /// Label of the message.
        label: &'static str,
        /// Help of the message.
        help: &'static str,
    },
    /// The default value applies.
    Default(&'static str),
    /// The term does not exist, with this consequence.
    NoTerm(&'static str),
    /// The term does not exist, with this consequence. Mentioned only for scenes that fulfil the
    /// condition.
    NoTermWhere(&'static str, fn(&Scene) -> bool),
}

impl Absent {
    /// Returns whether the keyword is required.
    pub fn is_needed(self) -> bool {
        matches!(
            self,
            Absent::Needed | Absent::Example(_) | Absent::Message { .. }
        )
    }

    /// Returns the meaning of the absent keyword, or `None` if the keyword is required.
    pub fn meaning(self) -> Option<&'static str> {
        match self {
            Absent::Default(it) | Absent::NoTerm(it) | Absent::NoTermWhere(it, _) => Some(it),
            Absent::Needed | Absent::Example(_) | Absent::Message { .. } => None,
        }
    }

    /// Returns the consequence of the missing term for a scene. Returns `None` if the consequence
    /// is not mentioned.
    pub fn term(self, scene: &Scene) -> Option<&'static str> {
        match self {
            Absent::NoTerm(meaning) => Some(meaning),
            Absent::NoTermWhere(meaning, is_expected) => is_expected(scene).then_some(meaning),
            _ => None,
        }
    }
}

impl SchemaEntry {
    pub(super) const fn new(word: &'static str, parts: &'static [SchemaPart]) -> SchemaEntry {
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

    pub(super) const fn means(self, meaning: &'static str) -> SchemaEntry {
        SchemaEntry { meaning, ..self }
    }

    pub(super) const fn absent(self, absent: Absent) -> SchemaEntry {
        SchemaEntry { absent, ..self }
    }

    pub(super) const fn otherwise(self, default: &'static str) -> SchemaEntry {
        self.absent(Absent::Default(default))
    }

    pub(super) const fn equations(self, equations: &'static [&'static Equation]) -> SchemaEntry {
        SchemaEntry { equations, ..self }
    }

    pub(super) const fn make(self, make: fn(&mut Scene)) -> SchemaEntry {
        SchemaEntry { make, ..self }
    }

    pub(super) const fn is(self, is: fn(&Scene) -> bool) -> SchemaEntry {
        SchemaEntry {
            is: Some(is),
            ..self
        }
    }

    /// Returns whether a scene has the entry.
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

    /// Returns the fields in the braces of the entry. Returns `None` if it has no braces.
    pub fn fields(&self) -> Option<(&'static [SchemaEntry], &'static FieldGroup)> {
        self.parts.iter().find_map(|part| match part {
            SchemaPart::Fields(fields, group) => Some((*fields, group)),
            _ => None,
        })
    }

    /// Returns all keywords that may follow, in the order of the language reference.
    pub fn words(&self) -> impl Iterator<Item = &'static SchemaEntry> {
        self.parts.iter().flat_map(|part| match part {
            SchemaPart::OneOf { of, .. } => of,
            SchemaPart::Then(entry) => std::slice::from_ref(*entry),
            SchemaPart::Fields(fields, _) => fields,
            SchemaPart::Number(_) | SchemaPart::Range { .. } => &[],
        })
    }
}
