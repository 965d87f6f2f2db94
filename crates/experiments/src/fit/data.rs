//! Measured times of programs, read from a table of comma-separated values.
use std::collections::{BTreeMap, HashSet};
use std::fmt;

use csv::StringRecord;
use stochc_files::csv::original;

use super::observed::Observed;
use crate::statistics::Observation;
use stochc_text::number;

/// Largest number that a table may contain. Sums of squares stay accurate below it.
const MAX: f64 = 1e15;

/// Unit of measured times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Ticks of the scene of each program.
    Ticks,
    /// Seconds.
    Seconds,
}

/// Error of reading a table.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum DataError {
    /// The names or the number of the columns are wrong.
    #[error(
        "its columns are {0}; give `program,ticks` or `program,seconds`, and `stopped` if runs were stopped, with a row for \
         each run, or `program,n,mean_ticks,sd_ticks` (or `_seconds`) with a row for each program"
    )]
    Columns(String),
    /// A row is invalid.
    #[error("line {line}: {reason}")]
    Row {
        /// Line in the file, from 1.
        line: u64,
        /// Reason why the line is invalid.
        reason: RowError,
    },
    /// This program has too few runs.
    #[error("`{0}` has fewer than two runs, or all took the same time; its spread is unknown")]
    TooFew(String),
    /// There are no rows.
    #[error("it contains no times")]
    Empty,
}

/// Reason why a row is invalid.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum RowError {
    /// The table contains mean values, but two rows for this program.
    #[error("`{0}` has a row already")]
    Repeated(String),
    /// The cell is not a positive number up to the limit.
    #[error("`{0}` is not a number above 0 and up to 1e15")]
    Number(String),
    /// The cell is not a valid number of runs.
    #[error("`{0}` is not a number of runs from 2")]
    Runs(String),
    /// The cell of the column `stopped` has an invalid value.
    #[error("`{0}` in `stopped` is neither `true` nor `false`")]
    Stopped(String),
    /// The row has too many or too few cells.
    #[error("the number of cells differs from the number of columns")]
    Cells,
    /// The row is not valid text.
    #[error("it is not valid text")]
    Text,
}

/// Measured times of programs, from a table.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredTimes {
    /// Unit of all times.
    pub unit: Unit,
    /// Programs with their measured times, in the order of the table.
    pub programs: Vec<(String, Observed)>,
    /// Times that too many runs share, which suggests right-censored runs.
    pub pile_ups: Vec<PileUp>,
}

/// Time that many completed runs of a program share exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct PileUp {
    /// Name of the program.
    pub program: String,
    /// The shared time, in the unit of the table.
    pub time: f64,
    /// Number of runs with this time.
    pub count: usize,
    /// Number of runs of the program.
    pub n: usize,
}

impl fmt::Display for PileUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of {} times of `{}` are {}; if these runs were stopped, add a column `stopped` with `true` for them",
            self.count,
            self.n,
            self.program,
            number(self.time)
        )
    }
}

/// Subject of each row of a table: one run or one program.
#[derive(Clone, Copy, PartialEq)]
enum Rows {
    Runs { with_stopped: bool },
    Programs,
}

