//! Tables that sum runs up. They are defined like those of Parquet, and have no files there.
use super::column::{
    ColumnDefinition, ColumnValues, TableDefinition, TableShape, integer, real, text,
};
use super::row::setting_column;
use crate::sweep::{Sweep, SweepPoint};
use crate::{Comparison, EnsembleProgram, Manifest, ProgramSummary, Time};

/// When a figure of a summary is null.
const UNKNOWN: &str = "it is not known";

/// A table with its values, column by column.
#[derive(Clone, Debug, PartialEq)]
pub struct FilledTable<'a> {
    /// Description of the table.
    pub shape: TableShape,
    /// One for each column.
    pub values: Vec<ColumnValues<'a>>,
}

impl<'a, R> TableDefinition<'a, R> {
    /// Returns the table of these rows.
    fn filled(&self, rows: &[R]) -> FilledTable<'a> {
        let columns = self.columns.iter();
        FilledTable {
            shape: self.shape(),
            values: columns.map(|column| column.values(rows)).collect(),
        }
    }
}

/// A program and its figures.
struct SummaryRow<'a> {
    program: &'a EnsembleProgram,
    summary: &'a ProgramSummary,
}

impl SummaryRow<'_> {
    fn time(&self, of: impl Fn(&Time) -> Option<f64>) -> Option<f64> {
        self.summary.time.as_ref().and_then(of)
    }
}

