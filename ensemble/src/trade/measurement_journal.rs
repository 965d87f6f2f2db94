//! What a measurement has found, run by run, in a file that outlives a kill.
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use stochc_files::checksum::{self, LineIntegrity};
use stochc_files::{File, budget};
use stochc_ir::sha256;
use stochc_runtime::Settings;

use super::plan::Job;
use super::sample::Measured;
use crate::JournalError;
use crate::folder::lock;
use crate::journal::{Journal, JournalHeader, read_lines};
use crate::{EnsembleProgram, FolderError, this_build};

/// Its name in the folder of a trade.
pub const MEASUREMENT_JOURNAL: &str = "trade.jsonl";

/// Runs that were measured before, and a file for those that are measured now.
#[derive(Debug)]
pub struct MeasurementJournal {
    known: BTreeMap<(String, usize, u64), Measured>,
    elapsed: Duration,
    journal: Journal,
    broken: Mutex<Option<JournalError>>,
    /// Unlocked by the system when it is closed, also by a kill.
    _lock: File,
}

/// A run of a program at a setting, with its own limit of ticks, and the time that the measurement had taken [s].
#[derive(Serialize, Deserialize)]
struct Entry {
    settings: Settings,
    program: usize,
    run: Measured,
    elapsed: f64,
}

impl MeasurementJournal {
    /// Opens the one of a folder, and makes it if it is not there; runs of other programs, another seed or another
    /// build are not believed.
    ///
    /// # Errors
    /// When it is of another measurement, another process writes it, or the file system refuses.
    pub fn open(
        folder: &Path,
        programs: &[EnsembleProgram],
        seed: u64,
    ) -> Result<MeasurementJournal, FolderError> {
        let lock = lock(folder)?;
        let path = folder.join(MEASUREMENT_JOURNAL);
        let most = programs
            .iter()
            .map(EnsembleProgram::captures)
            .max()
            .unwrap_or(0);
        let programs: Vec<_> = programs.iter().map(|it| (&it.name, it.hash())).collect();
        let header = JournalHeader::of(&sha256(&("trade", this_build(), seed, programs)));
        let (mut known, mut elapsed) = (BTreeMap::new(), Duration::ZERO);
        let (whole, _) = read_lines(&path, &header, budget::record(most), |line| {
            // A damaged line costs its run, which is measured again.
            if checksum::check(line.text) == LineIntegrity::Sound
                && let Ok(entry) = serde_json::from_slice::<Entry>(line.text)
            {
                let seconds = Duration::try_from_secs_f64(entry.elapsed);
                elapsed = elapsed.max(seconds.unwrap_or_default());
                known.insert(
                    key(&entry.settings, entry.program, entry.run.run),
                    entry.run,
                );
            }
        })?;
        Ok(MeasurementJournal {
            known,
            elapsed,
            journal: Journal::open(&path, &header, whole)?,
            broken: Mutex::new(None),
            _lock: lock,
        })
    }

    /// How long the measurement had taken before.
    pub(super) fn elapsed(&self) -> Duration {
        self.elapsed
    }

    /// A run that was measured before.
    pub(super) fn recall(&self, job: &Job, settings: &Settings) -> Option<Measured> {
        let key = key(settings, job.program, job.run);
        self.known.get(&key).copied()
    }

    /// Keeps a run; whether that went well.
    pub(super) fn keep(
        &self,
        job: &Job,
        settings: &Settings,
        run: Measured,
        elapsed: Duration,
    ) -> bool {
        let entry = Entry {
            settings: settings.clone(),
            program: job.program,
            run,
            elapsed: elapsed.as_secs_f64(),
        };
        let kept = self.journal.append(&entry);
        let is_kept = kept.is_ok();
        if let Err(error) = kept {
            let mut broken = self.broken.lock().expect("nobody panics while it is held");
            broken.get_or_insert(error);
        }
        is_kept
    }

    /// Waits until all would survive a loss of power.
    ///
    /// # Errors
    /// The first that the disk had.
    pub fn close(self) -> Result<(), JournalError> {
        let broken = self
            .broken
            .into_inner()
            .expect("nobody panics while it is held");
        let closed = self.journal.close();
        broken.map_or(closed, Err)
    }
}

fn key(settings: &Settings, program: usize, run: u64) -> (String, usize, u64) {
    let settings = serde_json::to_string(settings).expect("settings are plain data");
    (settings, program, run)
}
