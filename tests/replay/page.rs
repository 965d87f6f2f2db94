//! Tests that the replay page in a browser shows the recorded data.
use std::collections::BTreeSet;
use std::path::Path;

use serde_json::{Value, json};
use stochc::ir::Face;
use stochc::ir::table::Tables;
use stochc::results::recording::Recording;
use stochc::runtime::world::Body;

use crate::browser::{Browser, browser};
use crate::folder::{PASSED_ON, PROGRAM, Results};
use crate::page_under_test::Page;

/// Moves the page to a tick. Returns the state of the page.
fn seek(page: &mut impl Page, tick: u64) -> Value {
    page.value(&format!("replay.seek({tick})"))
}

fn numbers(value: &Value) -> Vec<f64> {
    let values = value.as_array().unwrap();
    values.iter().map(|value| value.as_f64().unwrap()).collect()
}

/// Returns the blocks of the structure at a tick, each with its role.
fn structure(recording: &Recording, tick: u64) -> Vec<(u32, u32)> {
    use stochc::runtime::observe::ObservedEvent;
    let mut structure = std::collections::BTreeMap::new();
    for happening in recording.events().iter().filter(|event| event.tick <= tick) {
        match happening.event {
            ObservedEvent::Captured { body, role, .. } => drop(structure.insert(body, role.0)),
            ObservedEvent::Released { body, .. } => drop(structure.remove(&body)),
            _ => {}
        }
    }
    structure.into_iter().collect()
}

#[test]
fn the_page_shows_the_recording() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    let results = Results::from_records(PROGRAM, "--record 0");
    let page = results.page(0);
    let (recording, tables) = (results.recording(0), results.tables());
    browser.open(&page, "");
    let frames: Vec<_> = recording.frames().collect();
    let some = |part: usize| frames[frames.len() * part / 7].tick;
    // The ticks are visited forwards, backwards, and from one end to the other.
    let mut seen = std::collections::BTreeMap::new();
    for part in [0, 1, 2, 3, 4, 5, 6, 3, 1, 5, 0, 6, 2] {
        let tick = some(part);
        let state = seek(&mut browser, tick);
        assert_eq!(state["tick"], tick);
        assert_eq!(state["end"], recording.record().ticks);
        let frame = frames.iter().find(|frame| frame.tick == tick).unwrap();
        let places = numbers(&state["places"]);
        assert_eq!(places.len(), 7 * frame.poses.len());
        for (shown, stored) in places.iter().zip(frame.poses.iter().flatten()) {
            assert!(
                (shown - stored).abs() < 1e-12,
                "{shown} and {stored} at {tick}"
            );
        }
        let blocks = frame.poses.len() as u64;
        let plate = u64::from(tables.plate.width * tables.plate.depth);
        assert_eq!(state["cubes"], blocks + plate);
        let names: Vec<Value> = (structure(&recording, tick).into_iter())
            .map(|(body, role)| json!([body, tables.roles[role as usize].name]))
            .collect();
        assert_eq!(state["structure"], json!(names), "at {tick}");
        // A tick always looks the same, whatever the page showed before.
        let known = seen.entry(tick).or_insert_with(|| state.clone());
        assert_eq!(*known, state);
    }
    // At the end, every event has happened.
    let state = seek(&mut browser, recording.record().ticks);
    let graph = browser.value("JSON.parse(document.getElementById('about').textContent).graph");
    let events: usize = (graph["phases"].as_array().unwrap().iter())
        .map(|phase| phase["events"].as_array().unwrap().len())
        .sum();
    assert_eq!(state["done"].as_array().unwrap().len(), events);
    // Between two frames, the position of a block is interpolated.
    let pair = frames
        .windows(2)
        .find(|pair| pair[1].tick == pair[0].tick + 4)
        .unwrap();
    let places = numbers(&seek(&mut browser, pair[0].tick + 1)["places"]);
    for (body, place) in pair[0].poses.iter().enumerate() {
        for axis in 0..3 {
            let there = pair[1].poses[body][axis];
            let expected = place[axis] + (there - place[axis]) / 4.0;
            assert!((places[7 * body + axis] - expected).abs() < 1e-9);
        }
    }
    assert_eq!(browser.complaints, [""; 0]);
    let others: Vec<_> = (browser.requests.iter())
        .filter(|address| !address.starts_with("file://") && *address != "about:blank")
        .collect();
    assert_eq!(others, [""; 0]);
    assert_eq!(
        browser
            .requests
            .iter()
            .filter(|address| address.starts_with("file://"))
            .count(),
        1
    );
}

