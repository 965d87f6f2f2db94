//! Rows of runs, and the columns that all tables have.
use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::table::PhaseId;

use super::column::{ColumnDefinition, integer, real, text, truth};
use crate::manifest::SweepAxes;
use crate::{EnsembleProgram, Finished, Manifest};

/// The run that a row belongs to.
#[derive(Clone, Copy)]
pub(super) struct RunContext<'a> {
    pub manifest: &'a Manifest,
    pub program: &'a EnsembleProgram,
    pub record: &'a RunRecord,
}

impl RunContext<'_> {
    /// Returns ticks of the run in seconds of its scene.
    pub fn seconds(&self, ticks: u64) -> f64 {
        ticks as f64 * self.program.scene.tick
    }
}

/// Something in a run.
pub(super) struct RunRow<'a, T> {
    pub run: RunContext<'a>,
    pub of: T,
}

/// The rows of all runs, in the order of the runs.
pub(super) fn rows<'a, T, I: IntoIterator<Item = T>>(
    manifest: &'a Manifest,
    finished: &'a [Finished],
    of: impl Fn(RunContext<'a>) -> I,
) -> Vec<RunRow<'a, T>> {
    let runs = finished.iter().map(|done| RunContext {
        manifest,
        program: &manifest.programs[done.program],
        record: &done.record,
    });
    let rows = runs.flat_map(|run| of(run).into_iter().map(move |of| RunRow { run, of }));
    rows.collect()
}

/// Which run it is, and the numbers of the scene in which the ensemble is swept.
pub(super) fn key<'a, T: 'a>(axes: &SweepAxes<'_>) -> Vec<ColumnDefinition<'a, RunRow<'a, T>>> {
    let mut columns = vec![
        ColumnDefinition::new(
            "program",
            "",
            "name of the program in the ensemble; of a sweep with its values",
            text(|row: &RunRow<'a, T>| row.run.program.name.as_str()),
        ),
        ColumnDefinition::new(
            "run",
            "",
            "number of the run, from 0; runs of one number have the same draws in all programs",
            integer(|row: &RunRow<'a, T>| row.run.record.run),
        ),
    ];
    columns.extend(axes.numbers.iter().map(|axis| {
        let here = axis.clone();
        ColumnDefinition::new(
            axis.column(),
            axis.unit.clone(),
            format!("`{}` of the scene, which the sweep varies", axis.of),
            real(move |row: &RunRow<'a, T>| row.run.program.on_axis(&here)),
        )
        .null("the program is no point of the sweep")
    }));
    columns.extend(axes.settings.iter().map(|&of| {
        let name = of.to_owned();
        ColumnDefinition::new(
            setting_column(of),
            "",
            format!("the setting `{of}`, which the sweep varies"),
            text(move |row: &RunRow<'a, T>| row.run.program.chosen_value(&name)),
        )
        .null("the setting is that of the ensemble")
    }));
    columns
}

/// Returns the name of the column of a setting, such as `setting_solver_iterations`.
pub(super) fn setting_column(of: &str) -> String {
    format!("setting_{}", of.replace('-', "_"))
}

/// In which phase it is.
pub(super) fn phase<'a, T: 'a>(
    of: impl Fn(&T) -> PhaseId + Copy + 'a,
) -> [ColumnDefinition<'a, RunRow<'a, T>>; 3] {
    [
        ColumnDefinition::new(
            "phase",
            "",
            "name of the phase",
            text(move |row: &RunRow<'a, T>| row.run.program.phase(of(&row.of))),
        ),
        ColumnDefinition::new(
            "phase_number",
            "",
            "index of the phase in the program, from 0",
            integer(move |row: &RunRow<'a, T>| u64::from(of(&row.of).0)),
        ),
        ColumnDefinition::new(
            "by_hand",
            "",
            "whether the blocks of this phase are attached by hand before the first tick",
            truth(move |row: &RunRow<'a, T>| row.run.program.is_planted(of(&row.of))),
        ),
    ]
}

/// How a run ended, in a word.
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
        Outcome::Failed { .. } => "failed",
    }
}
