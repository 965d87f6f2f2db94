//! Lines of a journal.
use std::io::{self, BufRead, Read as _};

use serde::Serialize;
use stochc_files::budget;
use stochc_files::checksum::{self, LineIntegrity};

use crate::journal::JournalError;
use crate::records::Finished;

/// Returns a line of a journal with its checksum.
pub(crate) fn line(of: &impl Serialize) -> String {
    let json = serde_json::to_string(of).expect("a record is plain data");
    checksum::sealed(json) + "\n"
}

/// Reads the next line with its line break, or the rest of the file. Returns the number of bytes.
///
/// # Errors
///
/// Errors of the file, and a line of `most` or more bytes.
pub(crate) fn read_line(file: &mut impl BufRead, most: u64, line: &mut Vec<u8>) -> io::Result<u64> {
    let count = file.take(most).read_until(b'\n', line)? as u64;
    if count < most {
        Ok(count)
    } else {
        let size = budget::size(most);
        Err(budget::too_large(&format!("a line of {size} or more")))
    }
}

/// Reads a run again from a line that was valid before. Returns the run and the length of the line.
/// `line` is a buffer.
///
/// # Errors
///
/// [`JournalError::Changed`] if the line is no longer valid.
pub(crate) fn read_at(
    file: &mut impl BufRead,
    most: u64,
    line: &mut Vec<u8>,
) -> Result<(Finished, u64), JournalError> {
    line.clear();
    let bytes = read_line(file, most, line)?;
    let text = line.strip_suffix(b"\n").ok_or(JournalError::Changed)?;
    if checksum::check(text) == LineIntegrity::Corrupted {
        return Err(JournalError::Changed);
    }
    let finished = serde_json::from_slice(text).map_err(|_| JournalError::Changed)?;
    Ok((finished, bytes))
}
