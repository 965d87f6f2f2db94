//! Data of the figures of a report, as comma-separated values.
use stochc_experiments::resampling::Ratio;
use stochc_experiments::statistics::{KaplanMeier, Observation, Test};
use stochc_experiments::sweep::Sweep;
use stochc_experiments::{PairwiseResult, PairwiseTest, Time, TimeUnit};
use stochc_files::csv::CsvTable;

use crate::analysis::critical_path::SegmentKind;
use crate::analysis::maps::{AGES, Maps, SliceMap};
use crate::analysis::reported_program::{FinishedRun, ReportedProgram};
use crate::analysis::waits::{ReportedCapture, phase_waits};

fn maybe(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

/// Returns a probability as text. Small ones have an exponent.
fn probability(p: f64) -> String {
    if 0.0 < p && p < 1e-4 {
        format!("{p:e}")
    } else {
        p.to_string()
    }
}

pub(super) type NamedFile = (String, String);

/// Name of the table of critical paths.
pub const CRITICAL_PATHS: &str = "critical-paths.csv";

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Table {
    Survival,
    Means,
    Waits,
    Origins,
    CriticalPaths,
    Sizes,
    Differences,
    Sweeps,
    Maps,
    Faces,
}

impl Table {
    /// Returns the name of the table's file.
    pub fn name(self) -> &'static str {
        match self {
            Table::Survival => "survival.csv",
            Table::Means => "means.csv",
            Table::Waits => "waits.csv",
            Table::Origins => "origins.csv",
            Table::CriticalPaths => CRITICAL_PATHS,
            Table::Sizes => "sizes.csv",
            Table::Differences => "differences.csv",
            Table::Sweeps => "sweeps.csv",
            Table::Maps => "maps.csv",
            Table::Faces => "faces.csv",
        }
    }
}

/// Returns the tables of a report. Tables without rows are left out.
pub(super) fn tables(
    subjects: &[ReportedProgram],
    differences: bool,
    sweeps: bool,
    maps: &[Option<Maps>],
) -> Vec<Table> {
    let captures = subjects.is_empty() || !subjects.iter().all(ReportedProgram::is_aggregate);
    let sizes = subjects.iter().any(ReportedProgram::is_aggregate);
    let maps = maps.iter().flatten().any(|maps| maps.runs > 0);
    let all = [
        (Table::Survival, true),
        (Table::Means, true),
        (Table::Waits, captures),
        (Table::Origins, captures),
        (Table::CriticalPaths, captures),
        (Table::Sizes, sizes),
        (Table::Differences, differences),
        (Table::Sweeps, sweeps),
        (Table::Maps, maps),
        (Table::Faces, maps),
    ];
    let present = all.into_iter().filter(|(_, present)| *present);
    present.map(|(table, _)| table).collect()
}

/// Returns all tables of a report except [`CRITICAL_PATHS`], in the order of [`tables`]. `last` is the
/// latest observed time, in the unit of the report.
pub(super) fn files(
    subjects: &[ReportedProgram],
    waits: &[Vec<ReportedCapture>],
    pairwise_tests: &[PairwiseTest],
    sweeps: &[Sweep],
    maps: &[Option<Maps>],
    clock: TimeUnit,
    last: f64,
) -> Vec<NamedFile> {
    let differ = !pairwise_tests.is_empty();
    let content = |table: Table| {
        Some(match table {
            Table::Survival => survival(subjects),
            Table::Means => means(subjects, clock, last),
            Table::Waits => captures(subjects, waits),
            Table::Origins => origins(subjects, waits),
            // Written run by run.
            Table::CriticalPaths => return None,
            Table::Sizes => sizes(subjects),
            Table::Differences => differences(subjects, pairwise_tests, clock),
            Table::Sweeps => swept(sweeps),
            Table::Maps => mapped(subjects, maps),
            Table::Faces => faces(subjects, maps),
        })
    };
    (tables(subjects, differ, !sweeps.is_empty(), maps).into_iter())
        .filter_map(|table| Some((table.name().to_owned(), content(table)?)))
        .collect()
}

