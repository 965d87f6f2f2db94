//! Samples of runs: one line of a CSV file per run.
use std::fmt;

use stochc_ir::record::{Outcome, RunRecord};

use super::cases::Cell;

pub const HEADER: &str =
    "case,model,substeps,iterations,run,completed,ticks,first_wait,last_wait,entries,docking";

/// Sample of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    pub case: String,
    pub model: String,
    pub substeps: u32,
    pub iterations: u32,
    pub run: u64,
    /// Whether the run completed, without censoring or failure.
    pub completed: bool,
    /// Ticks until the last capture.
    pub ticks: f64,
    /// Waiting time of the first capture, at a face of the plate \[ticks\].
    pub first_wait: f64,
    /// Waiting time of the last capture, at the top of the tower \[ticks\].
    pub last_wait: f64,
    /// Mean number of entries into the reach of a face per capture.
    pub entries: f64,
    /// Mean number of ticks from the last entry to the capture.
    pub docking: f64,
}

impl Sample {
    pub fn new(cell: &Cell, iterations: u32, record: &RunRecord) -> Sample {
        let waits = record
            .bonds
            .iter()
            .map(|b| (b.docked - b.magnetized) as f64);
        let count = record.bonds.len() as f64;
        let sum = |of: &dyn Fn(usize) -> f64| (0..record.bonds.len()).map(of).sum::<f64>();
        Sample {
            case: cell.case.name.to_owned(),
            model: cell.model.name().to_owned(),
            substeps: cell.substeps,
            iterations,
            run: record.run,
            completed: record.outcome == Outcome::Completed,
            ticks: record.ticks as f64,
            first_wait: waits.clone().next().unwrap_or(f64::NAN),
            last_wait: waits.clone().next_back().unwrap_or(f64::NAN),
            entries: sum(&|i| f64::from(record.bonds[i].entries)) / count,
            docking: sum(&|i| record.bonds[i].docking as f64) / count,
        }
    }

    fn parse(line: &str) -> Option<Sample> {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |i: usize| fields.get(i)?.parse::<f64>().ok();
        Some(Sample {
            case: (*fields.first()?).to_owned(),
            model: (*fields.get(1)?).to_owned(),
            substeps: number(2)? as u32,
            iterations: number(3)? as u32,
            run: number(4)? as u64,
            completed: fields.get(5)?.parse().ok()?,
            ticks: number(6)?,
            first_wait: number(7)?,
            last_wait: number(8)?,
            entries: number(9)?,
            docking: number(10)?,
        })
    }
}

impl fmt::Display for Sample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{},{},{},{},{},{},{},{},{},{:.3},{:.3}",
            self.case,
            self.model,
            self.substeps,
            self.iterations,
            self.run,
            self.completed,
            self.ticks,
            self.first_wait,
            self.last_wait,
            self.entries,
            self.docking
        )
    }
}

/// Returns the samples of a file. Skips lines that are not samples.
pub fn read(text: &str) -> Vec<Sample> {
    text.lines().filter_map(Sample::parse).collect()
}
