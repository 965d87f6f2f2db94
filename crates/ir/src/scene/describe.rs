//! Description of a scene, term by term.
use serde::Serialize;

use super::Scene;
use super::dimensionless::BlockUnits;
use super::quantity::QuantityKind;
use super::schema::{CLAUSES, Equation, EquationSymbol, SchemaEntry, SchemaPart};

/// Term of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedTerm {
    /// Clause of the term, such as `drag`.
    pub clause: &'static str,
    /// The clause as source text, with all its fields.
    pub text: String,
    /// Physical laws of the term, at least one.
    pub laws: Vec<DescribedLaw>,
}

/// Physical law of a term.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedLaw {
    /// Description of the law.
    pub meaning: &'static str,
    /// Equation in the symbols of the values, in plain text. `None` if the law has no equation.
    pub equation: Option<&'static str>,
    /// Values in the law.
    pub values: Vec<DescribedValue>,
}

/// Value of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DescribedValue {
    /// Symbol in equations. Empty if no equation contains the value.
    pub symbol: &'static str,
    /// Name of the value.
    pub name: &'static str,
    /// Value in SI units, or in ticks.
    pub si: f64,
    /// Unit of `si`. Empty for a dimensionless number.
    pub unit: &'static str,
    /// Value in block units: the block length a, the mass m and the tick τ are 1.
    pub block: f64,
    /// Unit of the value in block units. Empty for a dimensionless number.
    pub block_unit: &'static str,
    /// Origin of a computed default. `None` if the scene gives the value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub default: Option<&'static str>,
}

/// Term that a scene does not have.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AbsentTerm {
    /// Clause that would add the term.
    pub clause: String,
    /// Consequence of the missing term, as part of a sentence.
    pub meaning: &'static str,
}

/// Returns the terms of a scene, in the order of the language reference.
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

/// Returns the terms that a scene does not have.
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

/// Adds the optional fields of an entry that are missing in the scene. `within` is the text before
/// the braces of the entry.
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

/// Returns an entry as source text, with all fields that the scene has.
fn written(entry: &SchemaEntry, scene: &Scene) -> String {
    let mut out = entry.word.to_owned();
    let all = |entries: &[SchemaEntry]| -> Vec<String> {
        let present = entries.iter().filter(|entry| entry.is_in(scene));
        present.map(|entry| written(entry, scene)).collect()
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
    // A zero takes the unit of the upper end.
    let unit = if low == 0.0 {
        QuantityKind::NUMBER
    } else {
        kind
    };
    format!("{} .. {}", unit.write(low), kind.write(high))
}

/// Collects the laws of an entry. If the entry has several kinds, also collects the laws of the
/// kind in the scene.
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
        let mut default = None;
        let (kind, symbol, name, si) = match symbol {
            EquationSymbol::Number(it) => (it.kind, it.symbol, it.label, it.get(scene)?),
            EquationSymbol::Default(it, computed) => {
                let given = it.get(scene);
                default = given.is_none().then_some(computed.source);
                let value = given.or_else(|| (computed.of)(scene))?;
                (it.kind, it.symbol, it.label, value)
            }
            EquationSymbol::Derived(it) => (it.kind, it.symbol, it.label, (it.of)(scene)?),
        };
        Some(DescribedValue {
            symbol,
            name,
            si,
            unit: kind.unit,
            block: (kind.in_block_units)(units, si),
            block_unit: kind.block_unit,
            default,
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
