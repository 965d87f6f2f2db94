//! `checksums.json`: what the files of a results folder were when they were last written as a whole.
//!
//! A line of JSON that bears its own checksum. The journal grows behind what is known of it.
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};
use stochc_files::budget::CHECKSUMS;
use stochc_files::checksum::{self, LineIntegrity, Sum, of_file};
use stochc_files::{open, read_file};

use crate::folder::CHECKSUMS_FILE;

/// Checksums of files.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct FolderChecksums {
    files: Vec<FileChecksum>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct FileChecksum {
    name: String,
    bytes: u64,
    /// CRC-32 of them, in hexadecimal.
    crc32: String,
}

impl FolderChecksums {
    /// Notes a file.
    pub fn note(&mut self, name: &str, sum: Sum) {
        self.files.push(FileChecksum {
            name: name.to_owned(),
            bytes: sum.bytes,
            crc32: format!("{:08x}", sum.crc32),
        });
    }

    /// The text of the file.
    pub fn to_json(&self) -> String {
        let json = serde_json::to_string(self).expect("checksums are plain data");
        checksum::sealed(json) + "\n"
    }

    /// Reads it in a folder; `None`: there is none, or it says nothing that can be believed.
    pub fn read(folder: &Path) -> (Option<FolderChecksums>, Option<String>) {
        let damaged = || (None, Some(format!("`{CHECKSUMS_FILE}` is damaged")));
        let bytes = match read_file(&folder.join(CHECKSUMS_FILE), CHECKSUMS) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return (None, None),
            Err(error) => {
                return (
                    None,
                    Some(format!("cannot read `{CHECKSUMS_FILE}`: {error}")),
                );
            }
        };
        let Some(line) = bytes.strip_suffix(b"\n") else {
            return damaged();
        };
        match (checksum::check(line), serde_json::from_slice(line)) {
            (LineIntegrity::Sound, Ok(checksums)) => (Some(checksums), None),
            _ => damaged(),
        }
    }

    /// Whether it is known what a file was.
    pub fn knows(&self, name: &str) -> bool {
        self.entry(name).is_some()
    }

    fn entry(&self, name: &str) -> Option<&FileChecksum> {
        self.files.iter().find(|entry| entry.name == name)
    }

    /// The names of its files, those alone that lie in the folder itself.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let names = self.files.iter().map(|entry| entry.name.as_str());
        names.filter(|name| Path::new(name).file_name().is_some_and(|it| it == *name))
    }

    /// What is wrong with a file of the folder; `None`: nothing, or nothing is known of it. One that `grows` may
    /// have become longer.
    pub fn damage(&self, folder: &Path, name: &str, grows: bool) -> Option<String> {
        let entry = self.entry(name)?;
        let found = open(&folder.join(name)).and_then(|file| {
            let length = file.metadata()?.len();
            Ok((length, of_file(file, entry.bytes)?))
        });
        let shown = stochc_text::visible(name);
        match found {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Some(format!("`{shown}` is missing"))
            }
            Err(error) => Some(format!("cannot read `{shown}`: {error}")),
            Ok((length, _)) if length < entry.bytes => Some(format!(
                "`{shown}` is cut short: it has {length} bytes and had {}",
                entry.bytes
            )),
            Ok((length, sum))
                if format!("{:08x}", sum.crc32) != entry.crc32
                    || !grows && length > entry.bytes =>
            {
                Some(format!(
                    "`{shown}` is not what was written: its checksum differs"
                ))
            }
            Ok(_) => None,
        }
    }
}
