//! What a measurement has found, run by run, in a file that outlives a kill.
use std::collections::BTreeMap;
use std::io::{self, BufRead as _, BufReader};
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use stochc_files as files;
use stochc_files::budget;
use stochc_files::checksum::{self, LineIntegrity};
use stochc_files::disk::FileLock;
use stochc_ir::sha256;
use stochc_runtime::Settings;

use super::plan::Job;
use super::sample::Measured;
use crate::JournalError;
use crate::folder::lock;
use crate::journal::{Journal, JournalHeader, JournalLine, MOST_HEADER, first_line, read_lines};
use crate::{EnsembleProgram, FolderError, this_build};

/// Its name in the folder of a trade.
pub const MEASUREMENT_JOURNAL: &str = "trade.jsonl";

/// Runs that were measured before, and a file for those that are measured now.
#[derive(Debug)]
pub struct MeasurementJournal {
    /// Of a run that was made several times the one that went on for longest.
    known: BTreeMap<(String, usize, u64), Measured>,
    elapsed: Duration,
    journal: Journal,
    broken: Mutex<Option<JournalError>>,
    /// Unlocked by the system when it is closed, also by a kill.
    _lock: FileLock,
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
        let mut note = |line: JournalLine| {
            // A damaged line costs its run, which is measured again.
            if checksum::check(line.text) == LineIntegrity::Sound
                && let Ok(entry) = serde_json::from_slice::<Entry>(line.text)
            {
                let seconds = Duration::try_from_secs_f64(entry.elapsed);
                elapsed = elapsed.max(seconds.unwrap_or_default());
                let key = key(&entry.settings, entry.program, entry.run.run);
                let longest = known.entry(key).or_insert(entry.run);
                if entry.run.ticks > longest.ticks {
                    *longest = entry.run;
                }
            }
        };
        // Whoever it was of has measured nothing.
        let whole = match has_entries(folder).map_err(JournalError::Io)? {
            true => match read_lines(&path, &header, budget::record(most), &mut note)? {
                // There is no first line, nor the beginning of one.
                0 => return Err(JournalError::Foreign.into()),
                whole => whole,
            },
            false => 0,
        };
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

    /// A run that was measured before, as the limit of ticks of these settings leaves it; `None` as well if a smaller
    /// limit has stopped it.
    pub(super) fn recall(&self, job: &Job, settings: &Settings) -> Option<Measured> {
        let limit = settings.max_ticks.unwrap_or(u64::MAX);
        let known = self.known.get(&key(settings, job.program, job.run))?;
        known.tells(limit).then(|| known.within(limit))
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

/// Whether the journal of a folder, if there is one, has anything in it that was measured, or is none of ours.
///
/// # Errors
/// Those of the file system.
pub fn has_entries(folder: &Path) -> io::Result<bool> {
    let mut file = match files::open(&folder.join(MEASUREMENT_JOURNAL)) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
        Err(error) => return Err(error),
    };
    let first = first_line(&mut file)?;
    // Ours, whole or cut off; what somebody else has written may be anything.
    let is_ours = match first.strip_suffix(b"\n") {
        Some(first) => serde_json::from_slice::<JournalHeader>(first).is_ok(),
        None => {
            let begins = b"{\"ensemble\":";
            let length = first.len().min(begins.len());
            (first.len() as u64) < MOST_HEADER && first[..length] == begins[..length]
        }
    };
    Ok(!is_ours || !file.fill_buf()?.is_empty())
}

/// What a run depends on but the limit of ticks, which only says how far it is seen.
fn key(settings: &Settings, program: usize, run: u64) -> (String, usize, u64) {
    let unlimited = Settings {
        max_ticks: None,
        ..settings.clone()
    };
    let settings = serde_json::to_string(&unlimited).expect("settings are plain data");
    (settings, program, run)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trade::candidates::base;
    use crate::trade::sample::{End, measured};

    /// The limit of a trade depends on its first runs, which may be others when it goes on with more.
    #[test]
    fn a_run_is_recalled_under_another_limit() {
        let folder = tempfile::tempdir().unwrap();
        let within = |limit| Settings {
            max_ticks: Some(limit),
            ..base()
        };
        let job = |run| Job {
            candidate: 0,
            program: 0,
            run,
            max_ticks: 0,
        };
        let open = || MeasurementJournal::open(folder.path(), &[], 1).unwrap();
        let keep = |limit, runs: &[Measured]| {
            let journal = open();
            for run in runs {
                assert!(journal.keep(&job(run.run), &within(limit), *run, Duration::ZERO));
            }
            journal.close().unwrap();
        };
        keep(
            500,
            &[
                measured(0, End::Completed, 300),
                measured(1, End::Censored, 500),
            ],
        );
        let journal = open();
        let recalled = |run, limit| {
            let found = journal.recall(&job(run), &within(limit))?;
            Some((found.end, found.ticks))
        };
        for limit in [300, 500, 900] {
            assert_eq!(recalled(0, limit), Some((End::Completed, 300)), "{limit}");
        }
        assert_eq!(recalled(0, 200), Some((End::Censored, 200)));
        assert_eq!(recalled(1, 400), Some((End::Censored, 400)));
        assert_eq!(recalled(1, 500), Some((End::Censored, 500)));
        assert_eq!(recalled(1, 501), None, "who knows");
        assert_eq!(recalled(2, 500), None);
        drop(journal);
        // What has gone on for longer stays.
        keep(900, &[measured(1, End::Completed, 800)]);
        keep(400, &[measured(1, End::Censored, 400)]);
        let found = open().recall(&job(1), &within(900)).unwrap();
        assert_eq!((found.end, found.ticks), (End::Completed, 800));
    }
}
