//! The write-ahead log: one line of JSON per finished run, with a checksum, as soon as it is finished.
//!
//! `journal.jsonl` begins with a line that names the ensemble, so that runs of another program
//! cannot slip in. What a kill or a loss of power leaves of the last line is cut off on the next
//! opening; a damaged line before it is passed over, and its run done again: a run is a pure
//! function of its number, so that nothing but time is lost.
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

/// What a loss of power may cost: the runs finished during this time. A kill costs none.
const SYNC_EVERY: Duration = Duration::from_millis(500);

/// Version of the layout of a journal.
const JOURNAL: u32 = 1;

/// The first line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JournalHeader {
    pub ensemble: String,
    journal: u32,
    /// `None`: it is the journal of a whole ensemble.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub piece: Option<PieceHeader>,
    #[serde(default, skip_serializing)]
    crc: Option<String>,
}

impl JournalHeader {
    pub fn new(identity: &str) -> JournalHeader {
        JournalHeader {
            ensemble: identity.to_owned(),
            journal: JOURNAL,
            piece: None,
            crc: None,
        }
    }

    /// Of the runs of a piece alone.
    pub fn of_piece(identity: &str, piece: PieceHeader) -> JournalHeader {
        JournalHeader {
            piece: Some(piece),
            ..JournalHeader::new(identity)
        }
    }
}

/// What the runs of a file are a part of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PieceHeader {
    /// Its number, from 0.
    pub number: u64,
    /// How many there are.
    pub of: u64,
    /// Runs of each program in all pieces.
    pub runs: u64,
    /// The build that made it.
    pub build: String,
}

/// A journal that is open for appending; dropping it without [`Journal::close`] may lose its end with the power.
#[derive(Debug)]
pub(crate) struct Journal {
    file: Arc<File>,
    /// Where its last whole line ends.
    end: Mutex<u64>,
    /// Whether the syncer knows that something is not safe yet.
    is_told: Arc<AtomicBool>,
    wake: SyncSender<()>,
    syncer: JoinHandle<io::Result<()>>,
}

/// What a journal holds.
#[derive(Debug, Default)]
pub(crate) struct StoredJournal {
    /// Its runs.
    pub finished: Records,
    /// The shortest of them that did not fail.
    pub shortest: Option<Finished>,
    /// Where its last line ends; what follows is half of one.
    pub whole: u64,
    /// What is wrong with it, line by line.
    pub damage: Vec<String>,
}

/// Reads the journal of an ensemble, and holds its runs against the manifest; a damaged line is passed over, and told.
///
/// A file that ends within its first line holds nothing.
///
/// # Errors
/// [`JournalError::Foreign`] where it is not of the ensemble `identity`.
pub(crate) fn read(
    path: &Path,
    manifest: &Manifest,
    identity: &str,
) -> Result<StoredJournal, JournalError> {
    let mut stored = StoredJournal::default();
    let mut places = Vec::new();
    let (mut shortest, mut damage) = (Shortest::default(), Vec::new());
    let most = most_line(manifest);
    let validator = RecordValidator::new(manifest);
    let header = JournalHeader::new(identity);
    stored.whole = read_lines(path, &header, most, |line| {
        match run(line.text, &validator) {
            Ok(finished) => {
                places.push(finished.at(0, line.at));
                shortest.offer(finished);
            }
            Err(reason) => {
                let number = line.number;
                damage.push(format!(
                    "line {number} of `journal.jsonl` {reason}, and is left out"
                ));
            }
        }
    })?;
    let files = if places.is_empty() {
        Vec::new()
    } else {
        vec![files::open(path)?]
    };
    stored.finished = Records::at(places, files, most);
    stored.shortest = shortest.0;
    stored.damage = damage;
    Ok(stored)
}

/// The run of fewest ticks that did not fail, the first one of several.
#[derive(Debug, Default)]
pub(crate) struct Shortest(pub Option<Finished>);

impl Shortest {
    pub fn offer(&mut self, finished: Finished) {
        let key = |it: &Finished| (it.record.ticks, it.program, it.record.run);
        let is_sound = !matches!(finished.record.outcome, Outcome::Failed { .. });
        if is_sound && (self.0.as_ref()).is_none_or(|it| key(&finished) < key(it)) {
            self.0 = Some(finished);
        }
    }
}

/// A whole line of a journal.
pub(crate) struct JournalLine<'a> {
    /// Its number; that of the first one of a run is 2.
    pub number: u64,
    /// Where it begins \[bytes\].
    pub at: u64,
    /// Without the line break.
    pub text: &'a [u8],
}

