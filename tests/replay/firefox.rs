//! Tests the replay page in Firefox, on a virtual screen.
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::accessible::{axe, breaks_nothing};
use crate::folder::{PROGRAM, Results, SWARM};
use crate::page_under_test::{Mouse, SETTLED};
use crate::skipped::skipped;
use crate::{drawn, grouped, hostile, interaction, page, tours, unreadable};

/// Time limit that exceeds every step on a slow machine.
const PATIENCE: Duration = Duration::from_secs(120);

const SETTINGS: &str = "\
user_pref(\"marionette.port\", 0);
user_pref(\"webgl.force-enabled\", true);
user_pref(\"browser.shell.checkDefaultBrowser\", false);
user_pref(\"datareporting.policy.dataSubmissionEnabled\", false);
";

/// Firefox, controlled by its test protocol Marionette.
pub struct Firefox {
    child: Child,
    stream: BufReader<TcpStream>,
    calls: u64,
    _folder: tempfile::TempDir,
}

impl Firefox {
    /// Starts Firefox. Returns `None` with a note if Firefox or its virtual screen is missing and
    /// not required.
    #[track_caller]
    pub fn start() -> Option<Firefox> {
        let there = |name: &str| {
            let found = Command::new("sh")
                .args(["-c", &format!("command -v {name}")])
                .output();
            found.is_ok_and(|output| output.status.success())
        };
        if !there("firefox-esr") || !there("xvfb-run") {
            skipped("firefox", "firefox-esr");
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("user.js"), SETTINGS).unwrap();
        let child = Command::new("xvfb-run")
            .args(["-a", "-s", "-screen 0 1280x900x24"])
            .args(["firefox-esr", "--marionette", "--no-remote", "--profile"])
            .arg(folder.path())
            .env("HOME", folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        let port = loop {
            let outcome = std::fs::read_to_string(folder.path().join("MarionetteActivePort"));
            if let Some(port) = outcome
                .ok()
                .and_then(|port| port.trim().parse::<u16>().ok())
            {
                break port;
            }
            assert!(begun.elapsed() < PATIENCE, "firefox does not start");
            std::thread::sleep(Duration::from_millis(100));
        };
        let stream = BufReader::new(TcpStream::connect(("127.0.0.1", port)).unwrap());
        let mut firefox = Firefox {
            child,
            stream,
            calls: 0,
            _folder: folder,
        };
        firefox.message();
        firefox.call("WebDriver:NewSession", &json!({}));
        let patience = PATIENCE.as_millis() as u64;
        firefox.call(
            "WebDriver:SetTimeouts",
            &json!({ "script": patience, "pageLoad": patience }),
        );
        Some(firefox)
    }

    /// Reads a message of the protocol: its length, a colon and JSON.
    fn message(&mut self) -> Value {
        let mut length = Vec::new();
        self.stream.read_until(b':', &mut length).unwrap();
        length.pop();
        let length = std::str::from_utf8(&length).unwrap().parse().unwrap();
        let mut bytes = vec![0; length];
        self.stream.read_exact(&mut bytes).unwrap();
        serde_json::from_slice(&bytes).unwrap()
    }

    fn call(&mut self, method: &str, params: &Value) -> Value {
        self.calls += 1;
        let text = json!([0, self.calls, method, params]).to_string();
        write!(self.stream.get_mut(), "{}:{text}", text.len()).unwrap();
        let answer = self.message();
        assert_eq!(answer[2], Value::Null, "{method}");
        answer[3].clone()
    }

    /// Opens an address in the browser.
    pub fn navigate(&mut self, address: &str) {
        self.call("WebDriver:Navigate", &json!({ "url": address }));
    }

    /// Opens a file with `hash` after its name. Waits until the page shows a replay or a message.
    pub fn open(&mut self, page: &Path, hash: &str) {
        let page = page.to_str().unwrap().replace(' ', "%20");
        // Load another address first: changing only the hash would not reload the page.
        for url in ["about:blank".to_owned(), format!("file://{page}{hash}")] {
            self.navigate(&url);
        }
        let begun = Instant::now();
        while self.value(SETTLED) != true {
            assert!(begun.elapsed() < PATIENCE, "the page does not settle");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Runs a script in the page.
    pub fn run(&mut self, script: &str) {
        let params = json!({ "script": script, "args": [], "sandbox": null });
        self.call("WebDriver:ExecuteScript", &params);
    }

    /// Sets the size of the page.
    pub fn size(&mut self, width: u32, height: u32) {
        // Without a window manager, setting the same size again would never be reported.
        if self.value("[innerWidth, innerHeight]") == json!([width, height]) {
            return;
        }
        // The size includes the frame of the window, whose width is constant.
        let frame = self.value("[outerWidth - innerWidth, outerHeight - innerHeight]");
        let with = |of: u32, i: usize| u64::from(of) + frame[i].as_u64().unwrap();
        let rect = json!({ "width": with(width, 0), "height": with(height, 1) });
        self.call("WebDriver:SetWindowRect", &rect);
        let begun = Instant::now();
        while self.value("[innerWidth, innerHeight]") != json!([width, height]) {
            assert!(begun.elapsed() < PATIENCE, "the window keeps its size");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    fn act(&mut self, actions: &Value) {
        self.call("WebDriver:PerformActions", &json!({ "actions": [actions] }));
    }

    /// Presses and releases a key.
    pub fn key(&mut self, key: &str) {
        // Keys without a letter have code points:
        // <https://www.w3.org/TR/webdriver2/#keyboard-actions>.
        let value = match key {
            "ArrowLeft" => "\u{e012}",
            "ArrowRight" => "\u{e014}",
            "Home" => "\u{e011}",
            "Escape" => "\u{e00c}",
            "Enter" => "\u{e007}",
            letter => letter,
        };
        let both = ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": value }));
        self.act(&json!({ "type": "key", "id": "keys", "actions": both }));
    }

    /// Performs an action with the left mouse button. The button is released at its position,
    /// because moving the pressed button would drag.
    pub fn mouse(&mut self, what: Mouse, x: f64, y: f64) {
        let actions = match what {
            Mouse::Press => vec![moved((x, y)), json!({ "type": "pointerDown", "button": 0 })],
            Mouse::Drag => vec![moved((x, y))],
            Mouse::Release => vec![json!({ "type": "pointerUp", "button": 0 })],
        };
        self.act(&json!({ "type": "pointer", "id": "mouse", "actions": actions }));
    }

    /// Drags one finger over the page.
    pub fn swipe(&mut self, from: (f64, f64), to: (f64, f64)) {
        let (down, up) = (
            json!({ "type": "pointerDown", "button": 0 }),
            json!({ "type": "pointerUp", "button": 0 }),
        );
        self.act(&json!({
            "type": "pointer", "id": "finger", "parameters": { "pointerType": "touch" },
            "actions": [moved(from), down, moved(to), up],
        }));
    }

    /// Returns the value of a JavaScript expression. Awaits promises.
    pub fn value(&mut self, expression: &str) -> Value {
        let script = format!(
            "const resolve = arguments[0]; (async () => ({expression}))().then(resolve, error => resolve(`failed: ${{error}}`))"
        );
        let params = json!({ "script": script, "args": [], "sandbox": null });
        self.call("WebDriver:ExecuteAsyncScript", &params)["value"].clone()
    }
}

/// Returns a movement of the pointer to a point of the page, in whole pixels.
fn moved((x, y): (f64, f64)) -> Value {
    json!({ "type": "pointerMove", "duration": 0, "x": x.round() as i64, "y": y.round() as i64 })
}

impl Drop for Firefox {
    fn drop(&mut self) {
        // Quit the browser itself, because the child process is only its screen.
        let text = json!([0, 0, "Marionette:Quit", { "flags": ["eForceQuit"] }]).to_string();
        let _ = write!(self.stream.get_mut(), "{}:{text}", text.len());
        let _ = self.child.wait();
    }
}

#[test]
fn firefox_shows_the_same() {
    let Some(mut firefox) = Firefox::start() else {
        return;
    };
    let results = Results::from_records(PROGRAM, "--record 0");
    firefox.open(&results.page(0), "");
    let recording = results.recording(0);
    let frame = recording.frames().nth(500).unwrap();
    let state = firefox.value(&format!("replay.seek({})", frame.tick));
    let shown = state["places"].as_array().unwrap();
    for (shown, recorded) in shown.iter().zip(frame.poses.iter().flatten()) {
        assert!((shown.as_f64().unwrap() - recorded).abs() < 1e-12);
    }
    // The last block has the same colour in every browser.
    let last = recording.record().bonds.last().unwrap();
    firefox.value(&format!("replay.seek({})", last.docked));
    let shown = firefox.value(&format!(
        "(() => {{
            document.getElementById('cloud').click();
            document.getElementById('cloud').click();
            const {{ x, y }} = replay.face({}, 'up');
            return replay.pixel(x, y);
        }})()",
        last.body
    ));
    let colour = stochc::text::palette::phase(last.phase.0 as usize);
    let light: Vec<f64> = (shown.as_array().unwrap().iter())
        .zip([colour.0, colour.1, colour.2])
        .map(|(shown, part)| shown.as_f64().unwrap() / f64::from(part))
        .collect();
    let is_same = light.iter().all(|part| (part - light[0]).abs() < 0.03);
    assert!(is_same && light[0] > 0.5, "{shown} for {colour}");
    let click = firefox.value(
        "replay.settled().then(() => replay.names().length > 3 && replay.names().every(({ body, x, y }) => replay.pick(x, y) === body))",
    );
    assert_eq!(click, true);
    let taken = firefox.value(
        "Promise.all([replay.png(200, 100), replay.film({ from: 0, to: 200, width: 200, height: 100 })])
            .then(blobs => blobs.map(({ type, size }) => [type, size > 1000]))",
    );
    assert_eq!(taken, json!([["image/png", true], ["video/webm", true]]));
    firefox.open(&results.page(0), "");
    page::check_faces(&mut firefox, &recording, &results.tables());
    drawn::check_all(&mut firefox, &results);
    grouped::check_all(&mut firefox, &Results::from_records(SWARM, "--record 0"));
    hostile::check(&mut firefox);
    unreadable::check(&mut firefox);
}

#[test]
fn firefox_accepts_the_same_input() {
    let Some(mut firefox) = Firefox::start() else {
        return;
    };
    let results = Results::from_records(PROGRAM, "--record 0");
    firefox.size(1000, 700);
    page::check_moves(&mut firefox, &results);
    tours::check_all(&mut firefox);
    interaction::check_all(&mut firefox, &results);
    if let Some(axe) = axe() {
        for (width, height) in [(1200, 700), (500, 700)] {
            firefox.size(width, height);
            firefox.open(&results.page(0), "#tick=9000&block=3");
            for theme in ["one theme", "the other"] {
                breaks_nothing(&mut firefox, &axe, &format!("{theme}, {width} x {height}"));
                firefox.key("t");
                firefox.value("replay.settled().then(() => 1)");
            }
        }
    }
}