#[test]
fn a_click_finds_a_block_at_its_position() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    let results = Results::from_records(PROGRAM, "--record 0");
    let recording = results.recording(0);
    browser.open(&results.page(0), "");
    // Without free blocks and names, nothing covers the block.
    for key in ["c", "c", "l"] {
        browser.key(key);
    }
    let last = recording.record().bonds.last().unwrap();
    let colours = browser.value("PALETTE.phases.map(({ colour }) => rgb(colour))");
    let colour = numbers(&colours[last.phase.0 as usize]);
    let place = format!("replay.face({}, 'up')", last.body);
    let pixel = |browser: &mut Browser, tick: u64| {
        seek(browser, tick);
        let at = browser.value(&place);
        numbers(&browser.value(&format!("replay.pixel({}, {})", at["x"], at["y"])))
    };
    // From its capture on, the block has the colour of its phase. The brightness depends on the
    // light.
    let shown = pixel(&mut browser, last.docked);
    let light: Vec<f64> = shown
        .iter()
        .zip(&colour)
        .map(|(a, b)| a / 255.0 / b)
        .collect();
    assert!((0.5..1.1).contains(&light[0]), "{shown:?} for {colour:?}");
    assert!(
        light.iter().all(|part| (part - light[0]).abs() < 0.03),
        "{shown:?} for {colour:?}"
    );
    // One tick earlier, the position is empty: the block is not captured yet, and free blocks are
    // hidden.
    seek(&mut browser, last.docked);
    let at = browser.value(&place);
    seek(&mut browser, last.docked - 1);
    let empty = numbers(&browser.value(&format!("replay.pixel({}, {})", at["x"], at["y"])));
    assert!(
        empty.iter().zip(&shown).any(|(a, b)| (a - b).abs() > 40.0),
        "{empty:?}, {shown:?}"
    );

    seek(&mut browser, last.docked);
    let at = browser.value(&place);
    browser.click(at["x"].as_f64().unwrap(), at["y"].as_f64().unwrap());
    assert_eq!(browser.value("replay.state().selected"), last.body);
    let panel = |browser: &mut Browser| {
        let text = "document.getElementById('block').textContent";
        browser.value(&format!("replay.settled().then(() => {text})"))
    };
    let text = panel(&mut browser);
    let text = text.as_str().unwrap();
    let name = &results.tables().roles[last.child.0 as usize].name;
    assert!(text.starts_with(name.as_str()), "{text}");
    assert!(text.contains(&format!("Event table of {name}")), "{text}");
    assert!(text.contains(&format!("as {name}, ")), "{text}");
    assert!(text.contains("docks on"), "{text}");
    assert!(text.contains("entered the reach"), "{text}");
    // A click on an empty point selects nothing.
    browser.click(20.0, 600.0);
    assert_eq!(browser.value("replay.state().selected"), Value::Null);
    // The click is on a block of the plate.
    let at = browser.value("replay.face(-1, 'up')");
    seek(&mut browser, 0);
    browser.click(at["x"].as_f64().unwrap(), at["y"].as_f64().unwrap());
    assert_eq!(browser.value("replay.state().selected"), -1);
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn pre_attached_blocks_have_no_wait() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    let results = Results::from_records(PASSED_ON, "--record 0");
    let attached = results.recording(0).record().bonds[0].body;
    let page = results.page(0);
    let mut announced = |hash: &str| {
        browser.open(&page, hash);
        browser.value("document.getElementById('block').textContent")
    };
    let of_all = announced("#tick=5");
    let of_all = of_all.as_str().unwrap();
    let expected = format!("P is pre-attached to A.up: block {attached}");
    assert!(of_all.contains(&expected), "{of_all}");
    // This block is released immediately.
    let other = "X is pre-attached to P.up";
    assert!(of_all.contains(other), "{of_all}");
    let of_one = announced(&format!("#tick=5&block={attached}"));
    let of_one = of_one.as_str().unwrap();
    assert!(of_one.contains("is pre-attached to A.up as P"), "{of_one}");
    assert!(!of_one.contains("docks on"), "{of_one}");
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn faces_and_pulled_blocks_match_the_recording() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    let results = Results::from_records(PROGRAM, "--record 0");
    browser.open(&results.page(0), "");
    check_faces(&mut browser, &results.recording(0), &results.tables());
}

