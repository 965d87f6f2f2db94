//! One program of one folder: its runs, and what can be told of each.
use stochc_ensemble::statistics::Observation;
use stochc_ensemble::text::Tick;
use stochc_ensemble::{Finished, Manifest, Program, TimeUnit, completion_time, phase_time};
use stochc_ir::record::{Outcome, RunRecord};

use super::critical_path::{Link, chain, moments};
use super::events::Events;

/// A results folder that has been read.
#[derive(Clone, Debug)]
pub struct Input {
    /// Its path, as it was given.
    pub path: String,
    /// What it holds runs of.
    pub manifest: Manifest,
    /// Its finished runs, sorted by program and run.
    pub finished: Vec<Finished>,
}

/// A program of a folder.
#[derive(Clone, Debug)]
pub(crate) struct Subject<'a> {
    /// What it is called in tables; unique within the report.
    pub label: String,
    /// The number of its folder.
    pub folder: usize,
    /// Its number in the folder's manifest.
    pub number: usize,
    pub manifest: &'a Manifest,
    pub program: &'a Program,
    pub events: Events,
    pub runs: Vec<Run>,
}

/// A finished run.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub record: RunRecord,
    pub chain: Vec<Link>,
}

/// The programs of all folders, in their order.
pub(crate) fn subjects(inputs: &[Input]) -> Vec<Subject<'_>> {
    let mut subjects = Vec::new();
    for (folder, input) in inputs.iter().enumerate() {
        for (number, program) in input.manifest.programs.iter().enumerate() {
            let finished = input.finished.iter();
            let records = finished.filter(|done| done.program == number);
            let records: Vec<RunRecord> = records.map(|done| done.record.clone()).collect();
            let events = Events::of(program);
            let run = |record: RunRecord| {
                let moments = moments(&events, &record);
                let chain = chain(&events, &record, &moments);
                Run { record, chain }
            };
            let runs = records.into_iter().map(run).collect();
            let same = |other: &Input| {
                other
                    .manifest
                    .programs
                    .iter()
                    .any(|p| p.name == program.name)
            };
            let shared = inputs.iter().filter(|other| same(other)).count() > 1;
            subjects.push(Subject {
                label: match shared {
                    true => format!("{} ({})", program.name, short_path(inputs, folder)),
                    false => program.name.clone(),
                },
                folder,
                number,
                manifest: &input.manifest,
                program,
                events,
                runs,
            });
        }
    }
    subjects
}

/// The last part of a folder's path, if no other folder of the report has the same.
fn short_path(inputs: &[Input], folder: usize) -> &str {
    let last = |input: &'_ Input| {
        let path = input.path.trim_end_matches('/');
        path.rfind('/').map_or(0, |slash| slash + 1)
    };
    let part = |input: &'_ Input| input.path[last(input)..].trim_end_matches('/').to_owned();
    let own = part(&inputs[folder]);
    let same = inputs.iter().filter(|input| part(input) == own).count();
    let path = &inputs[folder].path;
    if same > 1 || own.is_empty() || own == "." || own == ".." {
        path
    } else {
        path[last(&inputs[folder])..].trim_end_matches('/')
    }
}

impl Subject<'_> {
    /// The clock of its scene.
    pub fn tick(&self) -> Tick {
        Tick(self.program.scene.tick)
    }

    /// Times to completion, in ticks; a failed run has none.
    pub fn times(&self) -> Vec<Observation> {
        self.runs.iter().filter_map(Run::time).collect()
    }

    /// The same in the unit of a clock.
    pub fn times_by(&self, clock: TimeUnit) -> Vec<Observation> {
        let mut times = self.times();
        for time in &mut times {
            time.time *= clock.tick(self.program);
        }
        times
    }

    /// Times of a phase, in ticks from its beginning, of the runs that reached it and did not fail.
    pub fn phase_times(&self, phase: usize) -> Vec<Observation> {
        let runs = self.runs.iter();
        runs.filter_map(|run| run.phase_time(phase)).collect()
    }

    /// How many runs completed, were stopped, and failed.
    pub fn counts(&self) -> (usize, usize, usize) {
        let completed = |run: &&Run| run.record.outcome == Outcome::Completed;
        let stopped = |run: &&Run| matches!(run.record.outcome, Outcome::TimedOut { .. });
        let completed = self.runs.iter().filter(completed).count();
        let stopped = self.runs.iter().filter(stopped).count();
        (completed, stopped, self.runs.len() - completed - stopped)
    }

    /// The fastest run, the one in the middle, and the slowest, each once; a stopped run is slower
    /// than all that completed before.
    pub fn told(&self) -> Vec<(&'static str, &Run)> {
        let mut runs: Vec<(Observation, &Run)> = (self.runs.iter())
            .filter_map(|run| Some((run.time()?, run)))
            .collect();
        runs.sort_by(|(a, _), (b, _)| {
            let times = a.time.total_cmp(&b.time);
            times.then(b.completed.cmp(&a.completed))
        });
        let places = match runs.len() {
            0 => vec![],
            1 => vec![("only", 0)],
            2 => vec![("fastest", 0), ("slowest", 1)],
            n => vec![("fastest", 0), ("median", (n - 1) / 2), ("slowest", n - 1)],
        };
        let told = places.into_iter();
        told.map(|(what, place)| (what, runs[place].1)).collect()
    }
}

impl Run {
    /// The time to completion in ticks; a failed run has none.
    pub fn time(&self) -> Option<Observation> {
        completion_time(&self.record)
    }

    fn phase_time(&self, phase: usize) -> Option<Observation> {
        phase_time(&self.record, phase)
    }
}
