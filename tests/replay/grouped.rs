//! Tests replays of free blocks that bond to each other. The page must show the groups of the
//! recording.
use std::collections::BTreeMap;

use serde_json::{Value, json};
use stochc::results::recording::Recording;
use stochc::runtime::observe::ObservedEvent;
use stochc::runtime::world::FreeBond;
use stochc::text::palette::{DARK, LIGHT};

use crate::browser::browser;
use crate::folder::{Results, SWARM};
use crate::page_under_test::Page;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Returns the bonds that exist after each tick with a change.
fn bonds(recording: &Recording) -> BTreeMap<u64, Vec<FreeBond>> {
    let mut now: Vec<FreeBond> = Vec::new();
    let mut all = BTreeMap::from([(0, Vec::new())]);
    for happening in recording.events() {
        match happening.event {
            ObservedEvent::Bonded { bond, .. } => now.push(bond),
            ObservedEvent::Unbonded { bond, .. } => now.retain(|other| *other != bond),
            _ => continue,
        }
        all.insert(happening.tick, now.clone());
    }
    all
}

/// Returns the groups that bonds form, in ascending order.
fn groups(bonds: &[FreeBond]) -> Vec<Vec<u32>> {
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for bond in bonds {
        let (with, rest): (Vec<_>, Vec<_>) =
            (groups.into_iter()).partition(|group| bond.bodies.iter().any(|id| group.contains(id)));
        let mut whole: Vec<u32> = with.concat().into_iter().chain(bond.bodies).collect();
        whole.sort_unstable();
        whole.dedup();
        groups = rest;
        groups.push(whole);
    }
    groups.sort_unstable();
    groups
}

/// Checks groups, legend and colours at the ticks of bonds, forwards and backwards in time.
fn check_groups(page: &mut impl Page, recording: &Recording) {
    let bonds = bonds(recording);
    let ticks: Vec<u64> = bonds.keys().copied().collect();
    let mut order: Vec<u64> = ticks.iter().copied().step_by(4).collect();
    order.extend(ticks.iter().rev().step_by(5));
    let theme = match page.value("themeName()").as_str().unwrap() {
        "dark" => DARK,
        _ => LIGHT,
    };
    // Hide the free blocks, because they would blend with the colours.
    page.value("[1, 2].forEach(() => document.getElementById('cloud').click())");
    let mut coloured = BTreeMap::new();
    for tick in order {
        let groups = groups(&bonds[&tick]);
        let state = page.value(&format!("replay.seek({tick})"));
        assert_eq!(state["groups"], json!(groups), "at {tick}");
        let largest = groups.iter().map(Vec::len).max();
        let legend = page.value("document.getElementById('groups').textContent");
        let words = match (groups.len(), largest) {
            (_, None) => "no groups now".to_owned(),
            (1, Some(most)) => format!("now 1 group, the largest of {most} blocks"),
            (count, Some(most)) => format!("now {count} groups, the largest of {most} blocks"),
        };
        assert!(
            legend.as_str().unwrap().ends_with(&words),
            "{legend} at {tick}"
        );
        for group in groups {
            let class = [2, 3, 5, 9, 17]
                .iter()
                .rposition(|from| *from <= group.len())
                .unwrap();
            let colour = theme.groups[class];
            for body in group {
                let seen = page.value(&format!(
                    "(({{ x, y }}) => replay.pick(x, y) === {body} ? replay.pixel(x, y) : null)(replay.screen({body}))"
                ));
                if seen.is_null() {
                    continue;
                }
                let light = number(&seen[1]) / f64::from(colour.1);
                let is_same = [colour.0, colour.1, colour.2]
                    .into_iter()
                    .enumerate()
                    .all(|(i, part)| (number(&seen[i]) - light * f64::from(part)).abs() <= 3.0);
                assert!(
                    is_same && light > 0.2,
                    "block {body} at {tick}: {seen} for {colour}"
                );
                *coloured.entry(class).or_insert(0) += 1;
                break;
            }
        }
    }
    assert!(coloured.len() >= 4, "{coloured:?}");
    page.value("document.getElementById('cloud').click()");
}

