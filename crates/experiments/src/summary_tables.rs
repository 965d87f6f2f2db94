//! Summary tables. They are defined like Parquet tables, but not written to files.
use crate::sweep::{Sweep, SweepPoint};
use crate::{Comparison, ProgramSummary, Time};
use stochc_results::parquet::setting_column;
use stochc_results::parquet::{FilledTable, TableDefinition};
use stochc_results::{EnsembleProgram, Manifest};

/// Condition for a null value in a summary table: the value is unknown.
const UNKNOWN: &str = "unknown";

/// Row of a summary table: a program with its results.
struct SummaryRow<'a> {
    program: &'a EnsembleProgram,
    summary: &'a ProgramSummary,
}

impl SummaryRow<'_> {
    fn time(&self, of: impl Fn(&Time) -> Option<f64>) -> Option<f64> {
        self.summary.time.as_ref().and_then(of)
    }
}

/// Returns a table with the results of each program. A sweep adds columns for its scene parameters.
pub fn summary_table<'a>(manifest: &'a Manifest, comparison: &'a Comparison) -> FilledTable<'a> {
    let mut table = TableDefinition::<SummaryRow<'a>>::new("summary", "a program of the ensemble");
    table.text(
        "program",
        "name of the program in the ensemble; of a sweep with its values",
        |row| row.summary.name.as_str(),
    );
    let axes = manifest.swept();
    for axis in axes.numbers {
        let meaning = "a number of the scene, which the sweep varies";
        let column = table.real(axis.column(), meaning, move |row| row.program.on_axis(axis));
        column.unit(axis.unit.clone());
        column.null("the program is no point of the sweep");
    }
    for of in axes.settings {
        let meaning = "a setting, which the sweep varies";
        let get = move |row: &SummaryRow<'a>| row.program.chosen_value(of);
        let column = table.text(setting_column(of), meaning, get);
        column.null("the setting is that of the ensemble");
    }
    table.integer("runs", "runs requested", |row| row.summary.runs);
    table.integer("finished", "runs finished", |row| row.summary.finished);
    table.integer("completed", "runs that completed the structure", |row| {
        row.summary.completed
    });
    table.integer(
        "timed_out",
        "runs that the timeout of a phase ended: they never complete",
        |row| row.summary.timed_out,
    );
    table.integer(
        "censored",
        "runs that reached the limit of ticks: their times are longer",
        |row| row.summary.censored,
    );
    table.integer(
        "failed",
        "runs whose physics had an error, or whose structure broke",
        |row| row.summary.failed,
    );
    table.integer("captures", "captures that the program makes", |row| {
        row.summary.captures
    });
    table
        .real(
            "blocks_used",
            "mean number of different blocks that a completed run captured",
            |row| row.summary.blocks_used,
        )
        .null("no run completed");
    table
        .real("tick", "length of a tick", |row| row.summary.tick)
        .unit("s");
    add_times(&mut table, comparison.time_unit);
    let programs = manifest.programs.iter().zip(&comparison.programs);
    let rows: Vec<_> = programs
        .map(|(program, summary)| SummaryRow { program, summary })
        .collect();
    table.filled(&rows)
}

/// Adds the columns about the completion time.
fn add_times<'a>(table: &mut TableDefinition<'a, SummaryRow<'a>>, unit: &'static str) {
    table.text("unit", "unit of the times", move |_| unit);
    table
        .real(
            "mean",
            "mean completion time; of min(time, horizon) if runs are incomplete: a lower bound",
            |row| row.time(|it| Some(it.mean)),
        )
        .unit(unit)
        .null(UNKNOWN);
    table
        .real(
            "half_width",
            "half of the 95 % interval of the mean",
            |row| row.time(|it| it.half_width),
        )
        .unit(unit)
        .null(UNKNOWN);
    table
        .real(
            "horizon",
            "horizon: a later time counts as this time, if runs are incomplete",
            |row| row.time(|it| it.horizon),
        )
        .unit(unit)
        .null("all runs completed");
    table
        .real("median", "median completion time", |row| {
            row.time(|it| it.median)
        })
        .unit(unit)
        .null(UNKNOWN);
    table
        .real("sd", "standard deviation", |row| row.time(|it| it.sd))
        .unit(unit)
        .null(UNKNOWN);
    table
        .real("min", "the shortest time that was completed", |row| {
            row.time(|it| it.min)
        })
        .unit(unit)
        .null(UNKNOWN);
    table
        .real("max", "the longest time", |row| row.time(|it| it.max))
        .unit(unit)
        .null(UNKNOWN);
}