/// Checks the faces that are on and the blocks that they pull, at every change.
pub fn check_faces(page: &mut impl Page, recording: &Recording, tables: &Tables) {
    use stochc::runtime::observe::ObservedEvent;
    let number = |body: Body| match body {
        Body::Free(id) => i64::from(id),
        Body::Seed(cell) => {
            let role = tables.seeds().find(|(_, at)| *at == cell);
            -1 - i64::from(role.unwrap().0.0)
        }
    };
    // All blocks are solid, so a click picks the block in front.
    page.value("['cloud', 'names'].forEach(id => document.getElementById(id).click())");
    let mut faces = [0, 0];
    let mut owners = BTreeSet::new();
    let mut lit = BTreeSet::new();
    let mut pulled = BTreeSet::new();
    let mut looked = 0;
    let mut events = recording.events().iter().peekable();
    while let Some(happening) = events.next() {
        match happening.event {
            ObservedEvent::Magnetized { body, face, .. } => {
                lit.insert((body, face));
                owners.insert(body);
            }
            ObservedEvent::Entered { body, of, face } => drop(pulled.insert((body, of, face))),
            ObservedEvent::Left { body, of, face } => drop(pulled.remove(&(body, of, face))),
            ObservedEvent::Captured { body, on, face, .. } => {
                lit.remove(&(on, face));
                pulled.retain(|&(block, of, which)| block != body && (of, which) != (on, face));
            }
            _ => {}
        }
        let is_last = events.peek().is_none_or(|next| next.tick > happening.tick);
        if is_last
            && matches!(
                happening.event,
                ObservedEvent::Entered { .. } | ObservedEvent::Left { .. }
            )
        {
            let state = seek(page, happening.tick);
            let key = |&(body, face): &(Body, Face)| json!([number(body), face]).to_string();
            let expected: BTreeSet<String> = lit.iter().map(key).collect();
            let shown = state["lit"].as_array().unwrap().iter();
            let shown: BTreeSet<String> = shown.map(Value::to_string).collect();
            assert_eq!(shown, expected, "at {}", happening.tick);
            // A face that is on and visible has its own colour. A face that is off does not.
            let facing = [
                (Face::Up, "up"),
                (Face::East, "east"),
                (Face::South, "south"),
            ];
            let sites = owners.iter().flat_map(|body| facing.map(|it| (body, it)));
            for (&body, (face, name)) in sites.filter(|_| looked % 2 == 0) {
                let seen = page.value(&format!(
                    "(({{ x, y }}) => replay.pick(x, y) === {0} ? replay.pixel(x, y) : null)(replay.face({0}, '{name}'))",
                    number(body)
                ));
                if seen.is_null() {
                    continue;
                }
                let pixel = numbers(&seen);
                let is_red = pixel[0] > 2.5 * pixel[1].max(pixel[2]);
                let is_on = lit.contains(&(body, face));
                assert_eq!(
                    is_red, is_on,
                    "{body:?} {name} at {}: {pixel:?}",
                    happening.tick
                );
                faces[usize::from(is_on)] += 1;
            }
            let mut shown: Vec<u64> = (state["pulled"].as_array().unwrap().iter())
                .map(|body| body.as_u64().unwrap())
                .collect();
            shown.sort_unstable();
            let expected: Vec<u64> = pulled.iter().map(|&(body, ..)| u64::from(body)).collect();
            assert_eq!(shown, expected, "at {}", happening.tick);
            looked += 1;
        }
        if looked == 40 {
            break;
        }
    }
    assert_eq!(looked, 40);
    assert!(faces.iter().all(|count| *count > 2), "{faces:?}");
}

#[test]
fn keys_links_and_touch_navigate() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    check_moves(&mut browser, &Results::from_records(PROGRAM, "--record 0"));
    assert_eq!(browser.complaints, [""; 0]);
}

