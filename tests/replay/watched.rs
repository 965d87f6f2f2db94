//! The page of `simulate --watch` in a browser.
use std::io::{BufRead as _, BufReader, Read as _};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::json;

use crate::accessible::{axe, breaks_nothing};
use crate::browser::{Browser, browser};
use crate::firefox::Firefox;
use crate::folder::{PROGRAM, SWARM};

const PATIENCE: Duration = Duration::from_secs(120);

/// A command that makes runs for hours, and the link to its page.
struct Watched {
    child: Child,
    link: String,
}

impl Watched {
    fn start(options: &str) -> Watched {
        Watched::of(PROGRAM, options)
    }

    fn of(program: &str, options: &str) -> Watched {
        let mut child = Command::new(env!("CARGO_BIN_EXE_stochc"))
            .args(["simulate", program, "--quiet", "--watch"])
            .args(options.split_whitespace())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut err = BufReader::new(child.stderr.take().unwrap());
        let link = loop {
            let mut line = String::new();
            assert!(
                err.read_line(&mut line).unwrap() > 0,
                "it ends without a link"
            );
            if let Some(link) = line.strip_prefix("watch at ") {
                break link.trim_end().to_owned();
            }
        };
        // What else it says is for nobody.
        std::thread::spawn(move || err.read_to_end(&mut Vec::new()));
        Watched { child, link }
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Opens a page, and waits until something is so.
fn open(browser: &mut Browser, link: &str, so: &str) {
    browser.call("Page.navigate", &json!({ "url": link }));
    wait(browser, so);
}

fn wait(browser: &mut Browser, so: &str) {
    let begun = Instant::now();
    while browser.value(so) != json!(true) {
        assert!(begun.elapsed() < PATIENCE, "never {so}");
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// Both are seen.
const SEEN: &str =
    "Boolean(document.body?.dataset.drawn && document.querySelector('#curve svg .curve'))";

/// Colours of the arena, far apart, on a grid over the picture.
const COLOURS: &str = "(() => {
    const { painter, scene } = watch;
    scene.draw(1);
    const found = new Set();
    for (let x = 0; x < 20; x++) for (let y = 0; y < 20; y++) {
        const at = [painter.canvas.width * (x + 0.5) / 20, painter.canvas.height * (y + 0.5) / 20].map(Math.floor);
        found.add(painter.pixel(...at).map(part => part >> 4).join());
    }
    return found.size;
})()";

#[test]
fn curves_and_a_run_under_way_are_seen() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    let watched = Watched::start("--runs 100000 --threads 1 --substeps 1");
    open(&mut browser, &watched.link, SEEN);
    assert!(browser.value(COLOURS).as_u64().unwrap() > 10);
    // The time of the run goes on, or another one has begun.
    let now = "`${watch.frame.run} ${watch.frame.tick}`";
    let before = browser.value(now);
    wait(&mut browser, &format!("{now} !== {before}"));
    let told = browser.value("document.getElementById('shown').textContent");
    let told = told.as_str().unwrap();
    assert!(told.starts_with("five_tower_reconfigured · run "), "{told}");
    // Every captured block is where its cell is.
    let off = browser.value(
        "Math.max(0, ...[...watch.scene.history.held].map(([body, { cell }]) => {
            const [is, should] = [watch.scene.place(body).centre, watch.scene.centre(cell)];
            return Math.hypot(is[0] - should[0], is[1] - should[1], is[2] - should[2]);
        }))",
    );
    assert!(off.as_f64().unwrap() < 0.2, "{off}");
    assert_eq!(browser.value("watch.scene.named"), true);
    browser.value("document.getElementById('names').click()");
    assert_eq!(browser.value("watch.scene.named"), false);
    assert_eq!(browser.complaints, [] as [String; 0]);
    let host = watched.link.split_at(watched.link.rfind(':').unwrap()).0;
    for address in &browser.requests {
        let is_ours =
            address.starts_with(host) || address.starts_with("data:") || address == "about:blank";
        assert!(is_ours, "{address}");
    }
}

#[test]
fn groups_of_free_blocks_have_the_colours_of_their_sizes() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    let watched = Watched::of(SWARM, "--runs 100000 --threads 1");
    // Whatever run is shown, groups come soon; and at once, because the next frame may be of another run.
    let coloured = "Boolean(document.body?.dataset.drawn) && (() => {
        const { scene } = watch;
        scene.draw(1);
        const look = THEMES[themeName()];
        const grouped = scene.history.groups.at(0).list().flatMap(group => group.map(body =>
            scene.solid.some(block => block.body === body && block.colour === groupColour(look, group.length))));
        return grouped.length > 1 && grouped.every(Boolean);
    })()";
    open(&mut browser, &watched.link, coloured);
    assert_eq!(browser.complaints, [] as [String; 0]);
}

#[test]
fn the_page_says_when_all_runs_are_done() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    // On a busy machine a few runs are over before the page is there.
    let is_there = [12, 60, 300].into_iter().any(|runs| {
        let watched = Watched::start(&format!("--runs {runs} --threads 1"));
        browser.complaints.clear();
        let answer = browser.call("Page.navigate", &json!({ "url": watched.link }));
        if answer.get("errorText").is_some() {
            return false;
        }
        let state = "document.getElementById('state')?.textContent ?? ''";
        let over = "/All runs are done|no connection/";
        wait(&mut browser, &format!("{over}.test({state})"));
        browser.value(state) == "All runs are done."
    });
    assert!(is_there, "it is over before anybody sees it");
    assert_eq!(browser.value("document.getElementById('share').value"), 1);
    // It asks for nothing any more.
    assert_eq!(browser.complaints, [] as [String; 0]);
}

#[test]
fn without_places_the_curve_has_the_page_for_itself() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    let watched = Watched::start("--runs 10000000 --threads 1 --model shuffle");
    let seen = "Boolean(document.querySelector('main.flat #curve svg .curve'))";
    open(&mut browser, &watched.link, seen);
    let facts = browser.value("document.getElementById('facts').textContent");
    let reason = "no arena: the model `shuffle` has no places";
    assert!(facts.as_str().unwrap().contains(reason), "{facts}");
    assert_eq!(browser.complaints, [] as [String; 0]);
}

#[test]
fn a_page_that_is_watched_breaks_no_rule_of_wcag() {
    let (Some(mut browser), Some(axe)) = (browser(&[]), axe()) else {
        return;
    };
    let watched = Watched::start("--runs 100000 --threads 1 --substeps 1");
    for theme in ["dark", "light"] {
        let wanted = json!({ "features": [{ "name": "prefers-color-scheme", "value": theme }] });
        browser.call("Emulation.setEmulatedMedia", &wanted);
        for (width, height) in [(1440, 900), (390, 844), (1200, 400)] {
            browser.size(width, height);
            open(&mut browser, &watched.link, SEEN);
            breaks_nothing(&mut browser, &axe, &format!("{theme}, {width} x {height}"));
        }
    }
}

#[test]
fn it_is_seen_in_firefox_as_well() {
    let Some(mut firefox) = Firefox::start() else {
        return;
    };
    let watched = Watched::start("--runs 100000 --threads 1 --substeps 1");
    firefox.go(&watched.link);
    let begun = Instant::now();
    while firefox.value(SEEN) != json!(true) {
        assert!(begun.elapsed() < PATIENCE, "never {SEEN}");
        std::thread::sleep(Duration::from_millis(100));
    }
    assert!(firefox.value(COLOURS).as_u64().unwrap() > 10);
}
