//! Write-ahead log: one line of JSON per finished run, with a checksum, written at once.
//!
//! `journal.jsonl` begins with a line that identifies the ensemble, so that runs of other programs
//! cannot be mixed in. A kill or a power failure may leave a partial last line. It is removed at
//! the next opening. A corrupted line is skipped and its run repeated. A run is a pure function of
//! its number, so only time is lost.
use std::fs::OpenOptions;
use std::io::{self, BufRead, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use stochc_files as files;
use stochc_files::File;
use stochc_files::budget::{self, JOURNAL as JOURNAL_BUDGET};
use stochc_files::checksum::{self, LineIntegrity};
use stochc_ir::record::Outcome;

use crate::journal::JournalError;
use crate::journal::{line, read_line};
use crate::records::Finished;
use crate::records::RecordValidator;
use crate::records::Records;
use crate::{EnsembleProgram, Manifest};

/// Time between two writes to the disk. A power failure loses at most the runs that finished during
/// this time. A kill loses none.
const SYNC_EVERY: Duration = Duration::from_millis(500);

/// Version of the journal format.
const JOURNAL: u32 = 1;

/// First line of a journal. It identifies the ensemble.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JournalHeader {
    pub ensemble: String,
    journal: u32,
    /// Shard of the journal. `None` for a whole ensemble.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<ShardHeader>,
    #[serde(default, skip_serializing)]
    crc: Option<String>,
}

impl JournalHeader {
    pub fn new(identity: &str) -> JournalHeader {
        JournalHeader {
            ensemble: identity.to_owned(),
            journal: JOURNAL,
            shard: None,
            crc: None,
        }
    }

    pub fn for_shard(identity: &str, shard: ShardHeader) -> JournalHeader {
        JournalHeader {
            shard: Some(shard),
            ..JournalHeader::new(identity)
        }
    }
}

/// Shard that the runs of a file belong to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ShardHeader {
    /// Number of the shard, from 0.
    pub number: u64,
    pub shards: u64,
    /// Number of runs of each program in all shards.
    pub runs: u64,
    pub build: String,
}

/// Journal open for appending. If it is dropped without [`Journal::close`], a power failure may
/// remove its last lines.
#[derive(Debug)]
pub(crate) struct Journal {
    file: Arc<File>,
    /// Position after the last complete line \[bytes\].
    end: Mutex<u64>,
    /// Whether the thread that writes to the disk has been notified of new lines.
    is_notified: Arc<AtomicBool>,
    wake: SyncSender<()>,
    syncer: JoinHandle<io::Result<()>>,
}

#[derive(Debug, Default)]
pub(crate) struct StoredJournal {
    /// Valid runs of the journal.
    pub finished: Records,
    /// Shortest run that did not fail.
    pub shortest: Option<Finished>,
    /// Position after the last complete line \[bytes\].
    pub whole: u64,
    /// Messages about corrupted lines.
    pub damage: Vec<String>,
}

/// Reads the journal of an ensemble and checks its runs against the manifest. Skips and reports
/// corrupted lines.
///
/// A file that ends within its first line counts as empty.
///
/// # Errors
///
/// [`JournalError::Foreign`] if the journal does not belong to the ensemble `identity`.
pub(crate) fn read(
    path: &Path,
    manifest: &Manifest,
    identity: &str,
) -> Result<StoredJournal, JournalError> {
    let mut stored = StoredJournal::default();
    let mut locations = Vec::new();
    let (mut shortest, mut damage) = (Shortest::default(), Vec::new());
    let most = most_line(manifest);
    let validator = RecordValidator::new(manifest);
    let header = JournalHeader::new(identity);
    stored.whole = read_lines(path, &header, most, |line| {
        match run(line.text, &validator) {
            Ok(finished) => {
                locations.push(finished.at(0, line.at));
                shortest.offer(finished);
            }
            Err(reason) => {
                let number = line.number;
                damage.push(format!(
                    "line {number} of `journal.jsonl` {reason}, and is skipped"
                ));
            }
        }
    })?;
    let files = if locations.is_empty() {
        Vec::new()
    } else {
        vec![files::open(path)?]
    };
    stored.finished = Records::at(locations, files, most);
    stored.shortest = shortest.0;
    stored.damage = damage;
    Ok(stored)
}

/// Accumulator that finds the run with the fewest ticks among the runs that did not fail. If
/// several runs have equally few ticks, finds the first of them.
#[derive(Debug, Default)]
pub(crate) struct Shortest(pub Option<Finished>);