/// Checks keys, the slider and fingers.
pub fn check_moves(browser: &mut impl Page, results: &Results) {
    let recording = results.recording(0);
    let page = results.page(0);
    browser.open(&page, "#tick=1234&block=3");
    let now = "replay.settled()";
    let state = browser.value(now);
    assert_eq!(
        (&state["tick"], &state["selected"]),
        (&json!(1234), &json!(3))
    );
    for (key, tick) in [("ArrowRight", 1235), ("ArrowLeft", 1234), ("Home", 0)] {
        browser.key(key);
        assert_eq!(browser.value(now)["tick"], tick, "{key}");
    }
    // The keys move from event to event of the structure, forwards and backwards.
    use stochc::runtime::observe::ObservedEvent;
    let mut ticks: Vec<u64> = (recording.events().iter())
        .filter(|happening| {
            matches!(
                happening.event,
                ObservedEvent::Phase(_)
                    | ObservedEvent::Magnetized { .. }
                    | ObservedEvent::Captured { .. }
                    | ObservedEvent::Released { .. }
            )
        })
        .map(|happening| happening.tick)
        .collect();
    ticks.dedup();
    for tick in &ticks[1..5] {
        browser.key("n");
        assert_eq!(browser.value(now)["tick"], *tick);
    }
    browser.key("p");
    assert_eq!(browser.value(now)["tick"], ticks[3]);
    assert_eq!(
        browser.value("location.hash"),
        format!("#tick={}&block=3", ticks[3])
    );
    browser.key("Escape");
    assert_eq!(browser.value(now)["selected"], Value::Null);
    // The space bar starts and stops the replay.
    browser.key(" ");
    browser.value("new Promise(done => setTimeout(done, 700))");
    let state = browser.value(now);
    assert_eq!(state["playing"], true);
    assert!(
        state["tick"].as_f64().unwrap() > ticks[3] as f64,
        "{}",
        state["tick"]
    );
    browser.key(" ");
    assert_eq!(browser.value(now)["playing"], false);
    // The slider moves to a tick.
    browser.value("(bar => { bar.value = 77; bar.dispatchEvent(new Event('input')); })(document.getElementById('tick'))");
    assert_eq!(browser.value(now)["tick"], 77);
    // A finger turns the view and does not select a block.
    let before = browser.value("replay.screen(0)");
    browser.swipe((300.0, 300.0), (380.0, 300.0));
    let state = browser.value(now);
    assert_ne!(browser.value("replay.screen(0)"), before);
    assert_eq!(state["selected"], Value::Null);
    browser.key("r");
    browser.value(now);
    assert_eq!(browser.value("replay.screen(0)"), before);
    // A block that the camera follows stays in the middle.
    browser.open(&page, "#tick=1000&block=7");
    browser.key("f");
    browser.value(now);
    seek(browser, 1500);
    let at = browser.value("(({ x, y }) => [x / document.getElementById('arena').clientWidth, y / document.getElementById('arena').clientHeight])(replay.screen(7))");
    for part in numbers(&at) {
        assert!((part - 0.5).abs() < 1e-3, "{at}");
    }
    check_focus(browser, &page);
}

/// Checks that keys act on the element that has the focus.
fn check_focus(browser: &mut impl Page, page: &Path) {
    browser.open(page, "#tick=77");
    let state = "replay.settled().then(({ tick, playing }) => [tick, playing, document.getElementById('speed').value])";
    let before = browser.value(state);
    browser.value(
        "(document.getElementById('save').open = true, document.getElementById('width').focus())",
    );
    for key in ["ArrowLeft", "Home", "-", " ", "n"] {
        browser.key(key);
        assert_eq!(browser.value(state), before, "{key}");
    }
    let event = "document.querySelector('#graph details[open] [role=button]')";
    browser.value(&format!("{event}.dispatchEvent(new MouseEvent('click'))"));
    let clicked = browser.value(state);
    assert_ne!(clicked, before);
    for key in ["Enter", " "] {
        seek(browser, 77);
        browser.value(&format!("{event}.focus()"));
        browser.key(key);
        assert_eq!(browser.value(state), clicked, "{key}");
    }
}