/// Checks the curves of the largest group's size and of the number of groups over time.
fn check_strip(page: &mut impl Page, recording: &Recording) {
    let drawn = page.drawn("#timeline", "document.getElementById('theme').click()");
    let width = number(&page.value("document.getElementById('timeline').clientWidth"));
    let end = recording.record().ticks as f64;
    let mut course = Vec::new();
    for (tick, bonds) in bonds(recording) {
        let groups = groups(&bonds);
        let largest = groups.iter().map(Vec::len).max().unwrap_or(1);
        course.push((tick as f64, [largest, groups.len()]));
    }
    // A line begins with a call of `moveTo`. Lines of a legend have two points.
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    for it in drawn
        .iter()
        .filter(|it| it[0] == "moveTo" || it[0] == "lineTo")
    {
        let point = [number(&it[2]), number(&it[3])];
        if it[0] == "moveTo" {
            lines.push(vec![point])
        } else {
            lines.last_mut().unwrap().push(point)
        }
    }
    lines.retain(|line| line.len() > 2);
    assert_eq!(lines.len(), 2);
    for (which, line) in lines.iter().enumerate() {
        let values: Vec<f64> = course.iter().map(|(_, both)| both[which] as f64).collect();
        let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), &v| {
            (low.min(v), high.max(v))
        });
        let levels = line.iter().map(|point| point[1]);
        let (top, bottom) = levels.fold((f64::MAX, f64::MIN), |(top, bottom), y| {
            (top.min(y), bottom.max(y))
        });
        for (&(tick, _), value) in course.iter().zip(&values) {
            let x = 8.0 + tick / end * (width - 16.0);
            let y = bottom - (value - low) / (high - low) * (bottom - top);
            let reached = line.iter().rfind(|point| point[0] <= x + 1e-6).unwrap();
            assert!(
                (reached[1] - y).abs() < 1e-6,
                "{which} at {tick}: {reached:?}, not {y}"
            );
        }
    }
    let names: Vec<&str> = drawn
        .iter()
        .filter(|it| it[0] == "fillText")
        .filter_map(|it| it[2].as_str())
        .collect();
    let most = |which: usize| course.iter().map(|(_, both)| both[which]).max().unwrap();
    for name in [
        format!("largest group: {} at most", most(0)),
        format!("groups: {} at most", most(1)),
    ] {
        assert!(names.contains(&name.as_str()), "{name} in {names:?}");
    }
    page.value("document.getElementById('theme').click()");
}

/// Checks that a block's history lists its bonds at their ticks.
fn check_history(page: &mut impl Page, recording: &Recording) {
    let torn = (recording.events().iter()).find_map(|happening| match happening.event {
        ObservedEvent::Unbonded { bond, .. } => Some(bond.bodies[0]),
        _ => None,
    });
    let body = torn.expect("the test needs a bond that is torn");
    page.value(&format!(
        "(replay.select({body}), replay.seek(replay.state().end).then(() => 1))"
    ));
    let shown = page
        .value("[...document.querySelectorAll('#block li')].map(({ textContent }) => textContent)");
    let expected: Vec<String> = (recording.events().iter().rev())
        .filter_map(|happening| {
            let face = |face| {
                serde_json::to_value(face)
                    .unwrap()
                    .as_str()
                    .unwrap()
                    .to_owned()
            };
            let side = |bond: &FreeBond| bond.bodies.iter().position(|id| *id == body);
            match happening.event {
                ObservedEvent::Bonded { bond, size } => side(&bond).map(|own| {
                    let other = 1 - own;
                    format!(
                        "{} bonds to block {}, {} to its {} and forms a group of {size}",
                        happening.tick,
                        bond.bodies[other],
                        face(bond.faces[own]),
                        face(bond.faces[other])
                    )
                }),
                ObservedEvent::Unbonded { bond, sizes } => side(&bond).map(|own| {
                    let left = match sizes[own] {
                        1 => "a single block".to_owned(),
                        size => format!("in a group of {size}"),
                    };
                    format!(
                        "{} parts from block {}, and is left {left}",
                        happening.tick,
                        bond.bodies[1 - own]
                    )
                }),
                _ => None,
            }
        })
        .collect();
    let mut shown: Vec<&str> = shown
        .as_array()
        .unwrap()
        .iter()
        .map(|line| line.as_str().unwrap())
        .collect();
    let mut expected: Vec<&str> = expected.iter().map(String::as_str).collect();
    assert!(expected.len() > 1);
    shown.sort_unstable();
    expected.sort_unstable();
    assert_eq!(shown, expected);
}

/// Checks all parts of the page about groups, for a run of [`SWARM`].
pub fn check_all(page: &mut impl Page, results: &Results) {
    let recording = results.recording(0);
    page.open(&results.page(0), "");
    check_groups(page, &recording);
    check_strip(page, &recording);
    check_history(page, &recording);
}

#[test]
fn groups_match_the_recording() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    check_all(&mut browser, &Results::from_records(SWARM, "--record 0"));
    assert_eq!(browser.complaints, [""; 0]);
}
