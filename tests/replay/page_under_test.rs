//! Interface of the browsers that tests control.
use std::path::Path;

use serde_json::Value;

use crate::browser::Browser;
use crate::firefox::Firefox;

/// JavaScript condition for a settled page: it shows a replay or a message, or is truncated.
pub const SETTLED: &str = "document.readyState === 'complete' && location.protocol === 'file:' && \
     (document.body.dataset.ready === 'yes' || document.body.classList.contains('failed') || \
      !document.getElementById('whole'))";

/// Action with the left mouse button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mouse {
    Press,
    /// Moving with the button pressed.
    Drag,
    Release,
}

/// Browser that shows a replay page.
pub trait Page {
    /// Opens a file with `hash` after its name. Waits until the page shows a replay or a message.
    fn open(&mut self, file: &Path, hash: &str);

    /// Returns the value of a JavaScript expression. Awaits promises.
    fn value(&mut self, expression: &str) -> Value;

    /// Runs a script in the page.
    fn run(&mut self, script: &str);

    /// Sets the size of the page.
    fn size(&mut self, width: u32, height: u32);

    /// Presses and releases a key.
    fn key(&mut self, key: &str);

    /// Performs an action with the left mouse button at a point.
    fn mouse(&mut self, what: Mouse, x: f64, y: f64);

    /// Drags one finger over the page.
    fn swipe(&mut self, from: (f64, f64), to: (f64, f64));

    /// Clicks with the left mouse button at a point.
    fn click(&mut self, x: f64, y: f64) {
        self.mouse(Mouse::Press, x, y);
        self.mouse(Mouse::Release, x, y);
    }

    /// Returns the drawing calls on a canvas during `act`. `sheet` is the selector of the canvas.
    /// Each call is `[what, style, numbers or a text and numbers]`, in the units of the page.
    fn drawn(&mut self, sheet: &str, act: &str) -> Vec<Value> {
        let drawn = self.value(&format!(
            "(async () => {{
                const proto = CanvasRenderingContext2D.prototype;
                const known = ['moveTo', 'lineTo', 'arc', 'fillRect', 'fillText'];
                const old = Object.fromEntries(known.map(name => [name, proto[name]]));
                const drawn = [];
                for (const name of known) proto[name] = function (...args) {{
                    const style = name === 'moveTo' || name === 'lineTo' ? this.strokeStyle : this.fillStyle;
                    if (this.canvas.matches('{sheet}')) drawn.push([name, style, ...args]);
                    return old[name].apply(this, args);
                }};
                try {{
                    {act};
                    await replay.settled();
                }} finally {{
                    Object.assign(proto, old);
                }}
                return drawn;
            }})()"
        ));
        drawn.as_array().unwrap().clone()
    }
}

impl Page for Browser {
    fn open(&mut self, file: &Path, hash: &str) {
        Browser::open(self, file, hash);
    }

    fn value(&mut self, expression: &str) -> Value {
        Browser::value(self, expression)
    }

    fn run(&mut self, script: &str) {
        Browser::value(self, &format!("{script};1"));
    }

    fn size(&mut self, width: u32, height: u32) {
        Browser::size(self, width, height);
    }

    fn key(&mut self, key: &str) {
        Browser::key(self, key);
    }

    fn mouse(&mut self, what: Mouse, x: f64, y: f64) {
        Browser::mouse(self, what, x, y);
    }

    fn swipe(&mut self, from: (f64, f64), to: (f64, f64)) {
        Browser::swipe(self, from, to);
    }
}

impl Page for Firefox {
    fn open(&mut self, file: &Path, hash: &str) {
        Firefox::open(self, file, hash);
    }

    fn value(&mut self, expression: &str) -> Value {
        let value = Firefox::value(self, expression);
        let failed = value
            .as_str()
            .is_some_and(|text| text.starts_with("failed: "));
        assert!(!failed, "{expression}: {value}");
        value
    }

    fn run(&mut self, script: &str) {
        Firefox::run(self, script);
    }

    fn size(&mut self, width: u32, height: u32) {
        Firefox::size(self, width, height);
    }

    fn key(&mut self, key: &str) {
        Firefox::key(self, key);
    }

    fn mouse(&mut self, what: Mouse, x: f64, y: f64) {
        Firefox::mouse(self, what, x, y);
    }

    fn swipe(&mut self, from: (f64, f64), to: (f64, f64)) {
        Firefox::swipe(self, from, to);
    }
}
