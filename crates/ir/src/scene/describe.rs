//! A scene term by term: what is in force and what is not.
use serde::Serialize;

use super::Scene;
use super::groups::BlockUnits;
use super::quantity::QuantityKind;
use super::schema::{CLAUSES, Equation, EquationSymbol, SchemaEntry, SchemaPart};

/// A term that a scene has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedTerm {
    /// Its clause: `drag`.
    pub clause: &'static str,
    /// The clause as it can be written in a scene, with all its fields.
    pub text: String,
    /// What it makes a runtime compute, at least one.
    pub laws: Vec<DescribedLaw>,
}

/// One thing that a term does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedLaw {
    /// In words.
    pub meaning: &'static str,
    /// In the symbols of the values, in plain text; `None`: there is nothing to compute.
    pub equation: Option<&'static str>,
    /// The values in it.
    pub values: Vec<DescribedValue>,
}

/// A value of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedValue {
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
pub struct AbsentTerm {
    /// What would stand in the scene.
    pub clause: String,
    /// What that means, as a clause.
    pub meaning: &'static str,
}

/// The terms of a scene, in the order of the reference.
pub fn terms(scene: &Scene) -> Vec<DescribedTerm> {
    let clauses = CLAUSES.iter().filter(|clause| clause.is_in(scene));
    let term = |clause: &SchemaEntry| {
        let mut laws = Vec::new();
        collect_laws(clause, scene, &mut laws);
        DescribedTerm {
            clause: clause.word,
            text: written(clause, scene),
            laws,
        }
    };
    clauses.map(term).collect()
}

/// The terms that a scene could have and does not.
pub fn absent(scene: &Scene) -> Vec<AbsentTerm> {
    let mut out = Vec::new();
    for clause in &CLAUSES {
        if clause.is_in(scene) {
            absent_fields(clause, scene, clause.word, &mut out);
        } else if let Some(meaning) = clause.absent.term(scene) {
            let clause = clause.word.to_owned();
            out.push(AbsentTerm { clause, meaning });
        }
    }
    out
}

/// The fields that an entry could have and does not; `within` is what stands before its braces.
fn absent_fields(entry: &SchemaEntry, scene: &Scene, within: &str, out: &mut Vec<AbsentTerm>) {
    for part in entry.parts {
        match part {
            SchemaPart::OneOf { of, .. } => {
                for kind in of.iter().filter(|kind| kind.is_in(scene)) {
                    absent_fields(kind, scene, &format!("{within} {}", kind.word), out);
                }
            }
            SchemaPart::Fields(fields, _) => {
                out.extend(
                    fields
                        .iter()
                        .filter(|field| !field.is_in(scene))
                        .filter_map(|field| {
                            let clause = format!("{within} {{ {} }}", field.word);
                            let meaning = field.absent.term(scene)?;
                            Some(AbsentTerm { clause, meaning })
                        }),
                );
            }
            SchemaPart::Number(_) | SchemaPart::Range { .. } | SchemaPart::Then(_) => {}
        }
    }
}

/// An entry as it can be written, with all that the scene says of it.
fn written(entry: &SchemaEntry, scene: &Scene) -> String {
    let mut out = entry.word.to_owned();
    let all = |entries: &[SchemaEntry]| -> Vec<String> {
        let said = entries.iter().filter(|entry| entry.is_in(scene));
        said.map(|entry| written(entry, scene)).collect()
    };
    for part in entry.parts {
        let more = match part {
            SchemaPart::Number(number) => number.get(scene).map(|value| number.kind.write(value)),
            SchemaPart::Range { low, high } => {
                (low.get(scene).zip(high.get(scene))).map(|range| range_of(range, high.kind))
            }
            SchemaPart::OneOf { of, .. } => Some(all(of).concat()),
            SchemaPart::Then(entry) => entry.is_in(scene).then(|| written(entry, scene)),
            SchemaPart::Fields(fields, _) => Some(format!("{{ {} }}", all(fields).join("  "))),
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
fn collect_laws(entry: &SchemaEntry, scene: &Scene, out: &mut Vec<DescribedLaw>) {
    out.extend(
        entry
            .equations
            .iter()
            .filter_map(|equation| law(equation, scene)),
    );
    for part in entry.parts {
        if let SchemaPart::OneOf { of, .. } = part {
            for kind in of.iter().filter(|kind| kind.is_in(scene)) {
                collect_laws(kind, scene, out);
            }
        }
    }
}

fn law(equation: &Equation, scene: &Scene) -> Option<DescribedLaw> {
    let units = BlockUnits::from_scene(scene);
    let value = |symbol: &EquationSymbol| {
        let (kind, symbol, name, si) = match symbol {
            EquationSymbol::Number(it) => (it.kind, it.symbol, it.label, it.get(scene)?),
            EquationSymbol::Derived(it) => (it.kind, it.symbol, it.label, (it.of)(scene)?),
        };
        Some(DescribedValue {
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
    Some(DescribedLaw {
        meaning: equation.meaning,
        equation: equation.formula,
        values: equation.symbols.iter().filter_map(value).collect(),
    })
}
