//! The write-ahead log: one line of JSON per finished run, as soon as it is finished.
//!
//! `journal.jsonl` begins with a line that names the ensemble, so that runs of another program
//! cannot slip in. What a kill or a loss of power leaves of the last line is cut off on the next
//! opening; a damaged line before it is passed over, and its run done again: a run is a pure
//! function of its number, so that nothing but time is lost.
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use stochc_files as files;
use stochc_ir::record::RunRecord;

use super::clock;

/// What a kill may cost: the runs finished during this time.
const SYNC_EVERY: Duration = Duration::from_millis(500);

/// Finished runs that wait for the disk before workers have to.
const WAITING: usize = 256;

/// Bytes of a line, one more than may be: of a run with 10^7 captures it has a third.
const MOST_LINE: u64 = 1 << 30;

/// A run of one of the ensemble's programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    /// An index into the manifest's programs.
    pub program: usize,
    /// How it went.
    pub record: RunRecord,
}

#[derive(Serialize, Deserialize)]
struct Header {
    ensemble: String,
}

/// Why a journal cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// Its first line names another ensemble, or is no such line.
    #[error(
        "`journal.jsonl` does not belong to `manifest.json` beside it; \
         move both to where they came from, or choose another folder"
    )]
    Foreign,
    /// It could not be read or written.
    #[error("cannot keep finished runs in `journal.jsonl`: {0}")]
    Io(#[from] io::Error),
}

/// A journal that is open for appending; dropping it without [`Journal::close`] may lose its end.
#[derive(Debug)]
pub(super) struct Journal {
    lines: SyncSender<String>,
    writer: JoinHandle<io::Result<()>>,
}

/// Reads the runs that a journal holds, sorted by program and run, and where its last whole line ends.
///
/// A file that ends within its first line holds none. Of two lines for one run the first counts.
///
/// # Errors
/// [`JournalError::Foreign`] where it is not of the ensemble `identity`.
pub(super) fn read(path: &Path, identity: &str) -> Result<(Vec<Finished>, u64), JournalError> {
    let mut file = match files::open(path) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok((Vec::new(), 0)),
        Err(error) => return Err(error.into()),
    };
    let mut line = Vec::new();
    let mut position = read_line(&mut file, &mut line)?;
    if line.last() != Some(&b'\n') {
        return Ok((Vec::new(), 0));
    }
    match serde_json::from_slice::<Header>(&line) {
        Ok(header) if header.ensemble == identity => {}
        _ => return Err(JournalError::Foreign),
    }
    let mut whole = position;
    let mut runs = BTreeMap::new();
    loop {
        line.clear();
        position += read_line(&mut file, &mut line)?;
        if line.last() != Some(&b'\n') {
            break;
        }
        if let Ok(finished) = serde_json::from_slice::<Finished>(&line) {
            whole = position;
            let key = (finished.program, finished.record.run);
            runs.entry(key).or_insert(finished);
        }
    }
    Ok((runs.into_values().collect(), whole))
}

/// Reads the next line with its end, or what there is of it; how many bytes.
fn read_line(file: &mut impl BufRead, line: &mut Vec<u8>) -> io::Result<u64> {
    let count = file.take(MOST_LINE).read_until(b'\n', line)? as u64;
    match count < MOST_LINE {
        true => Ok(count),
        false => Err(io::Error::new(
            io::ErrorKind::FileTooLarge,
            "a line of 1 GiB or more",
        )),
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
        if whole == 0 {
            let header = Header {
                ensemble: identity.to_owned(),
            };
            let mut line = serde_json::to_vec(&header).expect("a header is plain data");
            line.push(b'\n');
            file.write_all(&line)?;
        }
        file.sync_all()?;
        let (lines, received) = sync_channel(WAITING);
        let writer = std::thread::Builder::new()
            .name("journal".into())
            .spawn(move || write(file, &received))?;
        Ok(Journal { lines, writer })
    }

    /// Hands a finished run to the writer; waits while the disk is far behind.
    ///
    /// # Errors
    /// A word that the writer has stopped; [`Journal::close`] tells why.
    pub fn append(&self, finished: &Finished) -> Result<(), JournalError> {
        let mut line = serde_json::to_string(finished).expect("a record is plain data");
        line.push('\n');
        self.lines
            .send(line)
            .map_err(|_| io::Error::other("writing has stopped").into())
    }

    /// Writes all that was appended, and waits until it would survive a loss of power.
    ///
    /// # Errors
    /// The first that the writer met.
    pub fn close(self) -> Result<(), JournalError> {
        drop(self.lines);
        let written = self.writer.join();
        Ok(written.unwrap_or_else(|_| Err(io::Error::other("the writer panicked")))?)
    }
}

/// Writes lines until the other end hangs up, and makes them safe every so often.
fn write(file: File, lines: &Receiver<String>) -> io::Result<()> {
    let mut file = BufWriter::new(file);
    loop {
        // Nothing is unsafe here, so there is nothing to be woken up for but a line.
        let Ok(line) = lines.recv() else {
            return Ok(());
        };
        file.write_all(line.as_bytes())?;
        let due = clock::now() + SYNC_EVERY;
        let open = loop {
            match lines.recv_timeout(due.saturating_duration_since(clock::now())) {
                Ok(line) => file.write_all(line.as_bytes())?,
                Err(RecvTimeoutError::Timeout) => break true,
                Err(RecvTimeoutError::Disconnected) => break false,
            }
            // With a line always waiting, there would never be a timeout.
            if clock::now() >= due {
                break true;
            }
        };
        file.flush()?;
        file.get_ref().sync_data()?;
        if !open {
            return Ok(());
        }
    }
}