/// Returns the figures of each program, with the numbers of the scene that a sweep has chosen for it.
pub fn summary_table<'a>(manifest: &'a Manifest, comparison: &'a Comparison) -> FilledTable<'a> {
    type R<'a> = SummaryRow<'a>;
    let unit = comparison.time_unit;
    let mut columns = vec![ColumnDefinition::new(
        "program",
        "",
        "name of the program in the ensemble; of a sweep with its values",
        text(|row: &R<'a>| row.summary.name.as_str()),
    )];
    let axes = manifest.swept();
    columns.extend(axes.numbers.iter().map(|axis| {
        ColumnDefinition::new(
            axis.column(),
            axis.unit.clone(),
            "a number of the scene, which the sweep varies",
            real(move |row: &R<'a>| row.program.on_axis(axis)),
        )
        .null("the program is no point of the sweep")
    }));
    columns.extend(axes.settings.into_iter().map(|of| {
        ColumnDefinition::new(
            setting_column(of),
            "",
            "a setting, which the sweep varies",
            text(move |row: &R<'a>| row.program.chosen_value(of)),
        )
        .null("the setting is that of the ensemble")
    }));
    columns.extend([
        ColumnDefinition::new(
            "runs",
            "",
            "runs asked for",
            integer(|row: &R<'a>| row.summary.runs),
        ),
        ColumnDefinition::new(
            "finished",
            "",
            "runs finished",
            integer(|row: &R<'a>| row.summary.finished),
        ),
        ColumnDefinition::new(
            "completed",
            "",
            "runs that completed the structure",
            integer(|row: &R<'a>| row.summary.completed),
        ),
        ColumnDefinition::new(
            "timed_out",
            "",
            "runs that the timeout of a phase ended: they never complete",
            integer(|row: &R<'a>| row.summary.timed_out),
        ),
        ColumnDefinition::new(
            "censored",
            "",
            "runs that reached the limit of ticks: their times are longer",
            integer(|row: &R<'a>| row.summary.censored),
        ),
        ColumnDefinition::new(
            "failed",
            "",
            "runs whose physics broke down",
            integer(|row: &R<'a>| row.summary.failed),
        ),
        ColumnDefinition::new(
            "captures",
            "",
            "captures that the program makes",
            integer(|row: &R<'a>| row.summary.captures),
        ),
        ColumnDefinition::new(
            "blocks_used",
            "",
            "mean number of different blocks that a completed run captured",
            real(|row: &R<'a>| row.summary.blocks_used),
        )
        .null("no run completed"),
        ColumnDefinition::new(
            "tick",
            "s",
            "length of a tick",
            real(|row: &R<'a>| row.summary.tick),
        ),
        ColumnDefinition::new("unit", "", "unit of the times", text(move |_: &R<'a>| unit)),
        ColumnDefinition::new(
            "mean",
            unit,
            "mean time to completion; of min(time, horizon) if runs are incomplete: a lower bound",
            real(|row: &R<'a>| row.time(|it| Some(it.mean))),
        )
        .null(UNKNOWN),
        ColumnDefinition::new(
            "half_width",
            unit,
            "half of the 95 % interval of the mean",
            real(|row: &R<'a>| row.time(|it| it.half_width)),
        )
        .null(UNKNOWN),
        ColumnDefinition::new(
            "horizon",
            unit,
            "up to here the mean counts, if runs are incomplete",
            real(|row: &R<'a>| row.time(|it| it.horizon)),
        )
        .null("all runs completed"),
        ColumnDefinition::new(
            "median",
            unit,
            "median time to completion",
            real(|row: &R<'a>| row.time(|it| it.median)),
        )
        .null(UNKNOWN),
        ColumnDefinition::new(
            "sd",
            unit,
            "standard deviation",
            real(|row: &R<'a>| row.time(|it| it.sd)),
        )
        .null(UNKNOWN),
        ColumnDefinition::new(
            "min",
            unit,
            "the shortest time that was completed",
            real(|row: &R<'a>| row.time(|it| it.min)),
        )
        .null(UNKNOWN),
        ColumnDefinition::new(
            "max",
            unit,
            "the longest time",
            real(|row: &R<'a>| row.time(|it| it.max)),
        )
        .null(UNKNOWN),
    ]);
    let table = TableDefinition {
        name: "summary",
        row: "a program of the ensemble",
        columns,
    };
    let programs = manifest.programs.iter().zip(&comparison.programs);
    let rows: Vec<_> = programs
        .map(|(program, summary)| SummaryRow { program, summary })
        .collect();
    table.filled(&rows)
}

/// Returns a row for each point of a sweep, with a column for each axis.
pub fn sweep_table<'a>(sweep: &'a Sweep) -> FilledTable<'a> {
    type R<'a> = &'a SweepPoint;
    fn time(point: &SweepPoint, of: impl Fn(&Time) -> Option<f64>) -> Option<f64> {
        point.time.as_ref().and_then(of)
    }
    fn count<'a>(
        name: &'static str,
        meaning: &'static str,
        of: fn(&SweepPoint) -> usize,
    ) -> ColumnDefinition<'a, R<'a>> {
        let get = move |row: &R<'a>| of(row) as u64;
        ColumnDefinition::new(name, "", meaning, integer(get))
    }
    fn number<'a>(
        name: &'static str,
        unit: &'static str,
        meaning: &'static str,
        of: fn(&SweepPoint) -> Option<f64>,
    ) -> ColumnDefinition<'a, R<'a>> {
        let get = move |row: &R<'a>| of(row);
        ColumnDefinition::new(name, unit, meaning, real(get)).null(UNKNOWN)
    }
    let unit = sweep.unit;
    let mut columns = vec![ColumnDefinition::new(
        "program",
        "",
        "name of the program, without its values",
        text(|row: &R<'a>| row.program.as_str()),
    )];
    columns.extend(sweep.axes.iter().enumerate().map(|(place, axis)| {
        let value = move |row: &R<'a>| row.values.get(place).map(|value| value.value);
        ColumnDefinition::new(
            axis.label(),
            axis.unit.clone(),
            "a number of the scene",
            real(value),
        )
        .null(UNKNOWN)
    }));
    columns.extend(sweep.settings.iter().map(|of| {
        let value = move |row: &R<'a>| {
            let mut chosen = row.chosen.iter();
            chosen.find(|it| it.of() == of).map(|it| it.value())
        };
        ColumnDefinition::new(of.clone(), "", "a setting", text(value)).null(UNKNOWN)
    }));
    columns.extend([
        ColumnDefinition::new(
            "runs",
            "",
            "runs asked for",
            integer(|row: &R<'a>| row.runs),
        ),
        count("completed", "runs that completed", |it| it.completed),
        count("timed_out", "runs that a timeout ended", |it| it.timed_out),
        count("censored", "runs that reached the limit of ticks", |it| {
            it.censored
        }),
        count("failed", "runs whose physics broke down", |it| it.failed),
        number(
            "share",
            "",
            "share of the finished runs that completed, 0 to 1",
            |it| it.share,
        ),
        number("share_low", "", "lower end of its 95 % interval", |it| {
            it.share_interval.map(|interval| interval.0)
        }),
        number("share_high", "", "upper end", |it| {
            it.share_interval.map(|interval| interval.1)
        }),
        ColumnDefinition::new("unit", "", "unit of the times", text(move |_: &R<'a>| unit)),
        number("mean", unit, "mean time to completion", |it| {
            time(it, |it| Some(it.mean))
        }),
        number("half_width", unit, "half of its 95 % interval", |it| {
            time(it, |it| it.half_width)
        }),
        number("horizon", unit, "up to here the mean counts", |it| {
            time(it, |it| it.horizon)
        }),
        number("median", unit, "median time to completion", |it| {
            time(it, |it| it.median)
        }),
        ColumnDefinition::new(
            "captures",
            "",
            "captures made",
            integer(|row: &R<'a>| row.captures),
        ),
        number(
            "released",
            "",
            "share of the captured blocks that had been released",
            |it| it.released,
        ),
        number(
            "time_per_capture",
            unit,
            "time of all runs over the captures",
            |it| it.time_per_capture,
        ),
    ]);
    let table = TableDefinition {
        name: "sweep",
        row: "a point of the sweep",
        columns,
    };
    let rows: Vec<&SweepPoint> = sweep.points.iter().collect();
    table.filled(&rows)
}
