//! Programs that are the same but for one number of their scenes.
use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::contrast::Clock;
use super::subject::Subject;
use crate::ensemble::Time;

/// A number of a scene that was varied, and what became of the times.
#[derive(Clone, Debug)]
pub(super) struct Sweep {
    /// Which number, such as `contact.friction`; values are in SI units.
    pub of: String,
    /// One for each program that was run with several values.
    pub curves: Vec<Curve>,
}

/// One program at several values.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// Its name.
    pub name: String,
    /// Value, number of the program in the report, time to completion; by value.
    pub points: Vec<(f64, usize, Time)>,
}

/// A program's number in the report, and the numbers of its scene by where they stand.
type Member = (usize, BTreeMap<String, f64>);

/// What has to be the same for a number to be all that differs.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Kind<'a> {
    tables: &'a str,
    model: &'a str,
    substeps: u32,
    settings: &'a BTreeMap<String, String>,
    max_ticks: Option<u64>,
    words: BTreeMap<String, String>,
}

/// Finds what was varied, a sweep for each number.
pub(super) fn sweeps(subjects: &[Subject], clock: Clock) -> Vec<Sweep> {
    let mut groups: BTreeMap<Kind, Vec<Member>> = BTreeMap::new();
    for (i, subject) in subjects.iter().enumerate() {
        let Some(tables) = &subject.events.tables else {
            continue;
        };
        let (mut numbers, mut words) = (BTreeMap::new(), BTreeMap::new());
        let scene = serde_json::to_value(&subject.program.scene).unwrap_or_default();
        leaves(String::new(), &scene, &mut numbers, &mut words);
        // What a scene is called makes no difference.
        words.remove("name");
        let kind = Kind {
            tables,
            model: &subject.manifest.model,
            substeps: subject.manifest.substeps,
            settings: &subject.manifest.settings,
            max_ticks: subject.manifest.max_ticks,
            words,
        };
        groups.entry(kind).or_default().push((i, numbers));
    }
    let mut sweeps: BTreeMap<String, Vec<Curve>> = BTreeMap::new();
    for group in groups.values() {
        let Some(of) = difference(group) else {
            continue;
        };
        let point = |(i, numbers): &Member| {
            let time = Time::of(&clock.times(&subjects[*i]))?;
            Some((*numbers.get(&of)?, *i, time))
        };
        let mut points: Vec<_> = group.iter().filter_map(point).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let name = subjects[group[0].0].program.name.clone();
        sweeps.entry(of).or_default().push(Curve { name, points });
    }
    let sweeps = sweeps.into_iter();
    sweeps.map(|(of, curves)| Sweep { of, curves }).collect()
}

/// The one number in which a group differs; `None`: none, or several.
fn difference(group: &[Member]) -> Option<String> {
    let (_, first) = group.first()?;
    let mut found = BTreeSet::new();
    for (_, numbers) in group {
        if numbers.len() != first.len() {
            return None;
        }
        let differing = numbers.iter();
        let differing = differing.filter(|(name, value)| first.get(*name) != Some(value));
        found.extend(differing.map(|(name, _)| name));
    }
    match found.len() {
        1 => found.pop_first().cloned(),
        _ => None,
    }
}

/// The numbers and the words of a value, by where they stand.
fn leaves(
    at: String,
    value: &Value,
    numbers: &mut BTreeMap<String, f64>,
    words: &mut BTreeMap<String, String>,
) {
    let below = |name: &str| match at.as_str() {
        "" => name.to_owned(),
        _ => format!("{at}.{name}"),
    };
    match value {
        Value::Object(fields) => {
            for (name, value) in fields {
                leaves(below(name), value, numbers, words);
            }
        }
        Value::Array(values) => {
            for (i, value) in values.iter().enumerate() {
                leaves(below(&i.to_string()), value, numbers, words);
            }
        }
        Value::Number(number) => {
            numbers.insert(at, number.as_f64().unwrap_or(f64::NAN));
        }
        other => {
            words.insert(at, other.to_string());
        }
    }
}
