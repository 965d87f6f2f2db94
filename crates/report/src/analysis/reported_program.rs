//! Program of a report, with the accumulated data of its runs.
use std::collections::BTreeSet;
use std::io;

use stochc_experiments::statistics::{Observation, TimeSample};
use stochc_experiments::sweep::{PointTally, Sweep, SweepTally};
use stochc_experiments::{
    OutcomeCounts, TimeUnit, WaitsTally, completion_status, completion_time, phase_time,
    sort_by_time,
};
use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::PhaseId;
use stochc_results::{EnsembleProgram, JournalError, Manifest, Records};
use stochc_text::{Tick, number};

use crate::presentation::Presentation;
use crate::svg::PlotAxis;

use super::critical_path::{CriticalPathSegment, critical_path, moments};
use super::decisive_events::DecisiveEvents;
use super::events::Events;
use super::slow_runs::{MIN_RUNS, SlowRuns};

/// Error of creating a report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The runs cannot be read again.
    #[error(transparent)]
    Runs(#[from] JournalError),
    /// The rows of a run cannot be written to a table.
    #[error("cannot write the report: {0}")]
    Write(#[from] io::Error),
}

/// Results folder that has been read for a report.
#[derive(Clone, Debug)]
pub struct Input {
    /// Path of the folder, as the user wrote it.
    pub path: String,
    /// Manifest of the folder.
    pub manifest: Manifest,
    /// Records of the finished runs.
    pub finished: Records,
}

/// Program of a report, with the accumulated data of its runs. Stores only a few bytes per run.
#[derive(Clone, Debug)]
pub(crate) struct ReportedProgram<'a> {
    /// Name in tables, unique within the report.
    pub label: String,
    /// Whether times in figures are in seconds. Otherwise they are in ticks.
    in_seconds: bool,
    /// Index of the program's results folder in the report.
    pub folder: usize,
    /// Index of the program in the manifest of its folder.
    pub number: usize,
    pub manifest: &'a Manifest,
    pub program: &'a EnsembleProgram,
    pub events: Events,
    /// Run number and completion time \[ticks\] of each run. Failed runs are excluded, except those
    /// with a broken structure.
    pub times: Vec<(u64, Observation)>,
    /// Number of finished runs with each outcome.
    pub outcomes: OutcomeCounts,
    /// Numbers of the runs with a broken structure.
    broken: BTreeSet<u64>,
    /// Details of the first failed runs.
    pub failures: Vec<FailedRun>,
    /// Accumulated results of the program, as if it were one point of a sweep.
    pub point: PointTally,
    pub waits: WaitsTally,
    pub decisive: DecisiveEvents,
    phase_times: Vec<TimeSample>,
    /// Times from the start until the largest group of an aggregate reached each size. Empty for
    /// assemblies.
    size_times: Vec<TimeSample>,
    /// Example runs, each with a description such as "median".
    example_runs: Vec<(&'static str, FinishedRun)>,
    /// `None` if the program has too few runs, or is an aggregate.
    pub slow_runs: Option<SlowRuns>,
}

#[derive(Clone, Debug)]
pub(crate) struct FailedRun {
    pub run: u64,
    pub phase: PhaseId,
    pub tick: u64,
    pub reason: String,
}

#[derive(Clone, Debug)]
pub(crate) struct FinishedRun {
    pub record: RunRecord,
    pub critical_path: Vec<CriticalPathSegment>,
}

impl FinishedRun {
    pub fn from_record(events: &Events, record: &RunRecord) -> FinishedRun {
        let moments = moments(events, record);
        FinishedRun {
            critical_path: critical_path(events, record, &moments),
            record: record.clone(),
        }
    }
}

/// Collects the programs and sweeps of all folders in order. Calls `each` for each run.
pub(crate) fn subjects<'a>(
    inputs: &'a [Input],
    shown: &Presentation,
    each: &mut dyn FnMut(&ReportedProgram, &FinishedRun) -> io::Result<()>,
) -> Result<(Vec<ReportedProgram<'a>>, Vec<Sweep>), ReportError> {
    let programs = inputs.iter().flat_map(|input| &input.manifest.programs);
    let clock = shown.unit(programs);
    let (mut subjects, mut sweeps) = (Vec::new(), Vec::new());
    for (folder, input) in inputs.iter().enumerate() {
        let first = subjects.len();
        let programs = input.manifest.programs.iter().enumerate();
        subjects.extend(
            programs.map(|(number, _)| ReportedProgram::new(inputs, folder, number, clock, shown)),
        );
        let mut sweep = SweepTally::new(&input.manifest);
        input.finished.try_each(|done| {
            if let Some(sweep) = &mut sweep {
                sweep.add(done);
            }
            let subject: &mut ReportedProgram = &mut subjects[first + done.program];
            let run = FinishedRun::from_record(&subject.events, &done.record);
            each(subject, &run)?;
            subject.add(&run);
            Ok::<_, ReportError>(())
        })?;
        for subject in &mut subjects[first..] {
            subject.choose(&input.finished)?;
            subject.compare_slow_runs(&input.finished)?;
        }
        sweeps.extend(sweep.map(|sweep| shown_sweep(sweep.finish(), shown)));
    }
    Ok((subjects, sweeps))
}

