//! Tests replay pages of two runs, the tour of a run, and exported links, pictures and films.
use serde_json::{Value, json};
use stochc::results::recording::Recording;
use stochc::text::palette::{DARK, LIGHT};

use crate::browser::{Browser, browser};
use crate::folder::{PROGRAM, Results, stochc};
use crate::page_under_test::Page;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Runs all checks in a page of a browser.
pub fn check_all(page: &mut impl Page) {
    check_two_runs(page);
    check_tour(page);
    check_taken_along(page);
}

fn in_chromium(check: impl Fn(&mut Browser)) {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    check(&mut browser);
    assert_eq!(browser.complaints, [""; 0]);
}

/// Returns the tick at the start of each phase.
fn begins(recording: &Recording) -> Vec<u64> {
    use stochc::runtime::observe::ObservedEvent;
    let events = recording.events().iter();
    let phases = events.filter(|happening| matches!(happening.event, ObservedEvent::Phase(_)));
    phases.map(|happening| happening.tick).collect()
}

#[test]
fn two_runs_share_a_page() {
    in_chromium(check_two_runs);
}

fn check_two_runs(browser: &mut impl Page) {
    let results = Results::from_records(PROGRAM, "--record all");
    let folder = results.path();
    let outcome = stochc("replay --run 0 --against 1", &[&folder]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let page = folder.join("replay-five_tower_reconfigured-0-against-1.html");
    assert_eq!(outcome.out.trim_end(), page.to_str().unwrap());
    let same = stochc("replay --run 0 --against 0", &[&folder]);
    assert_eq!(same.status, 2);
    assert!(
        same.err.contains("`--against 0` needs another run than 0"),
        "{}",
        same.err
    );
    browser.open(&page, "#tick=500");
    let [first, second] = [0, 1].map(|run| results.recording(run));
    let at = |browser: &mut dyn FnMut(&str) -> Value, tick: u64| {
        let state = browser(&format!("replay.seek({tick})"));
        let against = &state["against"];
        assert_eq!(against["run"], 1);
        (number(&state["tick"]), number(&against["tick"]))
    };
    let [here, there] = [&first, &second].map(|recording| recording.record().ticks);
    let last = here.max(there);
    assert_eq!(
        at(&mut |requested| browser.value(requested), 500),
        (500.0, 500.0)
    );
    assert_eq!(
        at(&mut |requested| browser.value(requested), last),
        (here as f64, there as f64)
    );
    // When synchronized by phase, every phase begins in both runs at once.
    browser.value("document.getElementById('clocks').click()");
    for (from, to) in begins(&first).into_iter().zip(begins(&second)) {
        assert_eq!(
            at(&mut |requested| browser.value(requested), from),
            (from as f64, to as f64)
        );
    }
    assert_eq!(
        at(&mut |requested| browser.value(requested), here),
        (here as f64, there as f64)
    );
    // Both runs are drawn, seen from the same point.
    let shown = browser.value(
        "[...document.querySelectorAll('#stage > canvas')].map(canvas => [canvas.id || canvas.className, canvas.clientWidth])",
    );
    assert_eq!(shown[0][1], shown[1][1], "{shown}");
    let before = browser.value("replay.state().view");
    browser.click(450.0, 300.0);
    browser.swipe((450.0, 300.0), (530.0, 300.0));
    assert_ne!(browser.value("replay.settled()")["view"], before);
}

#[test]
fn a_tour_follows_the_critical_path() {
    in_chromium(check_tour);
}

fn check_tour(browser: &mut impl Page) {
    let results = Results::from_records(PROGRAM, "--record 0");
    let folder = results.path();
    let page = folder.join("tour.html");
    let outcome = stochc("replay --run 0 --tour --out", &[&page, &folder]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    browser.open(&page, "");
    let steps = browser.value("JSON.parse(document.getElementById('about').textContent).tour");
    let steps = steps.as_array().unwrap();
    // The tour covers the run from its beginning to its end, without a gap.
    let mut tick = 0.0;
    for step in steps {
        assert_eq!(number(&step["from"]), tick, "{step}");
        tick = number(&step["to"]);
    }
    assert_eq!(tick, results.recording(0).record().ticks as f64);
    let words = "document.getElementById('tour').textContent";
    let first = format!("1 of {}: ", steps.len());
    let outcome = browser.value(words);
    let outcome = outcome.as_str().unwrap();
    assert!(
        outcome.starts_with(&first) && outcome.contains("waited"),
        "{outcome}"
    );
    let next = "document.querySelector('#tour [aria-label=\"next step\"]').click()";
    browser.value(next);
    browser.value("new Promise(done => setTimeout(done, 600))");
    // On a busy machine, the tour may already have reached a later step.
    let state = browser.value(&format!(
        "replay.settled().then(state => [state.tick, parseInt({words})])"
    ));
    let (tick, step) = (number(&state[0]), number(&state[1]) as usize);
    let (from, to) = (
        number(&steps[step - 1]["from"]),
        number(&steps[step - 1]["to"]),
    );
    assert!(
        step > 1 && tick > number(&steps[1]["from"]),
        "{tick} in {step}"
    );
    assert!(from <= tick && tick <= to, "{tick} from {from} to {to}");
    browser.value("document.querySelector('#tour [aria-label=\"end the tour\"]').click()");
    assert_eq!(
        browser.value("document.getElementById('tour').hidden"),
        true
    );
}

#[test]
fn views_pictures_and_videos_are_exported() {
    in_chromium(check_taken_along);
}

fn check_taken_along(browser: &mut impl Page) {
    let results = Results::from_records(PROGRAM, "--record 0");
    let page = results.page(0);
    browser.open(&page, "#tick=9000");
    browser.value("replay.look([0.3, 0.5, 12, 1, 0, 2])");
    let place = "replay.settled().then(() => replay.screen(0))";
    let seen = browser.value(place);
    let hash = browser.value("location.hash");
    assert_eq!(hash, "#tick=9000&view=0.3,0.5,12,1,0,2");
    browser.open(&page, hash.as_str().unwrap());
    assert_eq!(browser.value(place), seen);
    let size = "replay.png(640, 360).then(async blob => {
        const head = new DataView(await blob.arrayBuffer());
        return [blob.type, head.getUint32(0), head.getUint32(16), head.getUint32(20)];
    })";
    assert_eq!(
        browser.value(size),
        json!(["image/png", 0x8950_4e47_u32, 640, 360])
    );
    // At the size of the page, the picture equals the view, pixel by pixel.
    let same = "(async () => {
        const [x, y] = [300, 320];
        const { clientWidth, clientHeight } = document.getElementById('arena');
        const sheet = new OffscreenCanvas(clientWidth, clientHeight).getContext('2d');
        sheet.drawImage(await createImageBitmap(await replay.png(clientWidth, clientHeight)), 0, 0);
        return [[...sheet.getImageData(x, y, 1, 1).data].slice(0, 3), replay.pixel(x, y)];
    })()";
    let pixels = browser.value(same);
    assert_eq!(pixels[0], pixels[1]);
    // Names and axes are also equal. No other pixel has their colour, which appears and disappears
    // with them.
    let ink = match browser.value("themeName()").as_str().unwrap() {
        "dark" => DARK.ink,
        _ => LIGHT.ink,
    };
    let written = "(async () => {
        const ink = INK;
        const { clientWidth, clientHeight } = document.getElementById('arena');
        const inked = async (x, y, wide, high) => {
            const sheet = new OffscreenCanvas(2 * clientWidth, 2 * clientHeight).getContext('2d');
            sheet.drawImage(await createImageBitmap(await replay.png(2 * clientWidth, 2 * clientHeight)), 0, 0);
            const { data } = sheet.getImageData(2 * (x - wide / 2), 2 * (y - high / 2), 2 * wide, 2 * high);
            let found = 0;
            for (let at = 0; at < data.length; at += 4) if (ink.every((part, i) => Math.abs(data[at + i] - part) < 8)) found++;
            return found;
        };
        const [{ x, y }] = replay.names().slice(-1);
        const [before, axes] = [await inked(x, y, 30, 20), await inked(clientWidth - 50, clientHeight - 45, 90, 80)];
        document.getElementById('names').click();
        await replay.settled();
        const after = await inked(x, y, 30, 20);
        document.getElementById('names').click();
        return [before > 20, after, axes > 100];
    })()";
    let written = written.replace("INK", &json!([ink.0, ink.1, ink.2]).to_string());
    assert_eq!(browser.value(&written), json!([true, 0, true]));
    let much = browser.value("replay.png(10 ** 7, 1).catch(({ message }) => message)");
    assert!(much.as_str().unwrap().contains("pixels at most"), "{much}");
    // The film has a WebM cluster with frames. Their number depends on the machine.
    let film = "replay.film({ from: 100, to: 500, width: 320, height: 200, speed: 5 }).then(async blob => {
        const bytes = new Uint8Array(await blob.arrayBuffer());
        const has = mark => bytes.some((_, at) => mark.every((byte, i) => bytes[at + i] === byte));
        return [blob.type, has([0x1a, 0x45, 0xdf, 0xa3]), has([0x1f, 0x43, 0xb6, 0x75])];
    })";
    assert_eq!(browser.value(film), json!(["video/webm", true, true]));
    let none = browser.value("replay.film({ from: 9, to: 9 }).catch(({ message }) => message)");
    assert_eq!(none, "A film goes from a tick to a later one.");
    // If the page is embedded in another page, it has no controls.
    browser.open(&page, "#embed&tick=50");
    let shown = "['arena', 'tools', 'tick', 'graph'].map(id => document.getElementById(id).checkVisibility())";
    assert_eq!(browser.value(shown), json!([true, false, false, false]));
    assert_eq!(browser.value("replay.settled()")["tick"], 50);
    assert_eq!(browser.value("location.hash"), "#tick=50&embed");
}