/// Returns the growth of aggregates' largest groups as a table. For each size, the table has the
/// share of runs whose groups are all smaller, over time.
fn sizes(subjects: &[ReportedProgram]) -> String {
    let mut table = CsvTable::new([
        "program", "size", "ticks", "at_risk", "reached", "without", "low", "high",
    ]);
    for subject in subjects.iter().filter(|subject| subject.is_aggregate()) {
        for (number, phase) in subject.program.phases().iter().enumerate() {
            add_curve(
                &mut table,
                [&subject.label, &phase.name],
                &subject.size_times(number),
            );
        }
    }
    table.finish()
}

/// Adds a row for each step of the survival curve of `times`. Each row begins with the cells `of`:
/// program and phase.
fn add_curve(table: &mut CsvTable, of: [&str; 2], times: &[Observation]) {
    let Some(estimate) = KaplanMeier::new(times) else {
        return;
    };
    for point in estimate.curve() {
        let [program, phase] = of.map(str::to_owned);
        table.row([
            program,
            phase,
            point.time.to_string(),
            point.at_risk.to_string(),
            point.completed.to_string(),
            point.incomplete.to_string(),
            maybe(point.interval.map(|interval| interval.0)),
            maybe(point.interval.map(|interval| interval.1)),
        ]);
    }
}

fn survival(subjects: &[ReportedProgram]) -> String {
    let mut table = CsvTable::new([
        "program",
        "phase",
        "ticks",
        "at_risk",
        "completed",
        "incomplete",
        "low",
        "high",
    ]);
    for subject in subjects {
        add_curve(&mut table, [&subject.label, ""], &subject.times());
        for (i, phase) in subject.program.phases().iter().enumerate() {
            add_curve(
                &mut table,
                [&subject.label, &phase.name],
                &subject.phase_times(i),
            );
        }
    }
    table.finish()
}

/// Returns the table of mean times in ticks. `last` is the latest observed time, in the unit of the
/// report.
fn means(subjects: &[ReportedProgram], clock: TimeUnit, last: f64) -> String {
    let mut table = CsvTable::new([
        "program",
        "phase",
        "completed",
        "incomplete",
        "mean",
        "half_width",
        "horizon",
        "median",
        "sd",
        "min",
        "max",
    ]);
    let mut add = |program: &str, phase: &str, time: Option<Time>| {
        let Some(time) = time else { return };
        table.row([
            program.to_owned(),
            phase.to_owned(),
            time.completed.to_string(),
            time.incomplete.to_string(),
            time.mean.to_string(),
            maybe(time.half_width),
            maybe(time.horizon),
            maybe(time.median),
            maybe(time.sd),
            maybe(time.min),
            maybe(time.max),
        ]);
    };
    for subject in subjects {
        let last = last / clock.tick(subject.program);
        add(&subject.label, "", Time::beside(&subject.times(), last));
        for (i, phase) in subject.program.phases().iter().enumerate() {
            let time = Time::new(&subject.phase_times(i));
            add(&subject.label, &phase.name, time);
        }
    }
    table.finish()
}