/// Returns a sweep with the units and names of the presentation.
fn shown_sweep(sweep: Sweep, shown: &Presentation) -> Sweep {
    let mut sweep = if shown.in_seconds {
        sweep.in_seconds()
    } else {
        sweep
    };
    sweep.relabel(|name| shown.label(name));
    sweep
}

/// Returns the last part of a folder's path if it is unique within the report. Otherwise returns
/// the whole path.
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

impl<'a> ReportedProgram<'a> {
    /// Creates the data of a program without runs.
    fn new(
        inputs: &'a [Input],
        folder: usize,
        number: usize,
        clock: TimeUnit,
        shown: &Presentation,
    ) -> ReportedProgram<'a> {
        let manifest = &inputs[folder].manifest;
        let program = &manifest.programs[number];
        let same = |other: &&Input| {
            let mut programs = other.manifest.programs.iter();
            programs.any(|p| p.name == program.name)
        };
        let is_shared = inputs.iter().filter(same).count() > 1;
        let events = Events::new(program);
        ReportedProgram {
            label: if is_shared {
                format!(
                    "{} ({})",
                    shown.label(&program.name),
                    short_path(inputs, folder)
                )
            } else {
                shown.label(&program.name)
            },
            in_seconds: shown.in_seconds,
            folder,
            number,
            manifest,
            program,
            times: Vec::new(),
            outcomes: OutcomeCounts::default(),
            failures: Vec::new(),
            point: PointTally::new(clock.tick(program)),
            waits: WaitsTally::default(),
            decisive: DecisiveEvents::new(&events),
            phase_times: vec![TimeSample::default(); program.phases().len()],
            size_times: vec![TimeSample::default(); program.phases().len()],
            example_runs: Vec::new(),
            broken: BTreeSet::new(),
            slow_runs: None,
            events,
        }
    }

    fn add(&mut self, run: &FinishedRun) {
        /// Largest number of failed runs whose details are stored.
        const MAX_FAILURES: usize = 5;
        let record = &run.record;
        let time = completion_time(record);
        self.times.extend(time.map(|time| (record.run, time)));
        self.outcomes.add(&record.outcome);
        if record.outcome.is_broken() {
            self.broken.insert(record.run);
        }
        for (phase, times) in self.phase_times.iter_mut().enumerate() {
            if let Some(time) = phase_time(record, phase) {
                times.push(time);
            }
        }
        if self.is_aggregate() {
            self.add_sizes(record);
        }
        self.point.add(self.program, record);
        self.waits.add(record);
        match &record.outcome {
            Outcome::Failed { phase, reason, .. } => {
                if self.failures.len() < MAX_FAILURES {
                    self.failures.push(FailedRun {
                        run: record.run,
                        phase: *phase,
                        tick: record.ticks,
                        reason: reason.clone(),
                    });
                }
            }
            _ => {
                self.decisive.add(record.ticks, &run.critical_path);
            }
        }
    }

    /// Selects the fastest, the median and the slowest run as examples, without duplicates. A
    /// stopped run counts as slower than all runs that completed before it was stopped.
    fn choose(&mut self, finished: &Records) -> Result<(), ReportError> {
        let mut runs = self.times.clone();
        sort_by_time(&mut runs);
        let places = match runs.len() {
            0 => vec![],
            1 => vec![("only", 0)],
            2 => vec![("fastest", 0), ("slowest", 1)],
            n => vec![("fastest", 0), ("median", (n - 1) / 2), ("slowest", n - 1)],
        };
        for (what, place) in places {
            if let Some(done) = finished.get(self.number, runs[place].0)? {
                self.example_runs
                    .push((what, FinishedRun::from_record(&self.events, &done.record)));
            }
        }
        Ok(())
    }

    /// Compares the critical paths of the slowest and the fastest tenth of the runs.
    fn compare_slow_runs(&mut self, finished: &Records) -> Result<(), ReportError> {
        // A failed run has no critical path.
        let mut runs: Vec<_> = (self.times.iter().copied())
            .filter(|(run, _)| !self.broken.contains(run))
            .collect();
        if runs.len() < MIN_RUNS || self.is_aggregate() {
            return Ok(());
        }
        sort_by_time(&mut runs);
        let tenth = runs.len() / 10;
        let mut slow_runs = SlowRuns::new(&self.events, tenth);
        let read = |(run, _): &(u64, Observation)| {
            let done = finished.get(self.number, *run)?;
            Ok::<_, ReportError>(done.map(|it| FinishedRun::from_record(&self.events, &it.record)))
        };
        for run in &runs[..tenth] {
            if let Some(run) = read(run)? {
                slow_runs.add_fast(&run);
            }
        }
        for run in &runs[runs.len() - tenth..] {
            if let Some(run) = read(run)? {
                slow_runs.add_slow(&run);
            }
        }
        self.slow_runs = Some(slow_runs);
        Ok(())
    }

    /// For each size, adds the time from the start of the run until the run's largest group reached
    /// this size. Failed computations add nothing.
    fn add_sizes(&mut self, record: &RunRecord) {
        let Some(status) = completion_status(&record.outcome) else {
            return;
        };
        let mut tick: u64 = 0;
        for (size, times) in self.size_times.iter_mut().enumerate() {
            let ticks = record.phase_ticks.get(size);
            tick = tick.saturating_add(ticks.copied().unwrap_or(0));
            times.push(match ticks {
                Some(_) => Observation::completed(tick as f64),
                None => Observation {
                    time: record.ticks as f64,
                    status,
                },
            });
        }
    }

    /// Returns whether the program is an aggregate, whose blocks bond to each other without a
    /// plate.
    pub fn is_aggregate(&self) -> bool {
        self.program.tables().aggregate.is_some()
    }

    /// Returns the times from the start until an aggregate's largest group reached a size
    /// \[ticks\]. `phase` is the index of the phase that ends at this size.
    pub fn size_times(&self, phase: usize) -> Vec<Observation> {
        self.size_times[phase].to_vec()
    }

    pub fn tick(&self) -> Tick {
        Tick(self.program.scene.tick)
    }

    /// Returns the time axis for figures of this program. Its values come from
    /// [`ReportedProgram::on_axis`].
    pub fn time_axis(&self, what: &str) -> PlotAxis {
        if self.in_seconds {
            PlotAxis::new(what, TimeUnit::Seconds.unit())
        } else {
            PlotAxis::new(what, &self.tick().unit())
        }
    }

    /// Converts a time in ticks to the unit of the time axis in figures.
    pub fn on_axis(&self, ticks: f64) -> f64 {
        if self.in_seconds {
            ticks * self.program.scene.tick
        } else {
            ticks
        }
    }

    /// Returns a time in ticks as text, in the unit of figures.
    pub fn described(&self, ticks: f64) -> String {
        format!("{} {}", number(self.on_axis(ticks)), self.figure_unit())
    }

    /// Returns the interval that event rates refer to in figures: its name and its length
    /// \[ticks\].
    pub fn rate_interval(&self) -> (&'static str, f64) {
        if self.in_seconds {
            ("second", 1.0 / self.program.scene.tick)
        } else {
            ("1000 ticks", 1000.0)
        }
    }

    pub fn figure_unit(&self) -> &'static str {
        let unit = if self.in_seconds {
            TimeUnit::Seconds
        } else {
            TimeUnit::Ticks
        };
        unit.unit()
    }

    /// Returns the completion times \[ticks\]. Failed runs are excluded, except those with a broken
    /// structure.
    pub fn times(&self) -> Vec<Observation> {
        self.times.iter().map(|&(_, time)| time).collect()
    }

    pub fn times_by(&self, clock: TimeUnit) -> Vec<Observation> {
        let mut times = self.times();
        for time in &mut times {
            time.time *= clock.tick(self.program);
        }
        times
    }

    /// Returns the durations of a phase \[ticks\] in all runs that reached it and did not fail.
    pub fn phase_times(&self, phase: usize) -> Vec<Observation> {
        self.phase_times[phase].to_vec()
    }

    /// Returns the fastest, the median and the slowest run, each once.
    pub fn example_runs(&self) -> &[(&'static str, FinishedRun)] {
        &self.example_runs
    }
}

/// Returns the latest observed time of all runs of all programs, in the unit `clock`.
pub fn last_seen(programs: &[ReportedProgram<'_>], clock: TimeUnit) -> f64 {
    let times = programs.iter().flat_map(|it| it.times_by(clock));
    stochc_experiments::last_seen(times)
}
