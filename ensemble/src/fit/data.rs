//! Measured times, from a table of comma-separated values.
use std::collections::{BTreeMap, HashSet};
use stochc_files::csv::original;

use crate::statistics::Summary;

/// A number of a table, at most: of larger ones squares, and their sums, are not known to their digits.
const MOST: f64 = 1e15;

/// What is known of a program's time to completion.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Observed {
    /// The program's name.
    pub program: String,
    /// How many runs were measured, 2 at least.
    pub n: usize,
    /// Their mean, in the unit of the table.
    pub mean: f64,
    /// Their standard deviation, in the same unit.
    pub sd: f64,
}

/// What times are measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Ticks of the program's scene.
    Ticks,
    /// Seconds.
    Seconds,
}

/// Why a table is not read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum DataError {
    /// It has other columns.
    #[error(
        "its columns are {0}; give `program,ticks` or `program,seconds` with a row for each run, or \
         `program,n,mean_ticks,sd_ticks` (or `_seconds`) with a row for each program"
    )]
    Columns(String),
    /// A row that is not understood.
    #[error("line {line}: {reason}")]
    Row {
        /// Of the file, from 1.
        line: u64,
        /// What is wrong with it.
        reason: String,
    },
    /// Too few runs of a program.
    #[error("`{0}` has fewer than two runs, or all took the same time: its spread is not known")]
    TooFew(String),
    /// No row at all.
    #[error("it holds no times")]
    Empty,
}

impl Observed {
    /// Reads a table: a row for each run (`program,ticks`), or one for each program (`program,n,mean_ticks,sd_ticks`); the same
    /// with `seconds`. The programs come in the order of the table.
    ///
    /// # Errors
    /// See [`DataError`].
    pub fn read(bytes: &[u8]) -> Result<(Unit, Vec<Observed>), DataError> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(bytes);
        let header = reader.headers().map_err(|error| row(&error))?.clone();
        let columns: Vec<&str> = header.iter().collect();
        let (unit, is_summed_up) = match columns[..] {
            ["program", "ticks"] => (Unit::Ticks, false),
            ["program", "seconds"] => (Unit::Seconds, false),
            ["program", "n", "mean_ticks", "sd_ticks"] => (Unit::Ticks, true),
            ["program", "n", "mean_seconds", "sd_seconds"] => (Unit::Seconds, true),
            _ => return Err(DataError::Columns(format!("`{}`", columns.join(",")))),
        };
        let mut order: Vec<String> = Vec::new();
        let mut known: HashSet<String> = HashSet::new();
        let mut times: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        let mut observed = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| row(&error))?;
            let line = record.position().map_or(0, csv::Position::line);
            let wrong = |reason: String| DataError::Row { line, reason };
            let number = |i: usize| {
                let text = record.get(i).unwrap_or_default();
                let value: Option<f64> = text.parse().ok();
                value
                    .filter(|value| *value > 0.0 && *value <= MOST)
                    .ok_or_else(|| wrong(format!("`{text}` is no number above 0, and up to 1e15")))
            };
            let program = original(record.get(0).unwrap_or_default()).to_owned();
            let is_new = known.insert(program.clone());
            if is_summed_up {
                if !is_new {
                    return Err(wrong(format!("`{program}` has a row already")));
                }
                let n = number(1)?;
                if n.fract() != 0.0 || n < 2.0 {
                    return Err(wrong(format!("`{n}` is no number of runs from 2")));
                }
                observed.push(Observed {
                    program: program.clone(),
                    n: n as usize,
                    mean: number(2)?,
                    sd: number(3)?,
                });
            } else {
                times.entry(program.clone()).or_default().push(number(1)?);
            }
            if is_new {
                order.push(program);
            }
        }
        if order.is_empty() {
            return Err(DataError::Empty);
        }
        if is_summed_up {
            return Ok((unit, observed));
        }
        let sum_up = |program: String| {
            let summary = Summary::of(&times[&program]);
            match summary.and_then(|it| Some((it.n, it.mean, it.sd.filter(|sd| *sd > 0.0)?))) {
                Some((n, mean, sd)) => Ok(Observed {
                    program,
                    n,
                    mean,
                    sd,
                }),
                None => Err(DataError::TooFew(program)),
            }
        };
        let observed: Result<Vec<Observed>, DataError> = order.into_iter().map(sum_up).collect();
        Ok((unit, observed?))
    }
}

fn row(error: &csv::Error) -> DataError {
    DataError::Row {
        line: error.position().map_or(1, csv::Position::line),
        reason: match error.kind() {
            csv::ErrorKind::UnequalLengths { .. } => "it has not a cell for each column".to_owned(),
            _ => "it is no text".to_owned(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_summed_up_and_sums_are_taken() {
        let (unit, found) = Observed::read(b"program,ticks\na,10\nb,5\na,14\nb,7\n").unwrap();
        assert_eq!(unit, Unit::Ticks);
        assert_eq!(
            (found[0].program.as_str(), found[0].n, found[0].mean),
            ("a", 2, 12.0)
        );
        assert!((found[0].sd - 8f64.sqrt()).abs() < 1e-12);
        let text = b"# the paper\nprogram, n, mean_seconds, sd_seconds\nline, 50, 158, 21\n";
        let (unit, found) = Observed::read(text).unwrap();
        assert_eq!((unit, found[0].n, found[0].sd), (Unit::Seconds, 50, 21.0));
    }

    #[test]
    fn what_is_not_understood_is_told_with_its_line() {
        let told = |text: &str| Observed::read(text.as_bytes()).unwrap_err().to_string();
        assert!(told("a,b\n1,2\n").contains("`a,b`"));
        assert_eq!(
            told("program,ticks\na,x\n"),
            "line 2: `x` is no number above 0, and up to 1e15"
        );
        assert_eq!(
            told("program,ticks\na,1\na\n"),
            "line 3: it has not a cell for each column"
        );
        assert_eq!(told("program,ticks\n"), "it holds no times");
        assert!(told("program,ticks\na,1\n").contains("fewer than two runs"));
        assert!(told("program,n,mean_ticks,sd_ticks\na,1,2,3\n").contains("number of runs"));
        assert!(told("program,ticks\na,1e155\na,2\n").starts_with("line 2: `1e155` is no number"));
        assert!(told("program,n,mean_ticks,sd_ticks\na,9,2,3\na,9,2,3\n").contains("already"));
    }
}
