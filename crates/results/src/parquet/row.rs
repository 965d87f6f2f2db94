//! Rows about runs, and the columns that all tables share.
use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::table::PhaseId;

use super::column::TableDefinition;
use crate::manifest::SweepAxes;
use crate::{EnsembleProgram, Finished, Manifest};

/// Run that a row belongs to.
#[derive(Clone, Copy)]
pub(super) struct RunContext<'a> {
    pub manifest: &'a Manifest,
    pub program: &'a EnsembleProgram,
    pub record: &'a RunRecord,
}

impl RunContext<'_> {
    /// Converts ticks of the run to seconds, with the length of a tick in the run's scene.
    pub fn seconds(&self, ticks: u64) -> f64 {
        ticks as f64 * self.program.scene.tick
    }
}

/// Row of a table: an item of a run.
pub(super) struct RunRow<'a, T> {
    pub run: RunContext<'a>,
    pub item: T,
}

/// Returns the rows of all runs in order.
pub(super) fn rows<'a, T, I: IntoIterator<Item = T>>(
    manifest: &'a Manifest,
    finished: &'a [Finished],
    items: impl Fn(RunContext<'a>) -> I,
) -> Vec<RunRow<'a, T>> {
    let runs = finished.iter().map(|done| RunContext {
        manifest,
        program: &manifest.programs[done.program],
        record: &done.record,
    });
    let rows = runs.flat_map(|run| items(run).into_iter().map(move |item| RunRow { run, item }));
    rows.collect()
}

/// Creates a table. Its first columns are the run and the axes of a sweep.
pub(super) fn keyed<'a, T: 'a>(
    name: &'static str,
    row: &'static str,
    axes: &SweepAxes<'_>,
) -> TableDefinition<'a, RunRow<'a, T>> {
    let mut table = TableDefinition::<RunRow<'a, T>>::new(name, row);
    table.text(
        "program",
        "name of the program in the ensemble; in a sweep, with its values",
        |row| row.run.program.name.as_str(),
    );
    table.integer(
        "run",
        "number of the run, from 0; runs with the same number have the same random numbers in all programs",
        |row| row.run.record.run,
    );
    for axis in axes.numbers {
        let meaning = format!("scene parameter `{}` of the sweep", axis.name);
        let here = axis.clone();
        let get = move |row: &RunRow<'a, T>| row.run.program.on_axis(&here);
        let column = table.real(axis.column(), meaning, get);
        column.unit(axis.unit.clone());
        column.null("the program is not a point of the sweep");
    }
    for &setting in &axes.settings {
        let name = setting.to_owned();
        let meaning = format!("setting `{setting}` of the sweep");
        let get = move |row: &RunRow<'a, T>| row.run.program.chosen_value(&name);
        let column = table.text(setting_column(setting), meaning, get);
        column.null("the point uses the setting of the ensemble");
    }
    table
}

/// Returns the name of the column of a setting, such as `setting_solver_iterations`.
pub fn setting_column(setting: &str) -> String {
    format!("setting_{}", setting.replace('-', "_"))
}

/// Adds columns that describe the phase of each row. `phase` returns the phase of a row.
pub(super) fn add_phase<'a, T: 'a>(
    table: &mut TableDefinition<'a, RunRow<'a, T>>,
    phase: impl Fn(&T) -> PhaseId + Copy + 'a,
) {
    table.text("phase", "name of the phase", move |row| {
        row.run.program.phase(phase(&row.item))
    });
    table.integer(
        "phase_number",
        "index of the phase in the program, from 0",
        move |row| u64::from(phase(&row.item).0),
    );
    table.truth(
        "pre_attached",
        "whether the blocks of this phase are pre-attached",
        move |row| row.run.program.is_pre_attached(phase(&row.item)),
    );
}

/// Adds a column of ticks, and the column `seconds` with the same time.
pub(super) fn add_ticks<'a, T: 'a>(
    table: &mut TableDefinition<'a, RunRow<'a, T>>,
    name: &'static str,
    meaning: &'static str,
    ticks: impl Fn(&RunRow<'a, T>) -> u64 + Copy + 'a,
) {
    table.integer(name, meaning, ticks).unit("ticks");
    let seconds = move |row: &RunRow<'a, T>| row.run.seconds(ticks(row));
    table
        .real("seconds", "the same time in seconds of the scene", seconds)
        .unit("s");
}

pub(super) fn outcome(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Completed => "completed",
        Outcome::TimedOut {
            by: Limit::Timeout, ..
        } => "timed_out",
        Outcome::TimedOut {
            by: Limit::MaxTicks,
            ..
        } => "censored",
        Outcome::Failed {
            is_broken: true, ..
        } => "broken",
        Outcome::Failed { .. } => "failed",
    }
}
