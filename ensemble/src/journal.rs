//! The write-ahead log: one line of JSON per finished run, with a checksum, as soon as it is finished.
//!
//! `journal.jsonl` begins with a line that names the ensemble, so that runs of another program
//! cannot slip in. What a kill or a loss of power leaves of the last line is cut off on the next
//! opening; a damaged line before it is passed over, and its run done again: a run is a pure
//! function of its number, so that nothing but time is lost.
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use stochc_files as files;
use stochc_files::budget::{self, JOURNAL as JOURNAL_BUDGET};
use stochc_files::checksum::{self, Line};
use stochc_ir::record::RunRecord;

use super::plausible::impossible;
use super::{Manifest, Program, clock};

/// What a loss of power may cost: the runs finished during this time. A kill costs none.
const SYNC_EVERY: Duration = Duration::from_millis(500);

/// A run of one of the ensemble's programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    /// An index into the manifest's programs.
    pub program: usize,
    /// How it went.
    pub record: RunRecord,
}

/// Version of the layout of a journal: in 1 lines had no checksums.
const JOURNAL: u32 = 2;

/// The first line. Another field would be another header, so that no damage makes it an older one.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    ensemble: String,
    #[serde(default)]
    journal: Option<u32>,
    #[serde(default, skip_serializing)]
    crc: Option<String>,
}

impl Header {
    fn of(identity: &str) -> Header {
        Header {
            ensemble: identity.to_owned(),
            journal: Some(JOURNAL),
            crc: None,
        }
    }
}

/// Why a journal cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// Its first line names another ensemble, or is no such line.
    #[error(
        "`journal.jsonl` does not belong to `manifest.json` beside it; \
         move both to where they came from, or choose another folder; if one is damaged, `stochc verify --repair` may help"
    )]
    Foreign,
    /// It could not be read or written.
    #[error("cannot keep finished runs in `journal.jsonl`: {0}")]
    Io(#[from] io::Error),
}

/// A journal that is open for appending; dropping it without [`Journal::close`] may lose its end with the power.
#[derive(Debug)]
pub(super) struct Journal {
    file: Arc<File>,
    /// Where its last whole line ends.
    end: Mutex<u64>,
    wake: SyncSender<()>,
    syncer: JoinHandle<io::Result<()>>,
}

/// What a journal holds.
#[derive(Debug, Default)]
pub(super) struct Stored {
    /// Its runs, sorted by program and run. Of two lines for one run the first counts.
    pub finished: Vec<Finished>,
    /// Where its last line ends; what follows is half of one.
    pub whole: u64,
    /// Whether its lines bear checksums.
    pub is_sealed: bool,
    /// What is wrong with it, line by line.
    pub damage: Vec<String>,
}

/// Reads the journal of an ensemble, and holds its runs against the manifest; a damaged line is passed over, and told.
///
/// A file that ends within its first line holds nothing.
///
/// # Errors
/// [`JournalError::Foreign`] where it is not of the ensemble `identity`.
pub(super) fn read(
    path: &Path,
    manifest: &Manifest,
    identity: &str,
) -> Result<Stored, JournalError> {
    let mut stored = Stored::default();
    let mut runs = BTreeMap::new();
    let mut damage = Vec::new();
    let most = most_line(manifest);
    (stored.whole, stored.is_sealed) =
        read_lines(path, identity, most, |number, text, is_sealed| {
            match run(text, is_sealed, manifest) {
                Ok(finished) => {
                    let key = (finished.program, finished.record.run);
                    runs.entry(key).or_insert(finished);
                }
                Err(reason) => {
                    damage.push(format!(
                        "line {number} of `journal.jsonl` {reason}, and is left out"
                    ));
                }
            }
        })?;
    stored.finished = runs.into_values().collect();
    stored.damage = damage;
    Ok(stored)
}

/// Reads the whole lines of a journal behind its first: the number of each, the line, and whether the journal is of
/// a layout in which lines bear checksums. Where the last one ends, and whether it is.
///
/// # Errors
/// [`JournalError::Foreign`] where it is not of `identity`.
pub(super) fn read_lines(
    path: &Path,
    identity: &str,
    most: u64,
    mut each: impl FnMut(u64, &[u8], bool),
) -> Result<(u64, bool), JournalError> {
    let file = match files::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok((0, true)),
        Err(error) => return Err(error.into()),
    };
    JOURNAL_BUDGET.admits(file.metadata()?.len())?;
    let mut file = BufReader::new(file);
    let mut line = Vec::new();
    let mut position = read_line(&mut file, most, &mut line)?;
    let Some(first) = line.strip_suffix(b"\n") else {
        return Ok((0, true));
    };
    let header: Header = serde_json::from_slice(first).map_err(|_| JournalError::Foreign)?;
    let sound = checksum::check(first) == Line::Sound;
    let is_sealed = match (header.journal, header.crc) {
        (Some(JOURNAL), Some(_)) if sound => true,
        (None, None) => false,
        _ => return Err(JournalError::Foreign),
    };
    if header.ensemble != identity {
        return Err(JournalError::Foreign);
    }
    let mut whole = position;
    for number in 2.. {
        line.clear();
        position += read_line(&mut file, most, &mut line)?;
        let Some(text) = line.strip_suffix(b"\n") else {
            break;
        };
        whole = position;
        each(number, text, is_sealed);
    }
    Ok((whole, is_sealed))
}

