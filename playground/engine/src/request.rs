//! Requests of the page, and the reply to each.
use serde::Deserialize;
use serde_json::{Value, json};
use stochc_compiler::diagnostic::Code;
use stochc_runtime::Model;
use stochc_text::palette;

use crate::check;
use crate::examples::EXAMPLES;
use crate::run::{self, RunRequest};

/// Request of the page.
#[derive(Deserialize)]
#[serde(tag = "call", rename_all = "snake_case")]
enum Request {
    /// Examples, palette, version and models.
    About,
    /// Diagnostics of a program, and its structure.
    Check { text: String },
    /// Completion times by the rate model.
    Estimate { text: String, program: usize },
    /// The text in the standard layout.
    Format { text: String },
    /// The page of a diagnostic.
    Explain { code: String },
    /// The record of each run in a range.
    Simulate {
        #[serde(flatten)]
        run: RunRequest,
        runs: u64,
    },
    /// The record of one run. Its frames go to the host.
    Watch {
        #[serde(flatten)]
        run: RunRequest,
    },
}

/// Returns the reply to a request, or `{ error }`.
pub fn answer(request: &[u8]) -> String {
    let reply = serde_json::from_slice(request)
        .map_err(|error| error.to_string())
        .and_then(reply);
    reply
        .unwrap_or_else(|error| json!({ "error": error }))
        .to_string()
}

fn reply(request: Request) -> Result<Value, String> {
    match request {
        Request::About => Ok(about()),
        Request::Check { text } => Ok(check::check(&text)),
        Request::Estimate { text, program } => check::estimate(&text, program),
        Request::Format { text } => stochc_grammar::format(&text)
            .map(|text| json!({ "text": text }))
            .map_err(|_| "The program has syntax errors.".to_owned()),
        Request::Explain { code } => Code::from_name(&code)
            .map(|code| json!({ "page": code.page() }))
            .ok_or_else(|| format!("`{code}` is not a code")),
        Request::Simulate { run, runs } => run::simulate(&run, runs),
        Request::Watch { run } => run::watch(&run),
    }
}

fn about() -> Value {
    let examples = EXAMPLES
        .iter()
        .map(|(name, text)| json!({ "name": name, "text": text }));
    let models = Model::ALL
        .into_iter()
        .filter(|&model| model != Model::Rapier);
    let models = models.map(|model| json!({ "name": model.name(), "meaning": model.meaning() }));
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "examples": examples.collect::<Vec<_>>(),
        "models": models.collect::<Vec<_>>(),
        "palette": serde_json::from_str::<Value>(&palette::json()).ok(),
    })
}