impl Shortest {
    pub fn offer(&mut self, finished: Finished) {
        let key = |it: &Finished| (it.record.ticks, it.program, it.record.run);
        let is_valid = !matches!(finished.record.outcome, Outcome::Failed { .. });
        if is_valid && (self.0.as_ref()).is_none_or(|it| key(&finished) < key(it)) {
            self.0 = Some(finished);
        }
    }
}

/// Complete line of a journal.
pub(crate) struct JournalLine<'a> {
    /// Line number. The first run is in line 2.
    pub number: u64,
    /// Position of the start of the line \[bytes\].
    pub at: u64,
    /// Text of the line without the line break.
    pub text: &'a [u8],
}

/// Passes the complete lines of a journal to `each`, except the first line. Returns the position
/// after the last complete line \[bytes\].
///
/// # Errors
///
/// [`JournalError::Foreign`] if the journal does not begin with `expected`.
pub(crate) fn read_lines(
    path: &Path,
    expected: &JournalHeader,
    most: u64,
    mut each: impl FnMut(JournalLine),
) -> Result<u64, JournalError> {
    let file = match files::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(0),
        Err(error) => return Err(error.into()),
    };
    JOURNAL_BUDGET.admits(file.metadata()?.len())?;
    let mut file = BufReader::new(file);
    let mut line = Vec::new();
    let mut position = read_line(&mut file, most, &mut line)?;
    let Some(first) = line.strip_suffix(b"\n") else {
        return Ok(0);
    };
    let header: JournalHeader = serde_json::from_slice(first).map_err(|_| JournalError::Foreign)?;
    if header.journal != JOURNAL || checksum::check(first) != LineIntegrity::Valid {
        return Err(JournalError::Foreign);
    }
    if (&header.ensemble, &header.shard) != (&expected.ensemble, &expected.shard) {
        return Err(JournalError::Foreign);
    }
    let mut at = position;
    for number in 2.. {
        line.clear();
        position += read_line(&mut file, most, &mut line)?;
        let Some(text) = line.strip_suffix(b"\n") else {
            break;
        };
        each(JournalLine { number, at, text });
        at = position;
    }
    Ok(at)
}

/// Returns the header of a file of runs, or `None` if its first line is corrupted or incomplete.
pub(crate) fn read_header(path: &Path) -> io::Result<Option<JournalHeader>> {
    let line = first_line(&mut BufReader::new(files::open(path)?))?;
    let Some(line) = line.strip_suffix(b"\n") else {
        return Ok(None);
    };
    let header = serde_json::from_slice(line).ok();
    Ok(header.filter(|_| checksum::check(line) == LineIntegrity::Valid))
}

/// Limit on the length of the first line of a journal \[bytes\].
pub(crate) const MAX_HEADER: u64 = 1 << 12;

/// Returns the first line of a journal with its line break, up to the limit of its length.
pub(crate) fn first_line(file: &mut impl BufRead) -> io::Result<Vec<u8>> {
    let mut line = Vec::new();
    file.take(MAX_HEADER).read_until(b'\n', &mut line)?;
    Ok(line)
}

#[derive(Debug, thiserror::Error)]
pub(crate) enum InvalidLine {
    #[error("is damaged")]
    Corrupted,
    #[error("is not possible: {0}")]
    Impossible(String),
}

/// Reads and validates the run of a line.
pub(crate) fn run(line: &[u8], validator: &RecordValidator<'_>) -> Result<Finished, InvalidLine> {
    if checksum::check(line) != LineIntegrity::Valid {
        return Err(InvalidLine::Corrupted);
    }
    let finished: Finished = serde_json::from_slice(line).map_err(|_| InvalidLine::Corrupted)?;
    match validator.inconsistency(finished.program, &finished.record) {
        Some(reason) => Err(InvalidLine::Impossible(reason)),
        None => Ok(finished),
    }
}

/// Returns a journal with only the valid lines of a corrupted journal. Returns `None` if it belongs
/// to another ensemble.
///
/// # Errors
///
/// Errors of the file system.
pub(crate) fn salvaged(
    path: &Path,
    manifest: &Manifest,
    identity: &str,
) -> io::Result<Option<Vec<u8>>> {
    let mut file = BufReader::new(files::open(path)?);
    let mut text = line(&JournalHeader::new(identity)).into_bytes();
    let mut next = Vec::new();
    // Only a valid first line identifies the ensemble.
    let most = most_line(manifest);
    let validator = RecordValidator::new(manifest);
    let mut count = read_or_end(&mut file, most, &mut next)?;
    if let Ok(header) = serde_json::from_slice::<JournalHeader>(&next) {
        let first = next.strip_suffix(b"\n").unwrap_or(&next);
        let is_valid = checksum::check(first) == LineIntegrity::Valid;
        if is_valid && header.ensemble != identity {
            return Ok(None);
        }
    }
    // The first line may have lost its line break and contain the first run as well.
    while count > 0 {
        let whole = next.strip_suffix(b"\n").unwrap_or(&next);
        if let Ok(finished) = run(whole, &validator) {
            text.extend(line(&finished).into_bytes());
        }
        next.clear();
        count = read_or_end(&mut file, most, &mut next)?;
    }
    Ok(Some(text))
}

