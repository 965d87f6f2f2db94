//! Diagnostics as JSON.
use serde_json::{Value, json};
use stochc_compiler::diagnostic::{diagnostics_json, program_json};
use stochc_compiler::{Checked, Program};

/// JSON document with the diagnostics and programs of several files.
#[derive(Debug, Default)]
pub struct CheckDocument {
    diagnostics: Vec<Value>,
    programs: Vec<Value>,
    /// Physics of the scenes, as JSON. `None` without `--physics`.
    pub scenes: Option<Vec<Value>>,
}

impl CheckDocument {
    /// Adds the diagnostics and the programs of a file. `value` returns an additional value for a
    /// program. The value is stored under `key`.
    pub fn add(
        &mut self,
        file: &str,
        checked: &Checked,
        key: &str,
        value: impl Fn(&Program) -> Option<Value>,
    ) {
        self.diagnostics.extend(diagnostics_json(checked));
        for (number, checked_program) in checked.programs.iter().enumerate() {
            let mut document = program_json(file, checked, number);
            if let Some(value) = value(checked_program) {
                document[key] = value;
            }
            self.programs.push(document);
        }
    }

    /// Returns the document as text: `{ format, diagnostics, programs }`, with `scenes` if
    /// requested.
    pub fn text(self) -> String {
        let mut document = json!({
            "format": 1,
            "diagnostics": self.diagnostics,
            "programs": self.programs,
        });
        if let Some(scenes) = self.scenes {
            document["scenes"] = scenes.into();
        }
        format!("{document:#}\n")
    }
}
