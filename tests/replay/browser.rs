//! Headless Chromium, controlled through two pipes by the DevTools protocol.
use std::fs::{File, OpenOptions};
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use serde_json::{Value, json};

use crate::page_under_test::{Mouse, SETTLED};
use crate::skipped::skipped;

/// Time limit that exceeds every step on a slow machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// Browser with one page.
pub struct Browser {
    child: Child,
    to: File,
    from: Receiver<Value>,
    session: String,
    calls: u64,
    /// Addresses that the page has requested.
    pub requests: Vec<String>,
    /// Uncaught exceptions and console messages of the page.
    pub complaints: Vec<String>,
    folder: tempfile::TempDir,
}

/// Starts a browser with additional options `more`. Returns `None` with a note if it is missing and
/// not required.
#[track_caller]
pub fn browser(more: &[&str]) -> Option<Browser> {
    let name = ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| {
            let version = Command::new(name)
                .arg("--version")
                .stdin(Stdio::null())
                .output();
            version.is_ok_and(|output| output.status.success())
        });
    let Some(name) = name else {
        skipped("chromium", "chromium");
        return None;
    };
    Some(Browser::start(name, more))
}

impl Browser {
    fn start(name: &str, more: &[&str]) -> Browser {
        let folder = tempfile::tempdir().unwrap();
        let [to, from] = ["to", "from"].map(|name| folder.path().join(name));
        let made = Command::new("mkfifo").args([&to, &from]).status().unwrap();
        assert!(made.success());
        // A pipe that is opened for reading and writing does not wait for its other end.
        let open = |path: &Path| {
            OpenOptions::new()
                .read(true)
                .write(true)
                .open(path)
                .unwrap()
        };
        let (to_file, from_file) = (open(&to), open(&from));
        let child = Command::new("sh")
            .args(["-c", "exec \"$@\" 3<\"$TO\" 4>\"$FROM\"", "sh", name])
            .args(["--headless=new", "--no-sandbox", "--remote-debugging-pipe"])
            .args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
            .args([
                "--no-first-run",
                "--disable-background-networking",
                "--disable-dev-shm-usage",
            ])
            .arg(format!(
                "--user-data-dir={}",
                folder.path().join("user").display()
            ))
            .args(more)
            .arg("about:blank")
            .env("TO", &to)
            .env("FROM", &from)
            // Folder for the temporary files of a killed browser.
            .env("TMPDIR", folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let (sender, receiver) = channel();
        std::thread::spawn(move || {
            let mut from = BufReader::new(from_file);
            let mut message = Vec::new();
            while from
                .read_until(0, &mut message)
                .is_ok_and(|count| count > 0)
            {
                message.pop();
                let Ok(value) = serde_json::from_slice(&message) else {
                    return;
                };
                if sender.send(value).is_err() {
                    return;
                }
                message.clear();
            }
        });
        let mut browser = Browser {
            child,
            to: to_file,
            from: receiver,
            session: String::new(),
            calls: 0,
            requests: Vec::new(),
            complaints: Vec::new(),
            folder,
        };
        let targets = browser.call("Target.getTargets", &json!({}));
        let targets = targets["targetInfos"].as_array().unwrap();
        let page = targets
            .iter()
            .find(|target| target["type"] == "page")
            .unwrap();
        let attach = json!({ "targetId": page["targetId"], "flatten": true });
        let attached = browser.call("Target.attachToTarget", &attach);
        browser.session = attached["sessionId"].as_str().unwrap().to_owned();
        for domain in ["Page", "Runtime", "Network", "Log"] {
            browser.call(&format!("{domain}.enable"), &json!({}));
        }
        browser.size(1000, 700);
        browser
    }

    /// Calls a method of the protocol and returns its result.
    pub fn call(&mut self, method: &str, params: &Value) -> Value {
        self.calls += 1;
        let id = self.calls;
        let mut message = json!({ "id": id, "method": method, "params": params });
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        let mut bytes = serde_json::to_vec(&message).unwrap();
        bytes.push(0);
        self.to.write_all(&bytes).unwrap();
        loop {
            let answer = self
                .from
                .recv_timeout(PATIENCE)
                .expect("the browser answers");
            if answer["id"] == id {
                assert!(
                    answer.get("error").is_none(),
                    "{method}: {}",
                    answer["error"]
                );
                return answer["result"].clone();
            }
            let params = &answer["params"];
            match answer["method"].as_str() {
                Some("Network.requestWillBeSent") => {
                    let address = params["request"]["url"].as_str().unwrap();
                    self.requests.push(address.to_owned());
                }
                Some("Runtime.exceptionThrown" | "Log.entryAdded" | "Runtime.consoleAPICalled") => {
                    self.complaints.push(params.to_string());
                }
                _ => {}
            }
        }
    }

    /// Sets the size of the page.
    pub fn size(&mut self, width: u32, height: u32) {
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", &size);
    }

    /// Returns the value of a JavaScript expression. Awaits promises.
    pub fn value(&mut self, expression: &str) -> Value {
        let evaluate =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let done = self.call("Runtime.evaluate", &evaluate);
        assert!(
            done.get("exceptionDetails").is_none(),
            "{expression}: {done}"
        );
        done["result"]["value"].clone()
    }

    /// Opens a file with `hash` after its name. Waits until the page shows a replay or a message.
    pub fn open(&mut self, file: &Path, hash: &str) {
        // Load another address first: changing only the hash would not reload the page.
        self.call("Page.navigate", &json!({ "url": "about:blank" }));
        let file = file.to_str().unwrap().replace(' ', "%20");
        self.call(
            "Page.navigate",
            &json!({ "url": format!("file://{file}{hash}") }),
        );
        let begun = std::time::Instant::now();
        while self.value(SETTLED) != json!(true) {
            assert!(begun.elapsed() < PATIENCE, "the page does not settle");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Presses and releases a key.
    pub fn key(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.call(
                "Input.dispatchKeyEvent",
                &json!({ "type": kind, "key": key }),
            );
        }
    }

    /// Performs an action with the left mouse button at a point.
    pub fn mouse(&mut self, what: Mouse, x: f64, y: f64) {
        let (kind, buttons) = match what {
            Mouse::Press => ("mousePressed", 1),
            Mouse::Drag => ("mouseMoved", 1),
            Mouse::Release => ("mouseReleased", 0),
        };
        let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", &event);
    }

    /// Drags one finger over the page.
    pub fn swipe(&mut self, from: (f64, f64), to: (f64, f64)) {
        let point = |(x, y): (f64, f64)| json!([{ "x": x, "y": y }]);
        for (kind, points) in [
            ("touchStart", point(from)),
            ("touchMove", point(to)),
            ("touchEnd", json!([])),
        ] {
            self.call(
                "Input.dispatchTouchEvent",
                &json!({ "type": kind, "touchPoints": points }),
            );
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        // Processes of the browser may still write there, so ignore errors.
        let _ = std::fs::remove_dir_all(self.folder.path());
    }
}