/// Reads the whole lines of a journal after its first, and returns the end of the last one.
///
/// # Errors
/// [`JournalError::Foreign`] where it does not begin with `expected`.
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
    if header.journal != JOURNAL || checksum::check(first) != LineIntegrity::Sound {
        return Err(JournalError::Foreign);
    }
    if (&header.ensemble, &header.piece) != (&expected.ensemble, &expected.piece) {
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

/// The first line of a file of runs; `None`: it is damaged, or not there as a whole.
pub(crate) fn read_header(path: &Path) -> io::Result<Option<JournalHeader>> {
    let line = first_line(&mut BufReader::new(files::open(path)?))?;
    let Some(line) = line.strip_suffix(b"\n") else {
        return Ok(None);
    };
    let header = serde_json::from_slice(line).ok();
    Ok(header.filter(|_| checksum::check(line) == LineIntegrity::Sound))
}

/// Bytes of the first line of a journal, fewer than which it has.
pub(crate) const MAX_HEADER: u64 = 1 << 12;

/// The first line of a journal with its end, or as much of it as it may have.
pub(crate) fn first_line(file: &mut impl BufRead) -> io::Result<Vec<u8>> {
    let mut line = Vec::new();
    file.take(MAX_HEADER).read_until(b'\n', &mut line)?;
    Ok(line)
}

/// The run of a line, or what is wrong with it.
pub(crate) fn run(line: &[u8], validator: &RecordValidator<'_>) -> Result<Finished, String> {
    let damaged = || "is damaged".to_owned();
    if checksum::check(line) != LineIntegrity::Sound {
        return Err(damaged());
    }
    let finished: Finished = serde_json::from_slice(line).map_err(|_| damaged())?;
    match validator.inconsistency(finished.program, &finished.record) {
        Some(reason) => Err(format!("says what cannot be: {reason}")),
        None => Ok(finished),
    }
}

/// Writes a journal of the sound lines of one that `read` refuses or complains of; `None`: it is of another ensemble.
///
/// # Errors
/// Those of the file system.
pub(crate) fn salvaged(
    path: &Path,
    manifest: &Manifest,
    identity: &str,
) -> io::Result<Option<Vec<u8>>> {
    let mut file = BufReader::new(files::open(path)?);
    let mut text = line(&JournalHeader::new(identity)).into_bytes();
    let mut next = Vec::new();
    // A sound first line names the ensemble of the others; a corrupted one does not.
    let most = most_line(manifest);
    let validator = RecordValidator::new(manifest);
    let mut count = read_or_end(&mut file, most, &mut next)?;
    if let Ok(header) = serde_json::from_slice::<JournalHeader>(&next) {
        let first = next.strip_suffix(b"\n").unwrap_or(&next);
        let sound = checksum::check(first) == LineIntegrity::Sound;
        if sound && header.ensemble != identity {
            return Ok(None);
        }
    }
    // The first line may have lost its end, and be the first run as well.
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

/// Reads the next line, as [`read_line`] does; at one of `most` bytes what is sound has come to an end.
fn read_or_end(file: &mut impl BufRead, most: u64, line: &mut Vec<u8>) -> io::Result<u64> {
    match read_line(file, most, line) {
        Err(error) if error.kind() == io::ErrorKind::FileTooLarge => Ok(0),
        read => read,
    }
}

/// Bytes of a line of the journal of an ensemble, fewer than which it has.
pub(crate) fn most_line(manifest: &Manifest) -> u64 {
    let captures = manifest.programs.iter().map(EnsembleProgram::captures);
    budget::record(captures.max().unwrap_or(0))
}

impl Journal {
    /// Opens a journal after its last whole line, and cuts off what follows; `whole` is from [`read`].
    ///
    /// # Errors
    /// Those of the file system.
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
        let is_told = Arc::new(AtomicBool::new(false));
        let syncer = std::thread::Builder::new().name("journal".into()).spawn({
            let (file, is_told) = (file.clone(), is_told.clone());
            move || sync(&file, &is_told, &woken)
        })?;
        Ok(Journal {
            file,
            end: Mutex::new(end),
            is_told,
            wake,
            syncer,
        })
    }

    /// Writes a finished run; the system has it once this has returned, and the disk soon after. Where its line begins
    /// \[bytes\].
    ///
    /// # Errors
    /// Those of the file system; the journal ends with the run before, then.
    pub fn append(&self, finished: &impl Serialize) -> Result<u64, JournalError> {
        let line = line(finished);
        let mut end = self.end.lock().expect("nobody panics while it is held");
        if let Err(error) = (&*self.file).write_all(line.as_bytes()) {
            // Half a line would take the next one with it.
            self.file.set_len(*end)?;
            (&*self.file).seek(SeekFrom::Start(*end))?;
            return Err(error.into());
        }
        let at = *end;
        *end += line.len() as u64;
        if !self.is_told.swap(true, Ordering::AcqRel)
            && let Err(TrySendError::Disconnected(())) = self.wake.try_send(())
        {
            self.is_told.store(false, Ordering::Release);
            // [`Journal::close`] tells why.
            return Err(io::Error::other("writing has stopped").into());
        }
        Ok(at)
    }

    /// Has all that was appended survive a loss of power.
    ///
    /// # Errors
    /// Those of the disk.
    pub fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    /// Waits until all that was appended would survive a loss of power.
    ///
    /// # Errors
    /// The first that the disk had.
    pub fn close(self) -> Result<(), JournalError> {
        drop(self.wake);
        let synced = self.syncer.join();
        synced.unwrap_or_else(|_| Err(io::Error::other("the writer panicked")))?;
        Ok(self.file.sync_all()?)
    }
}

/// Makes lines safe every so often, until the other end hangs up.
fn sync(file: &File, is_told: &AtomicBool, woken: &Receiver<()>) -> io::Result<()> {
    // Nothing is unsafe here, so there is nothing to be woken up for but a line.
    while woken.recv().is_ok() {
        // Of the lines that follow meanwhile nobody tells, so that this is over early only when the other end hangs up.
        let _ = woken.recv_timeout(SYNC_EVERY);
        is_told.store(false, Ordering::Release);
        file.sync_data()?;
    }
    Ok(())
}
