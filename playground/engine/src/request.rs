//! Requests of the page, and their replies.
use serde::Deserialize;
use serde_json::{Value, json};
use stochc_compiler::diagnostic::Code;
use stochc_ir::record::RunRecord;
use stochc_ir::scene::schema::CLAUSES;
use stochc_runtime::Model;
use stochc_text::palette;

use crate::check;
use crate::ensemble;
use crate::examples::EXAMPLES;
use crate::plan::{self, Drawing};
use crate::run::{self, RunRequest};

/// Request that the page sends.
#[derive(Deserialize)]
#[serde(tag = "call", rename_all = "snake_case")]
enum Request {
    /// Requests the examples, palette, version, models and clauses of scenes.
    About,
    /// Requests the diagnostics of a program, and its structure.
    Check { text: String },
    /// Requests the completion times by the rate model.
    Estimate { text: String, program: usize },
    /// Requests the formatted source.
    Format { text: String },
    /// Requests the page about a diagnostic code.
    Explain { code: String },
    /// Requests the cells of a drawing.
    ReadDrawing { drawing: Drawing },
    /// Requests a planned program for a drawing.
    Plan { drawing: Drawing },
    /// Requests the records of a range of runs.
    Simulate {
        #[serde(flatten)]
        run: RunRequest,
        runs: u64,
    },
    /// Requests the statistics of finished runs.
    Summarize {
        text: String,
        program: usize,
        records: Vec<RunRecord>,
    },
    /// Requests the record of one run. The host receives its frames during the run.
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
        Request::ReadDrawing { drawing } => plan::read(drawing),
        Request::Plan { drawing } => plan::plan(drawing),
        Request::Simulate { run, runs } => run::simulate(&run, runs),
        Request::Summarize {
            text,
            program,
            records,
        } => ensemble::summarize(&text, program, &records),
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
        "terms": CLAUSES.iter().map(|clause| clause.word).collect::<Vec<_>>(),
        "palette": serde_json::from_str::<Value>(&palette::json()).ok(),
    })
}
