//! Tables that sum runs up.
use stochc::ensemble::statistics::{KaplanMeier, TimeSample};
use stochc::ensemble::{
    ColumnShape, ColumnValues, Comparison, Manifest, ProgramSummary, Records, TableShape, Time,
    Varied, completion_time,
};
use stochc::exit::Failure;

use super::super::table::PythonTable;

/// A column and its values: name, unit, meaning.
struct DerivedColumn<'a>(&'a str, &'a str, &'a str, ColumnValues<'a>);

/// A table of columns in which everything may be null.
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
            null: Some("it is not known".to_owned()),
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

/// The figures of each program, and the numbers of the scene that a sweep has chosen for it.
pub(super) fn summary(manifest: &Manifest, comparison: &Comparison) -> Result<PythonTable, String> {
    let programs = &comparison.programs;
    let count = |of: fn(&ProgramSummary) -> u64| {
        let values = programs.iter().map(|it| i64::try_from(of(it)).ok());
        ColumnValues::Int64(values.collect())
    };
    let time = |of: fn(&Time) -> Option<f64>| {
        let values = programs.iter().map(|it| it.time.as_ref().and_then(of));
        ColumnValues::Float64(values.collect())
    };
    let axes: Vec<String> = manifest.axes().iter().map(Varied::column).collect();
    let mut columns = vec![DerivedColumn(
        "program",
        "",
        "name of the program in the ensemble; of a sweep with its values",
        ColumnValues::Text(programs.iter().map(|it| Some(it.name.as_str())).collect()),
    )];
    for (axis, name) in manifest.axes().iter().zip(&axes) {
        let here = manifest.programs.iter().map(|it| it.on_axis(axis));
        let values = ColumnValues::Float64(here.collect());
        columns.push(DerivedColumn(
            name,
            &axis.unit,
            "a number of the scene, which the sweep varies",
            values,
        ));
    }
    columns.extend([
        DerivedColumn("runs", "", "runs asked for", count(|it| it.runs)),
        DerivedColumn("finished", "", "runs finished", count(|it| it.finished)),
        DerivedColumn("completed", "", "runs that completed the structure", count(|it| it.completed)),
        DerivedColumn(
            "timed_out",
            "",
            "runs that the timeout of a phase ended: they never complete",
            count(|it| it.timed_out),
        ),
        DerivedColumn(
            "censored",
            "",
            "runs that reached the limit of ticks: their times are longer",
            count(|it| it.censored),
        ),
        DerivedColumn("failed", "", "runs whose physics broke down", count(|it| it.failed)),
        DerivedColumn("captures", "", "captures that the program makes", count(|it| it.captures)),
        DerivedColumn(
            "blocks_used",
            "",
            "mean number of different blocks that a completed run captured",
            ColumnValues::Float64(programs.iter().map(|it| it.blocks_used).collect()),
        ),
        DerivedColumn(
            "tick",
            "s",
            "length of a tick",
            ColumnValues::Float64(programs.iter().map(|it| Some(it.tick)).collect()),
        ),
        DerivedColumn(
            "mean",
            "ticks",
            "mean time to completion; where times are censored, of min(time, horizon): a lower bound",
            time(|it| Some(it.mean)),
        ),
        DerivedColumn("half_width", "ticks", "half of the 95 % interval of the mean", time(|it| it.half_width)),
        DerivedColumn("horizon", "ticks", "up to here the mean counts, where times are censored", time(|it| it.horizon)),
        DerivedColumn("median", "ticks", "median time to completion", time(|it| it.median)),
        DerivedColumn("sd", "ticks", "standard deviation", time(|it| it.sd)),
        DerivedColumn("min", "ticks", "the shortest time that was completed", time(|it| it.min)),
        DerivedColumn("max", "ticks", "the longest time", time(|it| it.max)),
    ]);
    table("summary", "a program of the ensemble", columns)
}

/// Shares of runs that are not complete, at each time at which one completed.
pub(super) fn survival(manifest: &Manifest, finished: &Records) -> Result<PythonTable, Failure> {
    let mut times = vec![TimeSample::default(); manifest.programs.len()];
    let read = finished.each(|done| {
        let time = completion_time(&done.record).into_iter();
        time.for_each(|it| times[done.program].push(it));
    });
    read.map_err(Failure::usage)?;
    let mut steps = Vec::new();
    for (program, times) in manifest.programs.iter().zip(&times) {
        let curve = KaplanMeier::of(&times.to_vec());
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
        "a time at which runs of a program completed",
        columns,
    )
    .map_err(Failure::usage)
}
