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
use crate::{EnsembleProgram, MAX_RUNS, Manifest};
use logged_program::LoggedProgram;
use rows::{Rows, rows};
use run_builder::RunBuilder;

/// Log of an experiment with one program. Only one run at a time is in memory.
pub struct ExperimentLog<'a> {
    bytes: &'a [u8],
    entry: &'a EnsembleProgram,
    program: LoggedProgram<'a>,
}

impl<'a> ExperimentLog<'a> {
    /// Returns a log. Its rows are not yet checked.
    ///
    /// # Errors
    ///
    /// If experiments with the program have no log.
    pub fn new(bytes: &'a [u8], entry: &'a EnsembleProgram) -> Result<Self, LogError> {
        let program = LoggedProgram::new(entry)?;
        Ok(ExperimentLog {
            bytes,
            entry,
            program,
        })
    }

    /// Checks all rows, and returns the manifest of the runs. Its seed is a checksum of the log, so
    /// that the runs of two logs are never paired.
    ///
    /// # Errors
    ///
    /// If a row is invalid, or the program cannot have its event at that time.
    pub fn manifest(&self) -> Result<Manifest, LogError> {
        // Seeds on the command line are usually small.
        let seed = 1 << 32 | u64::from(crc32(self.bytes));
        let settings = Settings::new(Model::Measured, 1);
        let mut manifest = Manifest::new(settings, seed, MAX_RUNS, vec![self.entry.clone()]);
        let validator = RecordValidator::new(&manifest);
        let mut count = 0;
        for run in self.runs()? {
            let LoggedRun { record, line } = run?;
            if let Some(reason) = validator.inconsistency(0, &record) {
                return Err(RowError::Impossible(reason).at(line));
            }
            count += 1;
        }
        if count == 0 {
            return Err(LogError::Empty);
        }
        manifest.runs = count;
        Ok(manifest)
    }

    /// Returns the records of the runs, by their number.
    ///
    /// # Errors
    ///
    /// The errors of [`ExperimentLog::manifest`].
    pub fn records(
        &self,
    ) -> Result<impl Iterator<Item = Result<RunRecord, LogError>> + Send, LogError> {
        Ok(self.runs()?.map(|run| run.map(|run| run.record)))
    }

    fn runs(&self) -> Result<LoggedRuns<'_>, LogError> {
        Ok(LoggedRuns {
            program: &self.program,
            rows: rows(self.bytes, self.entry.scene.tick)?,
            current: None,
            line: 0,
        })
    }
}

/// Run of a log.
struct LoggedRun {
    record: RunRecord,
    /// Line of the last row.
    line: u64,
}

/// Iterator over the runs of a log. It must not be used after an error.
struct LoggedRuns<'l> {
    program: &'l LoggedProgram<'l>,
    rows: Rows<'l>,
    current: Option<RunBuilder<'l>>,
    /// Line of the last row.
    line: u64,
}

impl Iterator for LoggedRuns<'_> {
    type Item = Result<LoggedRun, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_run().transpose()
    }
}

impl LoggedRuns<'_> {
    fn next_run(&mut self) -> Result<Option<LoggedRun>, LogError> {
        for row in self.rows.by_ref() {
            let row = row?;
            let (mut builder, ended) = match self.current.take() {
                Some(builder) if builder.run() == row.run => (builder, None),
                ended => {
                    let expected = ended.as_ref().map_or(0, |it| it.run() + 1);
                    let run = row.run;
                    if run != expected {
                        return Err(RowError::RunOrder { run, expected }.at(row.line));
                    }
                    (RunBuilder::new(self.program, run), ended)
                }
            };
            builder.add(&row).map_err(|reason| reason.at(row.line))?;
            self.current = Some(builder);
            let line = std::mem::replace(&mut self.line, row.line);
            if let Some(ended) = ended {
                let record = ended.finish();
                return Ok(Some(LoggedRun { record, line }));
            }
        }
        let line = self.line;
        let last = self.current.take();
        Ok(last.map(|last| LoggedRun {
            record: last.finish(),
            line,
        }))
    }
}
