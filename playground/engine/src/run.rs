//! Simulation of programs for the page.
use std::ops::ControlFlow;

use serde::Deserialize;
use serde_json::{Value, json};
use stochc_compiler::Program;
use stochc_ir::Executable;
use stochc_runtime::observe::{EventRows, ObservedEvent, Observer};
use stochc_runtime::world::SpatialWorld;
use stochc_runtime::world::view::pose;
use stochc_runtime::{Model, Settings};

use crate::check::checked;
use crate::host;

/// Size of a batch of frames in numbers, about 256 KiB.
const BATCH: usize = 1 << 16;
/// Largest number of ticks in a batch of frames.
const BATCH_TICKS: u64 = 256;
/// Initial number of ticks between two frames.
const EVERY: u64 = 4;

/// Program, model and seed of requested runs.
#[derive(Deserialize)]
pub struct RunRequest {
    text: String,
    /// Index of the program in the text.
    program: usize,
    model: Model,
    seed: u64,
    /// Number of the first run.
    #[serde(default)]
    first: u64,
    max_ticks: Option<u64>,
}

/// Compiles a program of a text.
pub fn executable(text: &str, program: usize) -> Result<Executable, String> {
    let mut checked = checked(text);
    if checked.has_errors() || program >= checked.programs.len() {
        return Err("The program has errors.".to_owned());
    }
    let program: Program = checked.programs.swap_remove(program);
    program
        .into_executable()
        .ok_or_else(|| "The program has errors.".to_owned())
}

impl RunRequest {
    fn executable(&self) -> Result<Executable, String> {
        executable(&self.text, self.program)
    }

    /// Returns the settings that the command uses for the same `--model`.
    fn settings(&self) -> Settings {
        let settings = match self.model {
            Model::Rigid | Model::Rapier => Settings::default(),
            model => Settings::new(model, 1),
        };
        Settings {
            model: self.model,
            max_ticks: self.max_ticks,
            ..settings
        }
    }
}

/// Returns the records of a range of runs as `{ records }`.
pub fn simulate(request: &RunRequest, runs: u64) -> Result<Value, String> {
    let (executable, settings) = (request.executable()?, request.settings());
    let runs = request.first..request.first.saturating_add(runs);
    let records = runs.map(|run| {
        let mut watch = |_, _| ControlFlow::Continue(());
        let (tables, scene) = (&executable.tables, &executable.scene);
        stochc_runtime::run(tables, scene, &settings, request.seed, run, &mut watch)
            .map_err(|error| error.to_string())
    });
    Ok(json!({ "records": records.collect::<Result<Vec<_>, _>>()? }))
}

/// Simulates a run and sends its frames to the page. Returns its record as `{ record }`.
pub fn watch(request: &RunRequest) -> Result<Value, String> {
    let (executable, settings) = (request.executable()?, request.settings());
    let (tables, scene) = (&executable.tables, &executable.scene);
    let mut stream = FrameStream {
        rows: EventRows::new(tables),
        every: EVERY,
        first: 0,
        ticks: Vec::new(),
        events: Vec::new(),
        places: Vec::new(),
        tick: 0,
    };
    let mut watch = |_, _| ControlFlow::Continue(());
    let (seed, run) = (request.seed, request.first);
    let record =
        stochc_runtime::observe(tables, scene, &settings, seed, run, &mut watch, &mut stream)
            .map_err(|error| error.to_string())?;
    stream.send();
    Ok(json!({ "record": record }))
}

/// Observer that sends the frames of a run to the page in batches.
struct FrameStream {
    rows: EventRows,
    /// Number of ticks between two frames.
    every: u64,
    /// First tick of the batch.
    first: u64,
    /// Last tick that was observed.
    tick: u64,
    ticks: Vec<u64>,
    events: Vec<Value>,
    places: Vec<f32>,
}

impl FrameStream {
    fn send(&mut self) {
        let text = json!({ "tick": self.tick, "ticks": self.ticks, "events": self.events });
        let every = host::send(&text.to_string(), &self.places);
        self.every = u64::from(every).max(1);
        self.first = self.tick;
        self.ticks.clear();
        self.events.clear();
        self.places.clear();
    }
}

impl Observer for FrameStream {
    fn look(&mut self, arena: &impl SpatialWorld, events: &[ObservedEvent]) {
        self.tick = arena.tick();
        let rows = events.iter().map(|event| self.rows.row(self.tick, event));
        self.events.extend(rows);
        // Pages interpolate between frames, so each change of the structure needs a frame.
        let changes = |event: &ObservedEvent| {
            !matches!(
                event,
                ObservedEvent::Entered { .. } | ObservedEvent::Left { .. }
            )
        };
        if self.tick.is_multiple_of(self.every) || events.iter().any(changes) {
            self.ticks.push(self.tick);
            self.places
                .extend((0..arena.count()).flat_map(|id| pose(arena, id)));
        }
        if self.places.len() >= BATCH || self.tick - self.first >= BATCH_TICKS {
            self.send();
        }
    }
}