/// Adds the columns of the numbers of runs by outcome, and of the share that completed.
fn add_outcomes(table: &mut TableDefinition<&SweepPoint>) {
    table.integer("runs", "runs requested", |row| row.runs);
    table.integer("completed", "runs that completed", |row| {
        row.completed as u64
    });
    table.integer("timed_out", "runs that a timeout ended", |row| {
        row.timed_out as u64
    });
    table.integer("censored", "runs that reached the limit of ticks", |row| {
        row.censored as u64
    });
    table.integer(
        "failed",
        "runs whose physics had an error, or whose structure broke",
        |row| row.failed as u64,
    );
    table
        .real(
            "share",
            "share of the finished runs that completed, 0 to 1",
            |row| row.share,
        )
        .null(UNKNOWN);
    table
        .real(
            "share_low",
            "lower end of the 95 % confidence interval of `share`",
            |row| row.share_interval.map(|interval| interval.0),
        )
        .null(UNKNOWN);
    table
        .real(
            "share_high",
            "upper end of the 95 % confidence interval of `share`",
            |row| row.share_interval.map(|interval| interval.1),
        )
        .null(UNKNOWN);
}

/// Returns a table with a row for each point of a sweep and a column for each axis.
pub(crate) fn sweep_table<'a>(sweep: &'a Sweep) -> FilledTable<'a> {
    fn time(point: &SweepPoint, of: impl Fn(&Time) -> Option<f64>) -> Option<f64> {
        point.time.as_ref().and_then(of)
    }
    let unit = sweep.unit;
    let mut table = TableDefinition::<&'a SweepPoint>::new("sweep", "a point of the sweep");
    let program = "name of the program, without its values";
    table.text("program", program, |row| row.program.as_str());
    for (place, axis) in sweep.axes.iter().enumerate() {
        let get = move |row: &&SweepPoint| row.values.get(place).map(|value| value.value);
        let column = table.real(axis.label(), "a number of the scene", get);
        column.unit(axis.unit.clone()).null(UNKNOWN);
    }
    for of in &sweep.settings {
        let get = move |row: &&'a SweepPoint| {
            let mut chosen = row.chosen.iter();
            chosen.find(|it| it.name() == of).map(|it| it.value())
        };
        table.text(of.clone(), "a setting", get).null(UNKNOWN);
    }
    add_outcomes(&mut table);
    table.text("unit", "unit of the times", move |_| unit);
    table
        .real("mean", "mean completion time", |row| {
            time(row, |it| Some(it.mean))
        })
        .unit(unit)
        .null(UNKNOWN);
    table
        .real(
            "half_width",
            "half-width of the 95 % confidence interval of the mean",
            |row| time(row, |row| row.half_width),
        )
        .unit(unit)
        .null(UNKNOWN);
    table
        .real(
            "horizon",
            "horizon: a later time counts as this time",
            |row| time(row, |row| row.horizon),
        )
        .unit(unit)
        .null(UNKNOWN);
    table
        .real("median", "median completion time", |row| {
            time(row, |row| row.median)
        })
        .unit(unit)
        .null(UNKNOWN);
    table.integer("captures", "number of captures in all runs", |row| {
        row.captures
    });
    table
        .real(
            "released",
            "share of the captured blocks that had been released",
            |row| row.released,
        )
        .null(UNKNOWN);
    table
        .real(
            "time_per_capture",
            "time of all runs, divided by their number of captures",
            |row| row.time_per_capture,
        )
        .unit(unit)
        .null(UNKNOWN);
    let rows: Vec<&SweepPoint> = sweep.points.iter().collect();
    table.filled(&rows)
}