/// Reads the next line like [`read_line`]. Treats a line of `most` or more bytes as the end of the
/// file, and returns 0.
fn read_or_end(file: &mut impl BufRead, most: u64, line: &mut Vec<u8>) -> io::Result<u64> {
    match read_line(file, most, line) {
        Err(error) if error.kind() == io::ErrorKind::FileTooLarge => Ok(0),
        read => read,
    }
}

/// Returns the limit on the length of a line of an ensemble's journal \[bytes\].
pub(crate) fn most_line(manifest: &Manifest) -> u64 {
    let captures = manifest.programs.iter().map(EnsembleProgram::captures);
    budget::record(captures.max().unwrap_or(0))
}

impl Journal {
    /// Opens a journal after its last complete line and truncates the rest. `whole` is the position
    /// that [`read`] returned.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn open(path: &Path, header: &JournalHeader, whole: u64) -> Result<Journal, JournalError> {
        let mut options = OpenOptions::new();
        let options = options.create(true).truncate(false).write(true);
        let mut file = files::open_own(path, options)?;
        file.set_len(whole)?;
        file.seek(SeekFrom::Start(whole))?;
        let mut end = whole;
        if whole == 0 {
            let line = line(header);
            file.write_all(line.as_bytes())?;
            end = line.len() as u64;
        }
        file.sync_all()?;
        let file = Arc::new(file);
        let (wake, woken) = sync_channel(1);
        let is_notified = Arc::new(AtomicBool::new(false));
        let syncer = std::thread::Builder::new().name("journal".into()).spawn({
            let (file, is_notified) = (file.clone(), is_notified.clone());
            move || sync(&file, &is_notified, &woken)
        })?;
        Ok(Journal {
            file,
            end: Mutex::new(end),
            is_notified,
            wake,
            syncer,
        })
    }

    /// Appends a finished run. Returns the position of the start of its line \[bytes\]. The
    /// operating system has then received the line and writes it to the disk soon.
    ///
    /// # Errors
    ///
    /// Errors of the file system. The journal then ends with the previous run.
    pub fn append(&self, finished: &impl Serialize) -> Result<u64, JournalError> {
        let line = line(finished);
        let mut end = self.end.lock().expect("no panic while it is locked");
        if let Err(error) = (&*self.file).write_all(line.as_bytes()) {
            // A partial line would corrupt the next one.
            self.file.set_len(*end)?;
            (&*self.file).seek(SeekFrom::Start(*end))?;
            return Err(error.into());
        }
        let at = *end;
        *end += line.len() as u64;
        if !self.is_notified.swap(true, Ordering::AcqRel)
            && let Err(TrySendError::Disconnected(())) = self.wake.try_send(())
        {
            self.is_notified.store(false, Ordering::Release);
            // [`Journal::close`] returns the error.
            return Err(io::Error::other("writing has stopped").into());
        }
        Ok(at)
    }

    /// Writes all appended lines to the disk, so that they survive a power failure.
    ///
    /// # Errors
    ///
    /// Errors of the disk.
    pub fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    /// Waits until all appended lines are on the disk and survive a power failure.
    ///
    /// # Errors
    ///
    /// The first error of the disk.
    pub fn close(self) -> Result<(), JournalError> {
        drop(self.wake);
        let synced = self.syncer.join();
        synced.unwrap_or_else(|_| Err(io::Error::other("the writer panicked")))?;
        Ok(self.file.sync_all()?)
    }
}

/// Writes new lines to the disk periodically, until the sender of `woken` is dropped.
fn sync(file: &File, is_notified: &AtomicBool, woken: &Receiver<()>) -> io::Result<()> {
    // Everything is on the disk here, so wait for a new line.
    while woken.recv().is_ok() {
        // Later lines send no message. The wait therefore ends early only if the sender is dropped.
        let _ = woken.recv_timeout(SYNC_EVERY);
        is_notified.store(false, Ordering::Release);
        file.sync_data()?;
    }
    Ok(())
}
