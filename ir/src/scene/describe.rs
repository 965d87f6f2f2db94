//! A scene term by term: what is in force and what is not.
use serde::Serialize;

use super::Scene;
use super::groups::BlockUnits;
use super::quantity::QuantityKind;
use super::schema::{CLAUSES, Entry, Equation, Part, Symbol};

/// A term that a scene has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Term {
    /// Its clause: `drag`.
    pub clause: &'static str,
    /// The clause as it can be written in a scene, with all its fields.
    pub text: String,
    /// What it makes a runtime compute, at least one.
    pub laws: Vec<Law>,
}

/// One thing that a term does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Law {
    /// In words.
    pub meaning: &'static str,
    /// In the symbols of the values, in plain text; `None`: there is nothing to compute.
    pub equation: Option<&'static str>,
    /// The values in it.
    pub values: Vec<Value>,
}

/// A value of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// What equations call it; empty: it is in none.
    pub symbol: &'static str,
    /// What it is.
    pub name: &'static str,
    /// In SI units, or in ticks.
    pub si: f64,
    /// That unit; empty: a pure number.
    pub unit: &'static str,
    /// In block units: the side a, the mass m and the tick τ are 1.
    pub block: f64,
    /// The unit among those; empty: a pure number.
    pub block_unit: &'static str,
}

/// A term that a scene does not have, and that is not computed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Absent {
    /// What would stand in the scene.
    pub clause: String,
    /// What that means, as a clause.
    pub meaning: &'static str,
}

/// The terms of a scene, in the order of the reference.
pub fn terms(scene: &Scene) -> Vec<Term> {
    let clauses = CLAUSES.iter().filter(|clause| clause.is_in(scene));
    let term = |clause: &Entry| {
        let mut laws = Vec::new();
        collect_laws(clause, scene, &mut laws);
        Term {
            clause: clause.word,
            text: written(clause, scene),
            laws,
        }
    };
    clauses.map(term).collect()
}

/// The terms that a scene could have and does not.
pub fn absent(scene: &Scene) -> Vec<Absent> {
    let mut out = Vec::new();
    for clause in &CLAUSES {
        if clause.is_in(scene) {
            absent_fields(clause, scene, clause.word, &mut out);
        } else if let Some(meaning) = clause.absent.term(scene) {
            let clause = clause.word.to_owned();
            out.push(Absent { clause, meaning });
        }
    }
    out
}

/// The fields that an entry could have and does not; `within` is what stands before its braces.
fn absent_fields(entry: &Entry, scene: &Scene, within: &str, out: &mut Vec<Absent>) {
    for part in entry.parts {
        match part {
            Part::OneOf { of, .. } => {
                for kind in of.iter().filter(|kind| kind.is_in(scene)) {
                    absent_fields(kind, scene, &format!("{within} {}", kind.word), out);
                }
            }
            Part::Fields(fields, _) => {
                out.extend(
                    fields
                        .iter()
                        .filter(|field| !field.is_in(scene))
                        .filter_map(|field| {
                            let clause = format!("{within} {{ {} }}", field.word);
                            let meaning = field.absent.term(scene)?;
                            Some(Absent { clause, meaning })
                        }),
                );
            }
            Part::Number(_) | Part::Range { .. } | Part::Then(_) => {}
        }
    }
}

/// An entry as it can be written, with all that the scene says of it.
fn written(entry: &Entry, scene: &Scene) -> String {
    let mut out = entry.word.to_owned();
    let all = |entries: &[Entry]| -> Vec<String> {
        let said = entries.iter().filter(|entry| entry.is_in(scene));
        said.map(|entry| written(entry, scene)).collect()
    };
    for part in entry.parts {
        let more = match part {
            Part::Number(number) => number.get(scene).map(|value| number.kind.write(value)),
            Part::Range { low, high } => {
                (low.get(scene).zip(high.get(scene))).map(|range| range_of(range, high.kind))
            }
            Part::OneOf { of, .. } => Some(all(of).concat()),
            Part::Then(entry) => entry.is_in(scene).then(|| written(entry, scene)),
            Part::Fields(fields, _) => Some(format!("{{ {} }}", all(fields).join("  "))),
        };
        out.extend(more.iter().flat_map(|more| [" ", more]));
    }
    out
}

fn range_of((low, high): (f64, f64), kind: QuantityKind) -> String {
    if low == high {
        return kind.write(low);
    }
    // A zero has the unit of what it goes up to.
    let unit = if low == 0.0 {
        QuantityKind::NUMBER
    } else {
        kind
    };
    format!("{} .. {}", unit.write(low), kind.write(high))
}

/// What an entry, and the kind of it that the scene has, make a runtime compute.
fn collect_laws(entry: &Entry, scene: &Scene, out: &mut Vec<Law>) {
    out.extend(
        entry
            .equations
            .iter()
            .filter_map(|equation| law(equation, scene)),
    );
    for part in entry.parts {
        if let Part::OneOf { of, .. } = part {
            for kind in of.iter().filter(|kind| kind.is_in(scene)) {
                collect_laws(kind, scene, out);
            }
        }
    }
}

fn law(equation: &Equation, scene: &Scene) -> Option<Law> {
    let units = BlockUnits::of(scene);
    let value = |symbol: &Symbol| {
        let (kind, symbol, name, si) = match symbol {
            Symbol::Number(it) => (it.kind, it.symbol, it.label, it.get(scene)?),
            Symbol::Derived(it) => (it.kind, it.symbol, it.label, (it.of)(scene)?),
        };
        Some(Value {
            symbol,
            name,
            si,
            unit: kind.unit,
            block: (kind.in_block_units)(units, si),
            block_unit: kind.block_unit,
        })
    };
    if !(equation.holds)(scene)
        || equation
            .symbols
            .first()
            .is_some_and(|it| value(it).is_none())
    {
        return None;
    }
    Some(Law {
        meaning: equation.meaning,
        equation: equation.formula,
        values: equation.symbols.iter().filter_map(value).collect(),
    })
}
