//! Tables that are computed from runs.
use stochc::exit::Failure;
use stochc::experiments::statistics::{KaplanMeier, TimeSample};
use stochc::experiments::{Comparison, completion_time, summary_table};
use stochc::results::{ColumnShape, ColumnValues, FilledTable, Manifest, Records, TableShape};

use super::super::table::PythonTable;

/// Column with its name, unit, meaning and values.
struct DerivedColumn<'a>(&'a str, &'a str, &'a str, ColumnValues<'a>);

/// Returns a table. All its columns may contain null values.
fn table(name: &str, row: &str, columns: Vec<DerivedColumn<'_>>) -> Result<PythonTable, String> {
    let (mut shapes, mut values) = (Vec::new(), Vec::new());
    for DerivedColumn(name, unit, meaning, column) in columns {
        shapes.push(ColumnShape {
            name: name.to_owned(),
            kind: match column {
                ColumnValues::Float64(_) => "float64",
                ColumnValues::Int64(_) => "int64",
                _ => "text",
            },
            unit: unit.to_owned(),
            meaning: meaning.to_owned(),
            null: Some("unknown".to_owned()),
        });
        values.push(column);
    }
    let shape = TableShape {
        name: name.to_owned(),
        row: row.to_owned(),
        columns: shapes,
    };
    let mut table = PythonTable::new(shape, &[]);
    table.add(values)?;
    Ok(table)
}

/// Returns a table with the results of each program. A sweep adds its scene parameters.
pub(super) fn summary(manifest: &Manifest, comparison: &Comparison) -> Result<PythonTable, String> {
    let FilledTable { shape, values } = summary_table(manifest, comparison);
    let mut table = PythonTable::new(shape, &[]);
    table.add(values)?;
    Ok(table)
}

/// Returns a table with the fraction of incomplete runs after each completion time.
pub(super) fn survival(manifest: &Manifest, finished: &Records) -> Result<PythonTable, Failure> {
    let mut times = vec![TimeSample::default(); manifest.programs.len()];
    let read = finished.each(|done| {
        let time = completion_time(&done.record).into_iter();
        time.for_each(|it| times[done.program].push(it));
    });
    read.map_err(Failure::usage)?;
    let mut steps = Vec::new();
    for (program, times) in manifest.programs.iter().zip(&times) {
        let curve = KaplanMeier::new(&times.to_vec());
        let curve = curve.map(|it| it.curve()).unwrap_or_default();
        steps.extend(
            curve
                .into_iter()
                .map(|point| (program.name.as_str(), point)),
        );
    }
    let count = |value: usize| i64::try_from(value).ok();
    let points = || steps.iter().map(|(_, point)| point);
    let columns = vec![
        DerivedColumn(
            "program",
            "",
            "name of the program in the ensemble",
            ColumnValues::Text(steps.iter().map(|(name, _)| Some(*name)).collect()),
        ),
        DerivedColumn(
            "time",
            "ticks",
            "when one or more runs completed",
            ColumnValues::Float64(points().map(|it| Some(it.time)).collect()),
        ),
        DerivedColumn(
            "at_risk",
            "",
            "runs under observation just before",
            ColumnValues::Int64(points().map(|it| count(it.at_risk)).collect()),
        ),
        DerivedColumn(
            "completed",
            "",
            "runs that completed then",
            ColumnValues::Int64(points().map(|it| count(it.completed)).collect()),
        ),
        DerivedColumn(
            "incomplete",
            "",
            "the share of runs that is incomplete after it, 0 to 1, by Kaplan and Meier",
            ColumnValues::Float64(points().map(|it| Some(it.incomplete)).collect()),
        ),
        DerivedColumn(
            "low",
            "",
            "lower end of its 95 % interval",
            ColumnValues::Float64(points().map(|it| it.interval.map(|it| it.0)).collect()),
        ),
        DerivedColumn(
            "high",
            "",
            "upper end",
            ColumnValues::Float64(points().map(|it| it.interval.map(|it| it.1)).collect()),
        ),
    ];
    table(
        "survival",
        "a time when runs of a program completed",
        columns,
    )
    .map_err(Failure::usage)
}