impl MeasuredTimes {
    /// Reads a table with one row for each run, or one row for each program. `docs/guides/fit.md`
    /// lists the columns.
    ///
    /// # Errors
    ///
    /// See [`DataError`].
    pub fn read(bytes: &[u8]) -> Result<MeasuredTimes, DataError> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(bytes);
        let header = reader.headers().map_err(|error| row(&error))?.clone();
        let (unit, rows) = columns(&header)?;
        let mut order: Vec<String> = Vec::new();
        let mut known: HashSet<String> = HashSet::new();
        let mut runs: BTreeMap<String, Vec<Observation>> = BTreeMap::new();
        let mut programs = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| row(&error))?;
            let line = record.position().map_or(0, csv::Position::line);
            let wrong = |reason: RowError| DataError::Row { line, reason };
            let program = original(record.get(0).unwrap_or_default()).to_owned();
            let is_new = known.insert(program.clone());
            match rows {
                Rows::Programs if !is_new => {
                    return Err(wrong(RowError::Repeated(program)));
                }
                Rows::Programs => programs.push((program, summary(&record).map_err(wrong)?)),
                Rows::Runs { with_stopped } => {
                    if is_new {
                        order.push(program.clone());
                    }
                    let run = run(&record, with_stopped).map_err(wrong)?;
                    runs.entry(program).or_default().push(run);
                }
            }
        }
        if known.is_empty() {
            return Err(DataError::Empty);
        }
        let mut pile_ups = Vec::new();
        for program in order {
            let runs = &runs[&program];
            pile_ups.extend(pile_up(&program, runs));
            match Observed::from_runs(runs) {
                Some(observed) => programs.push((program, observed)),
                None => return Err(DataError::TooFew(program)),
            }
        }
        Ok(MeasuredTimes {
            unit,
            programs,
            pile_ups,
        })
    }
}

fn columns(header: &StringRecord) -> Result<(Unit, Rows), DataError> {
    let columns: Vec<&str> = header.iter().collect();
    let runs = |with_stopped| Rows::Runs { with_stopped };
    Ok(match columns[..] {
        ["program", "ticks"] => (Unit::Ticks, runs(false)),
        ["program", "seconds"] => (Unit::Seconds, runs(false)),
        ["program", "ticks", "stopped"] => (Unit::Ticks, runs(true)),
        ["program", "seconds", "stopped"] => (Unit::Seconds, runs(true)),
        ["program", "n", "mean_ticks", "sd_ticks"] => (Unit::Ticks, Rows::Programs),
        ["program", "n", "mean_seconds", "sd_seconds"] => (Unit::Seconds, Rows::Programs),
        _ => return Err(DataError::Columns(format!("`{}`", columns.join(",")))),
    })
}

fn positive(record: &StringRecord, column: usize) -> Result<f64, RowError> {
    let text = record.get(column).unwrap_or_default();
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|value| *value > 0.0 && *value <= MAX)
        .ok_or_else(|| RowError::Number(text.to_owned()))
}

fn summary(record: &StringRecord) -> Result<Observed, RowError> {
    let n = positive(record, 1)?;
    if n.fract() != 0.0 || n < 2.0 {
        return Err(RowError::Runs(n.to_string()));
    }
    let (mean, sd) = (positive(record, 2)?, positive(record, 3)?);
    Ok(Observed::from_summary(n as usize, mean, sd))
}

fn run(record: &StringRecord, with_stopped: bool) -> Result<Observation, RowError> {
    let time = positive(record, 1)?;
    let word = if with_stopped {
        record.get(2).unwrap_or_default()
    } else {
        "false"
    };
    match word.to_ascii_lowercase().as_str() {
        "true" | "yes" | "1" => Ok(Observation::censored(time)),
        "false" | "no" | "0" => Ok(Observation::completed(time)),
        _ => Err(RowError::Stopped(word.to_owned())),
    }
}

/// Returns a time that is much more frequent than the other times. It must occur in at least five
/// runs and in 5 % of all runs. It must be four times as frequent as each other time.
fn pile_up(program: &str, runs: &[Observation]) -> Option<PileUp> {
    let completed = runs.iter().filter_map(|run| run.completed_time());
    let mut times: Vec<f64> = completed.collect();
    times.sort_by(f64::total_cmp);
    let mut counts: Vec<(usize, f64)> = (times.chunk_by(|a, b| a == b))
        .map(|same| (same.len(), same[0]))
        .collect();
    counts.sort_by_key(|count| count.0);
    let usual = counts.get(counts.len() / 2)?.0;
    let (count, time) = *counts.last()?;
    let is_pile_up = count >= 5 && 20 * count >= runs.len() && count >= 4 * usual;
    is_pile_up.then(|| PileUp {
        program: program.to_owned(),
        time,
        count,
        n: runs.len(),
    })
}

