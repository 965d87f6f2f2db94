//! Checks of the drawings around the arena, for a tick and a view. These are axes, scale bar,
//! overview, statements of the program, and blocks in the floor or outside of the wall.
use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;
use stochc::ir::table::Tables;
use stochc::results::recording::Recording;
use stochc::runtime::observe::ObservedEvent;
use stochc::runtime::world::Body;
use stochc::text::palette::{DARK, LIGHT, Theme, phase};

use crate::browser::browser;
use crate::folder::{PASSED_ON, PROGRAM, Results};
use crate::page_under_test::Page;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Half of the vertical angle of view \[rad\].
const HALF: f64 = 0.35;

/// Returns the unit vectors to the right and up for a camera at this azimuth and height \[rad\].
fn basis(azimuth: f64, height: f64) -> [[f64; 3]; 2] {
    let (sin, cos) = azimuth.sin_cos();
    let right = [-sin, cos, 0.0];
    let up = [-height.sin() * cos, -height.sin() * sin, height.cos()];
    [right, up]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Checks that the arrows point to the east, to the north and up.
fn check_axes(page: &mut impl Page) {
    let directions = [
        ("E", [1.0, 0.0, 0.0]),
        ("N", [0.0, 1.0, 0.0]),
        ("up", [0.0, 0.0, 1.0]),
    ];
    for (azimuth, height) in [(-0.9, 0.42), (0.4, 0.1), (2.5, 1.2), (-2.2, 0.7)] {
        let look = format!("replay.look([{azimuth}, {height}, 15, 0, 0, 1])");
        let drawn = page.drawn("#labels .axes", &look);
        let [right, up] = basis(azimuth, height);
        for (name, direction) in directions {
            let at = drawn
                .iter()
                .position(|it| it[0] == "fillText" && it[2] == name);
            let at = at.unwrap_or_else(|| panic!("no {name} in {drawn:?}"));
            // The label of an arrow is drawn after its tip.
            let [from, to] = [&drawn[at - 2], &drawn[at - 1]];
            assert_eq!((&from[0], &to[0]), (&"moveTo".into(), &"lineTo".into()));
            let arrow = [2, 3].map(|i| number(&to[i]) - number(&from[i]));
            let expected = [dot(direction, right), -dot(direction, up)];
            let long = 26.0;
            for (arrow, expected) in arrow.iter().zip(expected) {
                assert!((arrow - long * expected).abs() < 1e-6, "{name}: {arrow}");
            }
            let ahead: f64 = (0..2)
                .map(|i| (number(&drawn[at][3 + i]) - number(&to[2 + i])) * arrow[i])
                .sum();
            assert!(ahead >= 0.0, "{name}");
        }
    }
}

/// Checks that the scale bar has the length that its label states.
fn check_scale(page: &mut impl Page) {
    let size = page.value("(({ clientWidth, clientHeight }) => [clientWidth, clientHeight])(document.getElementById('arena'))");
    let mut texts = BTreeSet::new();
    for distance in [6.0, 9.0, 20.0, 45.0, 110.0] {
        // The view is from the south, at the middle between the seeds A and B. They are two block
        // lengths apart.
        let look = format!(
            "replay.look([{}, 0, {distance}, 0, -1, -0.5])",
            -std::f64::consts::FRAC_PI_2
        );
        let drawn = page.drawn("#labels .axes", &look);
        let at = drawn.iter().position(|it| {
            it[0] == "fillText" && it[2].as_str().is_some_and(|text| text.contains(" = "))
        });
        let at = at.unwrap();
        let text = drawn[at][2].as_str().unwrap().to_owned();
        let sides: f64 = text.split(' ').next().unwrap().parse().unwrap();
        let bar: Vec<f64> = drawn[at - 4..at].iter().map(|it| number(&it[2])).collect();
        let long = bar[2] - bar[1];
        let seen = page.value("[replay.screen(-1), replay.screen(-2)].map(({ x }) => x)");
        let apart = number(&seen[1]) - number(&seen[0]);
        assert!(
            (long - sides * apart / 2.0).abs() < 1e-6 * long,
            "{text}: {long} px, and two sides are {apart}"
        );
        // A tall picture shows the same horizontal angle as a square one.
        let least = number(&size[0]).min(number(&size[1]));
        let scale = least / (2.0 * distance * HALF.tan());
        assert!((long - sides * scale).abs() < 1e-6 * long, "{text}");
        // A block length of the scene is 20 cm.
        let metres = 0.2 * sides;
        let words = if metres < 1.0 {
            format!("{} cm", (100.0 * metres).round())
        } else {
            format!("{} m", (1e3 * metres).round() / 1e3)
        };
        let noun = if sides == 1.0 { "side" } else { "sides" };
        assert_eq!(text, format!("{sides} {noun} = {words}"));
        texts.insert(text);
    }
    assert!(texts.len() >= 4, "{texts:?}");
}

/// Blocks of a recording at a tick.
struct Moment {
    structure: BTreeMap<u32, u32>,
    pulled: BTreeSet<u32>,
}

impl Moment {
    fn new(recording: &Recording, tick: u64) -> Moment {
        let mut moment = Moment {
            structure: BTreeMap::new(),
            pulled: BTreeSet::new(),
        };
        let mut phase = 0;
        let mut pulls: BTreeSet<(u32, Body, stochc::ir::Face)> = BTreeSet::new();
        for happening in recording.events().iter().filter(|it| it.tick <= tick) {
            match happening.event {
                ObservedEvent::Phase(number) => phase = number.0,
                ObservedEvent::Entered { body, of, face } => drop(pulls.insert((body, of, face))),
                ObservedEvent::Left { body, of, face } => drop(pulls.remove(&(body, of, face))),
                ObservedEvent::Captured { body, .. } => {
                    moment.structure.insert(body, phase);
                    pulls.retain(|pull| pull.0 != body);
                }
                ObservedEvent::Released { body, .. } => drop(moment.structure.remove(&body)),
                _ => {}
            }
        }
        moment.pulled = pulls.into_iter().map(|(body, ..)| body).collect();
        moment
    }
}

/// Checks the overview (north is up): position and colour of every block, and the view direction.
fn check_overview(page: &mut impl Page, recording: &Recording, tables: &Tables) {
    let theme: &Theme = match page.value("themeName()").as_str().unwrap() {
        "dark" => &DARK,
        _ => &LIGHT,
    };
    // The radius is 5 m, and a block length is 20 cm, so it is 25 block lengths.
    let radius = 25.0;
    let frames: Vec<_> = recording.frames().collect();
    let mut pulls = 0;
    for part in [0, 3, 7, 11, 14] {
        let frame = &frames[(frames.len() - 1) * part / 14];
        let view = [0.6 + f64::from(part as u32), 0.5, 14.0, 1.0, -2.0, 1.0];
        let drawn = page.drawn(
            "#overview",
            &format!("await replay.seek({}); replay.look({view:?})", frame.tick),
        );
        let last = drawn
            .iter()
            .rposition(|it| it[0] == "arc" && number(&it[4]) > 20.0);
        let drawn = &drawn[last.unwrap()..];
        let unit = number(&drawn[0][4]) / radius;
        let moment = Moment::new(recording, frame.tick);
        let dots: Vec<([f64; 2], &str)> = (drawn.iter())
            .filter(|it| it[0] == "fillRect")
            .map(|it| {
                let middle = |i: usize| number(&it[i]) + number(&it[i + 2]) / 2.0;
                (
                    [middle(2) / unit, -middle(3) / unit],
                    it[1].as_str().unwrap(),
                )
            })
            .collect();
        let plate = (tables.plate.width * tables.plate.depth) as usize;
        assert_eq!(dots.len(), frame.poses.len() + plate);
        for (body, place) in (0..).zip(&frame.poses) {
            let is_pulled = moment.pulled.contains(&body);
            let colour = match moment.structure.get(&body) {
                Some(&number) => phase(number as usize),
                None if is_pulled => theme.lit,
                None => theme.free,
            };
            pulls += usize::from(is_pulled);
            let there = dots.iter().any(|(dot, shown)| {
                *shown == colour.to_string() && (0..2).all(|i| (dot[i] - place[i]).abs() < 1e-6)
            });
            assert!(
                there,
                "block {body} at {} in {colour}: {place:?}",
                frame.tick
            );
        }
        // The line to the camera begins at the target point, and the disc is on this line.
        let [azimuth, height, distance, x, y, _] = view;
        let flat = distance * height.cos();
        let eye = [x + flat * azimuth.cos(), y + flat * azimuth.sin()];
        let from = drawn.iter().find(|it| it[0] == "moveTo").unwrap();
        let at = [number(&from[2]) / unit, -number(&from[3]) / unit];
        assert!(
            (at[0] - x).abs() < 1e-9 && (at[1] - y).abs() < 1e-9,
            "{at:?}"
        );
        let disc = drawn.iter().rfind(|it| it[0] == "arc").unwrap();
        let disc = [number(&disc[2]) / unit, -number(&disc[3]) / unit];
        for axis in 0..2 {
            assert!(
                (disc[axis] - eye[axis]).abs() < 1e-6,
                "{disc:?} for {eye:?}"
            );
        }
        let north = drawn.iter().find(|it| it[0] == "fillText").unwrap();
        assert_eq!(north[2], "N");
        assert!(number(&north[4]) < -unit * radius);
    }
    assert!(pulls > 0, "the test needs a block that is pulled");
}

/// Tick when an event of the graph became possible, and tick of the event.
type Deed = (u64, Option<u64>);

/// Returns the times of events in a recording. The keys are the events in the graph of the page.
fn deeds(recording: &Recording, tables: &Tables, graph: &Value) -> BTreeMap<u64, Deed> {
    let mut known: BTreeMap<String, Vec<u64>> = BTreeMap::new();
    for (number, phase) in graph["phases"].as_array().unwrap().iter().enumerate() {
        for event in phase["events"].as_array().unwrap() {
            let text = |key: &str| event[key].as_str().unwrap_or("");
            let what = format!(
                "{number} {} {} {} {}",
                text("kind"),
                text("parent"),
                text("face"),
                text("block")
            );
            known
                .entry(what)
                .or_default()
                .push(event["id"].as_u64().unwrap());
        }
    }
    let mut next = |what: String| {
        known
            .get_mut(&what)
            .filter(|ids| !ids.is_empty())
            .map(|ids| ids.remove(0))
    };
    let name = |role: stochc::ir::table::RoleId| &tables.roles[role.0 as usize].name;
    let face = |face: stochc::ir::Face| {
        serde_json::to_value(face)
            .unwrap()
            .as_str()
            .unwrap()
            .to_owned()
    };
    let mut deeds = BTreeMap::new();
    let mut open = BTreeMap::new();
    let mut phase = 0;
    for happening in recording.events() {
        let tick = happening.tick;
        match happening.event {
            ObservedEvent::Phase(number) => phase = number.0,
            ObservedEvent::Magnetized {
                body,
                by,
                face: which,
                child,
                ..
            } => {
                let what = format!(
                    "{phase} capture {} {} {}",
                    name(by),
                    face(which),
                    name(child)
                );
                if let Some(id) = next(what) {
                    deeds.insert(id, (tick, None));
                    open.insert((body, which), id);
                }
            }
            ObservedEvent::Captured { on, face, .. } => {
                if let Some(id) = open.remove(&(on, face)) {
                    deeds.get_mut(&id).unwrap().1 = Some(tick);
                }
            }
            ObservedEvent::Released { role, .. } => {
                if let Some(id) = next(format!("{phase} release   {}", name(role))) {
                    deeds.insert(id, (tick, Some(tick)));
                }
            }
            _ => {}
        }
    }
    deeds
}

/// Checks that statements of running events have a frame, and statements of finished events a line.
fn check_statements(page: &mut impl Page, recording: &Recording, tables: &Tables) {
    let about = page.value("(({ graph, text }) => ({ graph, text }))(JSON.parse(document.getElementById('about').textContent))");
    let deeds = deeds(recording, tables, &about["graph"]);
    let statements: Vec<Vec<u64>> = (about["text"].as_array().unwrap().iter())
        .flat_map(|file| file["pieces"].as_array().unwrap())
        .map(|piece| {
            piece["events"]
                .as_array()
                .unwrap()
                .iter()
                .map(|id| id.as_u64().unwrap())
                .collect()
        })
        .collect();
    let mut ticks: Vec<u64> = deeds
        .values()
        .flat_map(|&(from, done)| [Some(from), done])
        .flatten()
        .collect();
    ticks.sort_unstable();
    ticks.dedup();
    let mut seen = BTreeMap::new();
    let around: Vec<u64> = ticks
        .iter()
        .flat_map(|&tick| [tick.saturating_sub(1), tick])
        .collect();
    for &tick in around.iter().step_by(around.len().div_ceil(24)) {
        let shown = page.value(&format!(
            "replay.seek({tick}).then(() => [...document.querySelectorAll('#program pre > span')].map(piece => piece.className))"
        ));
        let expected: Vec<&str> = (statements.iter())
            .map(|events| {
                let begun: Vec<&Deed> = (events.iter().filter_map(|id| deeds.get(id)))
                    .filter(|deed| deed.0 <= tick)
                    .collect();
                let happened = begun
                    .iter()
                    .filter(|deed| deed.1.is_some_and(|done| done <= tick))
                    .count();
                match happened {
                    _ if happened < begun.len() => "under-way",
                    _ if !events.is_empty() && happened == events.len() => "done",
                    _ => "",
                }
            })
            .collect();
        assert_eq!(shown, serde_json::json!(expected), "at {tick}");
        for state in expected {
            *seen.entry(state).or_insert(0) += 1;
        }
    }
    assert!(
        ["", "under-way", "done"]
            .iter()
            .all(|state| seen.get(state) > Some(&3)),
        "{seen:?}"
    );
}

/// Checks the number of blocks in the floor and outside of the wall, and that each has an
/// explanation.
fn check_beyond(page: &mut impl Page, recording: &Recording) {
    let frames: Vec<_> = recording.frames().collect();
    let mut kinds = [0, 0];
    for part in [1, 4, 8, 12, 14] {
        let frame = &frames[(frames.len() - 1) * part / 14];
        let reach = |place: &[f64; 7]| {
            let [.., x, y, z, w] = *place;
            // Vertical direction in the block's own frame.
            let own = [
                2.0 * (x * z - w * y),
                2.0 * (y * z + w * x),
                1.0 - 2.0 * (x * x + y * y),
            ];
            own.iter().map(|part| part.abs() / 2.0).sum::<f64>()
        };
        let sunk = |place: &&[f64; 7]| reach(place) - place[2] >= 0.05;
        let out = |place: &&[f64; 7]| place[..3].iter().map(|x| x * x).sum::<f64>().sqrt() >= 24.5;
        let counts = [
            frame.poses.iter().filter(sunk).count(),
            frame.poses.iter().filter(out).count(),
        ];
        let parts: Vec<String> = (counts.iter().zip(["into the floor", "outside of the wall"]))
            .filter(|(count, _)| **count > 0)
            .map(|(count, words)| format!("{count} {words}"))
            .collect();
        let outcome = page.value(&format!(
            "replay.seek({}).then(() => document.getElementById('beyond').textContent)",
            frame.tick
        ));
        let expected = if parts.is_empty() {
            String::new()
        } else {
            format!(
                "now some blocks reach {}: click one to see why",
                parts.join(", and ")
            )
        };
        assert_eq!(outcome, expected, "at {}", frame.tick);
        for (kind, word) in ["into the floor", "outside of the wall"].iter().enumerate() {
            let is_so = |place: &&[f64; 7]| if kind == 0 { sunk(place) } else { out(place) };
            let Some(body) = frame.poses.iter().position(|place| is_so(&place)) else {
                continue;
            };
            let why = page.value(&format!(
                "(replay.select({body}), replay.settled().then(() => document.getElementById('block').textContent))"
            ));
            assert!(why.as_str().unwrap().contains(word), "{why}");
            kinds[kind] += 1;
        }
    }
    assert!(kinds.iter().all(|kind| *kind > 0), "{kinds:?}");
    page.value("replay.select(null)");
}

/// Checks that a capture in the bar has the colour of its own phase. The next phase may begin at
/// the same tick.
fn check_strokes(page: &mut impl Page, recording: &Recording) {
    let toggle = "document.getElementById('theme').click()";
    let drawn = page.drawn("#timeline", toggle);
    page.value(toggle);
    let strokes: Vec<&Value> = (drawn.iter())
        .filter(|it| it[0] == "fillRect" && (number(&it[4]), number(&it[5])) == (2.0, 13.0))
        .map(|it| &it[1])
        .collect();
    let bonds = &recording.record().bonds;
    let expected: Vec<String> = (bonds.iter())
        .map(|bond| phase(bond.phase.0 as usize).to_string())
        .collect();
    assert_eq!(serde_json::json!(strokes), serde_json::json!(expected));
    let ends_one =
        |tick, begun| (bonds.iter()).any(|bond| bond.docked == tick && bond.phase != begun);
    let is_close = (recording.events().iter())
        .any(|it| matches!(it.event, ObservedEvent::Phase(begun) if ends_one(it.tick, begun)));
    assert!(is_close, "the test needs a capture that ends its phase");
}

/// Checks that the target structure of the page equals the final structure that the compiler
/// computes.
fn check_target(page: &mut impl Page, program: &str) {
    let results = Results::from_records(program, "--record 0");
    page.open(&results.page(0), "");
    let checked = stochc::check(program);
    let built = &checked.programs[0];
    let last = stochc::compiler::placed_blocks::placed_blocks(&built.plan, &built.layout).last();
    let built: BTreeSet<[i32; 3]> = (last.unwrap().iter())
        .map(|block| [block.cell.x, block.cell.y, block.cell.z])
        .collect();
    let shown = page.value("target(JSON.parse(document.getElementById('about').textContent))");
    let shown: BTreeSet<[i32; 3]> = serde_json::from_value(shown).unwrap();
    assert_eq!(shown, built, "{program}");
}

#[test]
fn final_cells_match_the_compiler() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    for program in [PROGRAM, PASSED_ON] {
        check_target(&mut browser, program);
    }
    assert_eq!(browser.complaints, [""; 0]);
}

/// Checks all drawings around the arena, for a run of [`PROGRAM`].
pub fn check_all(page: &mut impl Page, results: &Results) {
    let (recording, tables) = (results.recording(0), results.tables());
    page.open(&results.page(0), "");
    check_axes(page);
    check_scale(page);
    check_overview(page, &recording, &tables);
    check_statements(page, &recording, &tables);
    check_beyond(page, &recording);
    check_strokes(page, &recording);
}

#[test]
fn captions_match_the_tick() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    check_all(&mut browser, &Results::from_records(PROGRAM, "--record 0"));
    assert_eq!(browser.complaints, [""; 0]);
}