fn captures(subjects: &[ReportedProgram], waits: &[Vec<ReportedCapture>]) -> String {
    let mut table = CsvTable::new([
        "program",
        "phase",
        "capture",
        "captured",
        "censored",
        "wait",
        "half_width",
        "p10",
        "p90",
        "entries",
        "docking",
        "share",
        "decided",
        "slower",
        "slower_docking",
        "run_to_watch",
    ]);
    for (subject, waits) in subjects.iter().zip(waits) {
        for wait in waits {
            let time = wait.time();
            table.row([
                subject.label.clone(),
                subject.program.phase(wait.phase).to_owned(),
                wait.text.clone(),
                time.map_or(0, |time| time.completed).to_string(),
                time.map_or(0, |time| time.incomplete).to_string(),
                maybe(time.map(|time| time.mean)),
                maybe(time.and_then(|time| time.half_width)),
                maybe(wait.spread().map(|spread| spread.0)),
                maybe(wait.spread().map(|spread| spread.1)),
                maybe(wait.entries()),
                maybe(wait.docking()),
                maybe(wait.share),
                wait.decided.to_string(),
                maybe(wait.slower),
                maybe(wait.slower_docking),
                wait.run_to_watch
                    .map_or(String::new(), |run| run.to_string()),
            ]);
        }
        for wait in phase_waits(subject) {
            let phase = subject.program.phase(wait.phase).to_owned();
            let unknown = || std::iter::repeat_n(String::new(), 8);
            let first = [subject.label.clone(), phase, "wait".to_owned()];
            let decided = [wait.share.to_string(), wait.decided.to_string()];
            let slower = [maybe(wait.slower), String::new(), String::new()];
            table.row(
                first
                    .into_iter()
                    .chain(unknown())
                    .chain(decided)
                    .chain(slower),
            );
        }
    }
    table.finish()
}

fn origins(subjects: &[ReportedProgram], waits: &[Vec<ReportedCapture>]) -> String {
    let mut table = CsvTable::new(["program", "phase", "capture", "origin", "role", "captured"]);
    for (subject, waits) in subjects.iter().zip(waits) {
        for wait in waits {
            let released = wait.released().iter();
            let released = released.map(|(role, n)| ("released", subject.program.role(*role), *n));
            let all = std::iter::once(("free", "", wait.free())).chain(released);
            for (origin, role, n) in all.filter(|(.., n)| *n > 0) {
                table.row([
                    subject.label.clone(),
                    subject.program.phase(wait.phase).to_owned(),
                    wait.text.clone(),
                    origin.to_owned(),
                    role.to_owned(),
                    n.to_string(),
                ]);
            }
        }
    }
    table.finish()
}

/// Returns the first line of [`CRITICAL_PATHS`].
pub(super) fn critical_paths_header() -> String {
    CsvTable::new(["program", "run", "phase", "event", "from", "to"]).finish()
}

/// Returns the rows of [`CRITICAL_PATHS`] for one run.
pub(super) fn critical_paths(subject: &ReportedProgram, run: &FinishedRun) -> String {
    let mut table = CsvTable::part();
    for segment in &run.critical_path {
        table.row([
            subject.label.clone(),
            run.record.run.to_string(),
            subject.program.phase(segment.phase).to_owned(),
            match segment.kind {
                SegmentKind::Notification => "notification".to_owned(),
                SegmentKind::Reports => "reports".to_owned(),
                SegmentKind::Wait => "wait".to_owned(),
                SegmentKind::Aborted => "aborted".to_owned(),
                SegmentKind::Event { event, .. } | SegmentKind::Pending { event } => {
                    subject.events.events[event].text(subject.program)
                }
            },
            segment.from.to_string(),
            segment.to.to_string(),
        ]);
    }
    table.finish()
}

fn differences(
    subjects: &[ReportedProgram],
    pairwise_tests: &[PairwiseTest],
    clock: TimeUnit,
) -> String {
    let mut table = CsvTable::new([
        "first",
        "second",
        "test",
        "unit",
        "difference",
        "half_width",
        "horizon",
        "p",
        "p_holm",
    ]);
    for contrast in pairwise_tests {
        let names = [contrast.first, contrast.second].map(|i| subjects[i].label.clone());
        let (test, figures) = match &contrast.verdict {
            PairwiseResult::Same | PairwiseResult::Equal => {
                ("same runs", [const { String::new() }; 5])
            }
            PairwiseResult::Repeated => ("repeated", [const { String::new() }; 5]),
            PairwiseResult::Unknown => ("none", [const { String::new() }; 5]),
            PairwiseResult::Known(found) => {
                let test = match found.test {
                    Test::Paired { .. } => "paired t",
                    Test::Welch { .. } => "Welch t",
                };
                let sizes = [found.difference, found.half_width];
                let [difference, half_width] = sizes.map(|size| size.to_string());
                let [p, p_holm] = [found.p, found.p_holm].map(probability);
                let horizon = found.horizon.map_or(String::new(), |it| it.to_string());
                (test, [difference, half_width, horizon, p, p_holm])
            }
        };
        let words = [test.to_owned(), clock.unit().to_owned()];
        table.row(names.into_iter().chain(words).chain(figures));
    }
    table.finish()
}

