//! What every browser can be asked.
use std::path::Path;

use serde_json::Value;

use crate::browser::Browser;
use crate::firefox::Firefox;

/// A browser with a page of a replay in it.
pub trait Page {
    /// Opens a file with something after its name; waits until it shows a replay or a message.
    fn open(&mut self, file: &Path, hash: &str);

    /// The value of an expression, or of the promise that it is.
    fn value(&mut self, expression: &str) -> Value;

    /// What is drawn on a flat sheet by `act`: each as `[what, style, numbers or a text and numbers]`, in the units of the page.
    fn drawn(&mut self, sheet: &str, act: &str) -> Vec<Value> {
        let drawn = self.value(&format!(
            "(async () => {{
                const proto = CanvasRenderingContext2D.prototype;
                const known = ['moveTo', 'lineTo', 'arc', 'fillRect', 'fillText'];
                const old = Object.fromEntries(known.map(name => [name, proto[name]]));
                const drawn = [];
                for (const name of known) proto[name] = function (...args) {{
                    const style = name === 'moveTo' || name === 'lineTo' ? this.strokeStyle : this.fillStyle;
                    if (this.canvas.id === '{sheet}') drawn.push([name, style, ...args]);
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
}