fn row(error: &csv::Error) -> DataError {
    DataError::Row {
        line: error.position().map_or(1, csv::Position::line),
        reason: match error.kind() {
            csv::ErrorKind::UnequalLengths { .. } => RowError::Cells,
            _ => RowError::Text,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_times_of_runs_and_summaries() {
        let found = MeasuredTimes::read(b"program,ticks\nb,10\na,5\nb,14\na,7\n").unwrap();
        assert_eq!(found.unit, Unit::Ticks);
        let (program, first) = &found.programs[0];
        assert_eq!((program.as_str(), first.n, first.mean), ("b", 2, 12.0));
        assert!((first.sd - 8f64.sqrt()).abs() < 1e-12);
        let text = b"# the paper\nprogram, n, mean_seconds, sd_seconds\nline, 50, 158, 21\n";
        let found = MeasuredTimes::read(text).unwrap();
        let (_, first) = &found.programs[0];
        assert_eq!((found.unit, first.n, first.sd), (Unit::Seconds, 50, 21.0));
    }

    #[test]
    fn reads_the_column_of_stopped_runs() {
        let text = b"program,seconds,stopped\na,10,false\na,14,no\na,20,TRUE\na,20,1\n";
        let found = MeasuredTimes::read(text).unwrap();
        assert_eq!(found.unit, Unit::Seconds);
        let (_, first) = &found.programs[0];
        assert_eq!((first.n, first.stopped, first.mean), (4, 2, 16.0));
        let error = MeasuredTimes::read(b"program,ticks,stopped\na,10,maybe\n").unwrap_err();
        let expected = "line 2: `maybe` in `stopped` is neither `true` nor `false`";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn finds_repeated_times_of_runs_that_were_not_stopped() {
        let table = |last: &str| {
            let rows = (0..40).map(|i| format!("a,{},false\n", 100 + 3 * i));
            let table = "program,ticks,stopped\n".to_owned() + &rows.collect::<String>();
            MeasuredTimes::read((table + &last.repeat(20)).as_bytes()).unwrap()
        };
        let found = table("a,350,false\n");
        let [found] = &found.pile_ups[..] else {
            panic!("{found:?}");
        };
        assert_eq!((found.time, found.count, found.n), (350.0, 20, 60));
        assert_eq!(table("a,350,true\n").pile_ups, []);
        // Rounded times also repeat, but equally often.
        let rows = (0..60).map(|i| format!("a,{}\n", 10 * (1 + i % 6)));
        let rounded = "program,ticks\n".to_owned() + &rows.collect::<String>();
        let found = MeasuredTimes::read(rounded.as_bytes()).unwrap();
        assert_eq!(found.pile_ups, []);
    }

    #[test]
    fn errors_name_their_line() {
        let error = |text: &str| {
            MeasuredTimes::read(text.as_bytes())
                .unwrap_err()
                .to_string()
        };
        assert!(error("a,b\n1,2\n").contains("`a,b`"));
        assert_eq!(
            error("program,ticks\na,x\n"),
            "line 2: `x` is not a number above 0 and up to 1e15"
        );
        assert_eq!(
            error("program,ticks\na,1\na\n"),
            "line 3: the number of cells differs from the number of columns"
        );
        assert_eq!(error("program,ticks\n"), "it contains no times");
        assert!(error("program,ticks\na,1\n").contains("fewer than two runs"));
        assert!(error("program,n,mean_ticks,sd_ticks\na,1,2,3\n").contains("number of runs"));
        assert!(
            error("program,ticks\na,1e155\na,2\n").starts_with("line 2: `1e155` is not a number")
        );
        assert!(error("program,n,mean_ticks,sd_ticks\na,9,2,3\na,9,2,3\n").contains("already"));
    }
}