fn swept(sweeps: &[Sweep]) -> String {
    let mut table = CsvTable::new([
        "parameter",
        "value",
        "at",
        "program",
        "unit",
        "completed",
        "timed_out",
        "censored",
        "failed",
        "mean",
        "half_width",
        "median",
        "released",
        "time_per_capture",
    ]);
    for sweep in sweeps {
        for point in &sweep.points {
            let (Some(axis), Some(value)) = (sweep.axes.first(), point.values.first()) else {
                continue;
            };
            let further = sweep.axes.iter().zip(&point.values).skip(1);
            let further: Vec<String> = further.map(|(axis, value)| axis.at(*value)).collect();
            let time = point.time.as_ref();
            table.row([
                axis.name.clone(),
                value.si.to_string(),
                further.join("; "),
                point.name.clone(),
                sweep.unit.to_owned(),
                point.completed.to_string(),
                point.timed_out.to_string(),
                point.censored.to_string(),
                point.failed.to_string(),
                maybe(time.map(|time| time.mean)),
                maybe(time.and_then(|time| time.half_width)),
                maybe(time.and_then(|time| time.median)),
                maybe(point.released),
                maybe(point.time_per_capture),
            ]);
        }
    }
    table.finish()
}

/// Returns the cells of a ratio: its value and both ends of its interval.
fn ratio(ratio: &Ratio) -> [String; 3] {
    let interval = ratio.interval;
    [
        ratio.value.to_string(),
        maybe(interval.map(|interval| interval.0)),
        maybe(interval.map(|interval| interval.1)),
    ]
}

/// Returns the table of the values in all cells of all maps.
fn mapped(subjects: &[ReportedProgram], maps: &[Option<Maps>]) -> String {
    let mut table = CsvTable::new([
        "program", "map", "slice", "at", "east", "up", "value", "low", "high",
    ]);
    for (subject, maps) in subjects.iter().zip(maps) {
        let Some(maps) = maps else { continue };
        let mut add = |what: &str, map: &SliceMap| {
            for ((east, up), known) in &map.places {
                let place = [
                    subject.label.clone(),
                    what.to_owned(),
                    map.slice.name().to_owned(),
                    map.slice.at().to_string(),
                    east.to_string(),
                    up.to_string(),
                ];
                table.row(place.into_iter().chain(ratio(known)));
            }
        };
        for (age, slices) in AGES.iter().zip(&maps.before) {
            let what = format!("before {age}");
            slices.iter().for_each(|map| add(&what, map));
        }
        let free = maps.occupation.iter().flatten();
        free.for_each(|map| add("free", map));
        let entries = maps.entries.iter().flatten();
        entries.for_each(|map| add("entries", map));
    }
    table.finish()
}

/// Returns the table of the entries at every face that has waited.
fn faces(subjects: &[ReportedProgram], maps: &[Option<Maps>]) -> String {
    let mut table = CsvTable::new([
        "program", "capture", "x", "y", "z", "entries", "low", "high",
    ]);
    for (subject, maps) in subjects.iter().zip(maps) {
        for face in maps.iter().flat_map(|maps| &maps.faces) {
            let place = [
                subject.label.clone(),
                face.text.clone(),
                face.cell.x.to_string(),
                face.cell.y.to_string(),
                face.cell.z.to_string(),
            ];
            table.row(place.into_iter().chain(ratio(&face.rate)));
        }
    }
    table.finish()
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_small_probability_has_few_digits() {
        for (p, text) in [(1.0, "1"), (0.05, "0.05"), (2.5e-80, "2.5e-80"), (0.0, "0")] {
            assert_eq!(super::probability(p), text);
        }
    }
}
