//! Logs of real experiments: reads them as run records.
//!
//! `docs/guides/bench.md` describes the format.
mod error;
mod logged_program;
mod rows;
mod run_builder;

pub use error::{LogError, RowError};

use stochc_files::checksum::crc32;
use stochc_ir::record::RunRecord;
use stochc_runtime::{Model, Settings};

use crate::records::RecordValidator;
use crate::{EnsembleProgram, Manifest};
use logged_program::LoggedProgram;
use rows::rows;
use run_builder::RunBuilder;

/// Runs of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredRuns {
    /// Manifest of the runs. Its seed is a checksum of the log, so that the runs of two logs are
    /// never paired.
    pub manifest: Manifest,
    /// Records of the runs, by their number.
    pub records: Vec<RunRecord>,
}

/// Reads the log of an experiment with a program.
///
/// # Errors
///
/// If a row is invalid, or the program cannot have its event at that time.
pub fn read_log(bytes: &[u8], program: EnsembleProgram) -> Result<MeasuredRuns, LogError> {
    let logged = LoggedProgram::new(&program)?;
    let mut records = Vec::new();
    // Line of the last row of each run.
    let mut ends = Vec::new();
    let mut current: Option<RunBuilder<'_>> = None;
    for row in rows(bytes, program.scene.tick)? {
        let row = row?;
        let mut builder = match current.take() {
            Some(builder) if builder.run() == row.run => builder,
            before => {
                let expected = before.as_ref().map_or(0, |it| it.run() + 1);
                if row.run != expected {
                    let reason = RowError::RunOrder {
                        run: row.run,
                        expected,
                    };
                    return Err(reason.at(row.line));
                }
                if let Some(before) = before {
                    records.push(before.finish());
                }
                ends.push(row.line);
                RunBuilder::new(&logged, row.run)
            }
        };
        builder.add(&row).map_err(|reason| reason.at(row.line))?;
        ends.pop();
        ends.push(row.line);
        current = Some(builder);
    }
    records.extend(current.map(RunBuilder::finish));
    if records.is_empty() {
        return Err(LogError::Empty);
    }
    let settings = Settings::new(Model::Measured, 1);
    // Seeds on the command line are usually small.
    let seed = 1 << 32 | u64::from(crc32(bytes));
    let manifest = Manifest::new(settings, seed, records.len() as u64, vec![program]);
    manifest.within_limits()?;
    let validator = RecordValidator::new(&manifest);
    for (record, line) in records.iter().zip(ends) {
        if let Some(reason) = validator.inconsistency(0, record) {
            return Err(RowError::Impossible(reason).at(line));
        }
    }
    Ok(MeasuredRuns { manifest, records })
}
