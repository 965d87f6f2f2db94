//! The page that shows an ensemble while it runs, and what it is told meanwhile.
//!
//! `page/` holds its parts; the arena is drawn by those of [`crate::replay`].
use std::time::Duration;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Value, json};
use stochc_ensemble::recording::RunFrame;
use stochc_ensemble::text::{escaped, visible, words};
use stochc_ensemble::{Manifest, ProgramTimes, Snapshot, Totals, ViewedRun, time_left};
use stochc_runtime::RunError;

use crate::figures::completion_so_far;
use crate::replay::{about, colours, script};
use crate::svg::STYLE as FIGURES;
use crate::template::{fill, policy};

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
const SCRIPT: &[&str] = &[
    include_str!("page/present.js"),
    include_str!("page/numbers.js"),
    include_str!("page/start.js"),
];

/// Programs that have a row, and a curve, of their own: there are as many colours.
const SHOWN: usize = 6;
/// Events of a program whose tables and graph are sent to a page.
const MOST_EVENTS: usize = 20_000;
/// Blocks of an arena that is sent to a page.
const MOST_BLOCKS: u32 = 100_000;

/// A page, and the policy to send with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Page {
    /// The page.
    pub html: String,
    /// What it may load and run, for `Content-Security-Policy`.
    pub policy: String,
}

/// The page of an ensemble. It gets what else it shows from `events` and `program/N` beside it.
pub fn page(manifest: &Manifest) -> Page {
    let script = script(SCRIPT);
    let more = "connect-src 'self'; img-src data:; ";
    let policy = policy(&script, more);
    let title = match &manifest.programs[..] {
        [program] => escaped(&program.name),
        programs => format!("{} programs", programs.len()),
    };
    let facts = format!(
        "{} runs each · {} · seed {}",
        manifest.runs,
        manifest.settings.model.name(),
        manifest.seed
    );
    let mut html = Vec::new();
    // Writing into memory cannot fail.
    let _ = fill(PAGE, &mut html, |name, out| {
        match name {
            "POLICY" => out.extend(policy.as_bytes()),
            "TITLE" => out.extend(title.as_bytes()),
            "FACTS" => out.extend(facts.as_bytes()),
            "STYLE" => out.extend(
                [&colours::style(), FIGURES.as_str(), STYLE]
                    .concat()
                    .bytes(),
            ),
            _ => out.extend(script.as_bytes()),
        }
        Ok(())
    });
    Page {
        html: String::from_utf8_lossy(&html).into_owned(),
        policy: format!("{policy}; frame-ancestors 'none'"),
    }
}

/// Why the arena of a program is not shown; `None`: it is.
pub fn not_shown(manifest: &Manifest, program: usize) -> Option<String> {
    let model = manifest.settings.model;
    let Some(program) = manifest.programs.get(program) else {
        return Some("there is no such program".to_owned());
    };
    let events = program.compiled.graph.events.len();
    let blocks = program.scene.free.count;
    if !model.has_places() {
        Some(RunError::Nowhere(model).to_string())
    } else if events > MOST_EVENTS {
        Some(format!(
            "{events} captures and releases are too many to be shown"
        ))
    } else if blocks > MOST_BLOCKS {
        Some(format!("{blocks} blocks are too many to be shown"))
    } else {
        None
    }
}

/// How far an ensemble is: `{ done, total, completed, stopped, failed, left, passed, programs, more, arena }`; `arena` is why no
/// arena is shown.
pub fn numbers(manifest: &Manifest, snapshot: &Snapshot, elapsed: Duration) -> Value {
    let Totals {
        stopped, failed, ..
    } = snapshot.totals;
    let programs = manifest.programs.iter().zip(&snapshot.totals.programs);
    let rows = programs.take(SHOWN).map(|(program, progress)| {
        let name = visible(&program.name);
        json!({ "name": name, "done": progress.done, "left": progress.left })
    });
    let mut arenas = (0..manifest.programs.len()).map(|program| not_shown(manifest, program));
    let first = arenas.next().flatten();
    // If one of them can be shown, it is waited for.
    let arena = first.filter(|_| arenas.all(|reason| reason.is_some()));
    json!({
        "done": snapshot.done,
        "total": snapshot.total,
        "completed": snapshot.done - stopped - failed,
        "stopped": stopped,
        "failed": failed,
        "left": time_left(snapshot, elapsed).map(words),
        "passed": words(elapsed),
        "programs": rows.collect::<Vec<_>>(),
        "more": manifest.programs.len().saturating_sub(SHOWN),
        "arena": arena,
    })
}

/// The curves of the runs so far, as SVG for the page; `None`: there is nothing to draw yet.
pub fn curves(manifest: &Manifest, times: &[ProgramTimes]) -> Option<String> {
    let drawing = completion_so_far(manifest, times, SHOWN)?;
    Some(drawing.inline(""))
}

/// What the page has to know of a program to draw its arena, as a recording's page knows it; `None`: it is not shown.
pub fn program(manifest: &Manifest, number: usize) -> Option<Value> {
    match not_shown(manifest, number) {
        Some(_) => None,
        None => {
            let program = &manifest.programs[number];
            Some(about(manifest, program, &[], Value::Null, false))
        }
    }
}

/// A run as it stands: `{ program, run, tick, phase, corner, step, numbers, held, active, in_reach, bonds }`, as in [`RunFrame`], `numbers`
/// as bytes in base64, the lower one first; `None`: nothing in it has a place.
pub fn frame(manifest: &Manifest, viewed: &ViewedRun) -> Option<Value> {
    let program = manifest.programs.get(viewed.program)?;
    let frame = RunFrame::of(&viewed.view, program.tables())?;
    let numbers: Vec<u8> = (frame.numbers.iter())
        .flat_map(|number| number.to_le_bytes())
        .collect();
    Some(json!({
        "program": viewed.program,
        "run": viewed.run,
        "tick": viewed.view.tick,
        "phase": viewed.view.phase,
        "corner": frame.corner,
        "step": frame.step,
        "numbers": BASE64.encode(numbers),
        "held": frame.held,
        "active": frame.active,
        "in_reach": frame.in_reach,
        "bonds": frame.bonds,
    }))
}