/// The run of a line, or what is wrong with it.
fn run(line: &[u8], is_sealed: bool, manifest: &Manifest) -> Result<Finished, String> {
    let damaged = || "is damaged".to_owned();
    match checksum::check(line) {
        Line::Sound => {}
        // Of an older journal those lines have one that were added since.
        Line::Unsealed if !is_sealed => {}
        Line::Damaged | Line::Unsealed => return Err(damaged()),
    }
    let finished = serde_json::from_slice(line).map_err(|_| damaged())?;
    match impossible(manifest, &finished) {
        Some(reason) => Err(format!("says what cannot be: {reason}")),
        None => Ok(finished),
    }
}

/// Writes a journal of the sound lines of one that `read` refuses or complains of; `None`: it is of another ensemble.
///
/// # Errors
/// Those of the file system.
pub(super) fn salvaged(
    path: &Path,
    manifest: &Manifest,
    identity: &str,
) -> io::Result<Option<Vec<u8>>> {
    let mut file = BufReader::new(files::open(path)?);
    let mut text = line(&Header::of(identity)).into_bytes();
    let mut next = Vec::new();
    // Where the first line is sound, it says whose the others are; where it is not, nobody says.
    let most = most_line(manifest);
    read_line(&mut file, most, &mut next)?;
    if let Ok(header) = serde_json::from_slice::<Header>(&next) {
        let first = next.strip_suffix(b"\n").unwrap_or(&next);
        let sound = match header.journal {
            Some(_) => checksum::check(first) == Line::Sound,
            None => true,
        };
        if sound && header.ensemble != identity {
            return Ok(None);
        }
    }
    // The first line may have lost its end, and be the first run as well.
    loop {
        let whole = next.strip_suffix(b"\n").unwrap_or(&next);
        if let Ok(finished) = run(whole, false, manifest) {
            text.extend(line(&finished).into_bytes());
        }
        next.clear();
        if read_line(&mut file, most, &mut next)? == 0 {
            return Ok(Some(text));
        }
    }
}

/// Bytes of a line of the journal of an ensemble, fewer than which it has.
pub(super) fn most_line(manifest: &Manifest) -> u64 {
    let captures = manifest.programs.iter().map(Program::captures);
    budget::record(captures.max().unwrap_or(0))
}

/// Reads the next line with its end, or what there is of it; how many bytes.
///
/// # Errors
/// Those of the file, and of a line of `most` bytes.
fn read_line(file: &mut impl BufRead, most: u64, line: &mut Vec<u8>) -> io::Result<u64> {
    let count = file.take(most).read_until(b'\n', line)? as u64;
    match count < most {
        true => Ok(count),
        false => {
            let size = budget::size(most);
            Err(budget::too_large(&format!("a line of {size} or more")))
        }
    }
}

impl Journal {
    /// Opens a journal after its last whole line, and cuts off what follows; `whole` is from [`read`].
    ///
    /// # Errors
    /// Those of the file system.
    pub fn open(path: &Path, identity: &str, whole: u64) -> Result<Journal, JournalError> {
        let mut options = File::options();
        let options = options.create(true).truncate(false).write(true);
        let mut file = files::open_own(path, options)?;
        file.set_len(whole)?;
        file.seek(SeekFrom::Start(whole))?;
        let mut end = whole;
        if whole == 0 {
            let line = line(&Header::of(identity));
            file.write_all(line.as_bytes())?;
            end = line.len() as u64;
        }
        file.sync_all()?;
        let file = Arc::new(file);
        let (wake, woken) = sync_channel(1);
        let syncer = std::thread::Builder::new().name("journal".into()).spawn({
            let file = file.clone();
            move || sync(&file, &woken)
        })?;
        Ok(Journal {
            file,
            end: Mutex::new(end),
            wake,
            syncer,
        })
    }

    /// Writes a finished run; the system has it once this has returned, and the disk soon after.
    ///
    /// # Errors
    /// Those of the file system; the journal ends with the run before, then.
    pub fn append(&self, finished: &impl Serialize) -> Result<(), JournalError> {
        let line = line(finished);
        let mut end = self.end.lock().expect("nobody panics while it is held");
        if let Err(error) = (&*self.file).write_all(line.as_bytes()) {
            // Half a line would take the next one with it.
            self.file.set_len(*end)?;
            (&*self.file).seek(SeekFrom::Start(*end))?;
            return Err(error.into());
        }
        *end += line.len() as u64;
        match self.wake.try_send(()) {
            Ok(()) | Err(TrySendError::Full(())) => Ok(()),
            // [`Journal::close`] tells why.
            Err(TrySendError::Disconnected(())) => {
                Err(io::Error::other("writing has stopped").into())
            }
        }
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

/// A line of a journal, with its checksum.
fn line(of: &impl Serialize) -> String {
    let json = serde_json::to_string(of).expect("a record is plain data");
    checksum::sealed(&json) + "\n"
}

/// Makes lines safe every so often, until the other end hangs up.
fn sync(file: &File, woken: &Receiver<()>) -> io::Result<()> {
    // Nothing is unsafe here, so there is nothing to be woken up for but a line.
    while woken.recv().is_ok() {
        let due = clock::now() + SYNC_EVERY;
        while woken
            .recv_timeout(due.saturating_duration_since(clock::now()))
            .is_ok_and(|()| clock::now() < due)
        {}
        file.sync_data()?;
    }
    Ok(())
}
