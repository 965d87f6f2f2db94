//! Sweeps of scene parameters, found as differences between results folders.
use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value as Json, json};
use stochc_experiments::TimeUnit;
use stochc_experiments::sweep::{Sweep, SweepPoint, SweptNumber, SweptValue};
use stochc_ir::scene::scalars::scalars;

use super::reported_program::ReportedProgram;

/// Index of a program in the report, and its scene parameters: the name and value of each.
type SweepMember = (usize, BTreeMap<&'static str, f64>);

/// Properties that programs must share for a comparison of one scene parameter.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct ComparisonKey<'a> {
    tables: &'a str,
    /// Settings of the program as JSON.
    settings: String,
    words: BTreeMap<String, String>,
}

/// Finds programs of several folders that differ in exactly one scene parameter. Returns a sweep
/// over each such parameter, in SI units.
pub(crate) fn found(subjects: &[ReportedProgram], clock: TimeUnit) -> Vec<Sweep> {
    let mut groups: BTreeMap<ComparisonKey, Vec<SweepMember>> = BTreeMap::new();
    let plain = subjects.iter().enumerate();
    let plain = plain.filter(|(_, subject)| !subject.program.is_point());
    for (i, subject) in plain {
        let tables = subject.program.compiled.digest();
        let mut words = BTreeMap::new();
        let scene = &subject.program.scene;
        let json = serde_json::to_value(scene).unwrap_or_default();
        leaves(String::new(), &json, &mut words);
        // Scenes may differ in their names.
        words.remove("name");
        let kind = ComparisonKey {
            tables,
            settings: json!(subject.manifest.settings_of(subject.program)).to_string(),
            words,
        };
        let numbers = scalars(scene).filter_map(|it| Some((it.name(), it.get(scene)?)));
        let member = (i, numbers.collect());
        groups.entry(kind).or_default().push(member);
    }
    let mut sweeps: BTreeMap<&'static str, Vec<SweepPoint>> = BTreeMap::new();
    for group in groups.values() {
        let Some(name) = difference(group) else {
            continue;
        };
        let program = &subjects[group[0].0].program.name;
        let last = group.iter().map(|(i, _)| subjects[*i].point.last_seen());
        let last = last.fold(0.0, f64::max);
        let point = |(i, numbers): &SweepMember| {
            let (subject, value) = (&subjects[*i], *numbers.get(name)?);
            Some(subject.point.clone().finish(
                (subject.label.clone(), program.clone()),
                vec![SweptValue { value, si: value }],
                subject.manifest.runs,
                subject.program.scene.tick,
                last,
            ))
        };
        let mut points: Vec<SweepPoint> = group.iter().filter_map(point).collect();
        points.sort_by(|a, b| a.values[0].si.total_cmp(&b.values[0].si));
        sweeps.entry(name).or_default().extend(points);
    }
    let sweep = |(name, points): (&str, Vec<SweepPoint>)| Sweep {
        axes: vec![SweptNumber {
            name: name.to_owned(),
            unit: "SI".to_owned(),
        }],
        settings: Vec::new(),
        unit: clock.unit(),
        points,
        elasticities: Vec::new(),
    };
    sweeps.into_iter().map(sweep).collect()
}

/// Returns the scene parameter whose value differs between the programs of a group. Returns `None`
/// if there is no such parameter, or several.
fn difference(group: &[SweepMember]) -> Option<&'static str> {
    let (_, first) = group.first()?;
    let mut found = BTreeSet::new();
    for (_, numbers) in group {
        if !numbers.keys().eq(first.keys()) {
            return None;
        }
        let differing = numbers.iter();
        let differing = differing.filter(|(name, value)| first.get(*name) != Some(value));
        found.extend(differing.map(|(name, _)| *name));
    }
    match found.len() {
        1 => found.pop_first(),
        _ => None,
    }
}

/// Adds each value in the JSON of a scene to `words`, with the path of the value as key. Each
/// number becomes the text `a number`.
fn leaves(at: String, value: &Json, words: &mut BTreeMap<String, String>) {
    let below = |name: &str| match at.as_str() {
        "" => name.to_owned(),
        _ => format!("{at}.{name}"),
    };
    match value {
        Json::Object(fields) => {
            for (name, value) in fields {
                leaves(below(name), value, words);
            }
        }
        Json::Array(values) => {
            for (i, value) in values.iter().enumerate() {
                leaves(below(&i.to_string()), value, words);
            }
        }
        Json::Number(_) => {
            words.insert(at, "a number".to_owned());
        }
        other => {
            words.insert(at, other.to_string());
        }
    }
}
