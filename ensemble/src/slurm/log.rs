//! What a job has said last.
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::Path;

use stochc_files as files;

/// The last lines of a job's log, a few; empty: there is none.
pub fn last_lines(path: &Path) -> Vec<String> {
    /// Lines that are told.
    const LINES: usize = 12;
    /// Bytes in which they are looked for.
    const BYTES: u64 = 4096;
    let tail = || {
        let mut file = files::open(path)?;
        let length = file.metadata()?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(BYTES)))?;
        let mut tail = Vec::new();
        file.take(BYTES).read_to_end(&mut tail)?;
        std::io::Result::Ok(tail)
    };
    let tail = tail().unwrap_or_default();
    let tail = String::from_utf8_lossy(&tail);
    let lines: Vec<&str> = tail
        .lines()
        .filter(|line| !line.trim().is_empty())
        .collect();
    let last = lines.iter().skip(lines.len().saturating_sub(LINES));
    last.map(|line| (*line).to_owned()).collect()
}
