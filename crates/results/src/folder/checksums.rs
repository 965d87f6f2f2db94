//! `checksums.json`: checksums of the files of a results folder, when all were last written.
//!
//! The file is a line of JSON with its own checksum. The journal may have grown since then.
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};
use stochc_files::budget::CHECKSUMS;
use stochc_files::checksum::{self, LineIntegrity, Sum, sum_file};
use stochc_files::{open, read_file};

use crate::folder::CHECKSUMS_FILE;

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct FolderChecksums {
    files: Vec<FileChecksum>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct FileChecksum {
    name: String,
    bytes: u64,
    /// CRC-32 of the file, in hexadecimal.
    crc32: String,
}

impl FolderChecksums {
    /// Adds the size and the checksum of a file.
    pub fn note(&mut self, name: &str, sum: Sum) {
        self.files.push(FileChecksum {
            name: name.to_owned(),
            bytes: sum.bytes,
            crc32: format!("{:08x}", sum.crc32),
        });
    }

    /// Returns the text of `checksums.json`.
    pub fn to_json(&self) -> String {
        let json = serde_json::to_string(self).expect("checksums are plain data");
        checksum::sealed(json) + "\n"
    }

    /// Reads the checksums of a folder, or returns `None` and a message if they are invalid.
    pub fn read(folder: &Path) -> (Option<FolderChecksums>, Option<String>) {
        let corrupted = || (None, Some(format!("`{CHECKSUMS_FILE}` is damaged")));
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
            return corrupted();
        };
        match (checksum::check(line), serde_json::from_slice(line)) {
            (LineIntegrity::Valid, Ok(checksums)) => (Some(checksums), None),
            _ => corrupted(),
        }
    }

    /// Returns whether there is a checksum of a file.
    pub fn knows(&self, name: &str) -> bool {
        self.entry(name).is_some()
    }

    fn entry(&self, name: &str) -> Option<&FileChecksum> {
        self.files.iter().find(|entry| entry.name == name)
    }

    /// Returns the names of the listed files that are directly in the folder.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let names = self.files.iter().map(|entry| entry.name.as_str());
        names.filter(|name| Path::new(name).file_name().is_some_and(|it| it == *name))
    }

    /// Returns a message about a corrupted file of the folder. Returns `None` if the file is valid
    /// or has no checksum. `grows` states whether a longer file is valid.
    pub fn damage(&self, folder: &Path, name: &str, grows: bool) -> Option<String> {
        let entry = self.entry(name)?;
        let found = open(&folder.join(name)).and_then(|file| {
            let length = file.metadata()?.len();
            Ok((length, sum_file(file, entry.bytes)?))
        });
        let shown = stochc_text::visible(name);
        match found {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Some(format!("`{shown}` is missing"))
            }
            Err(error) => Some(format!("cannot read `{shown}`: {error}")),
            Ok((length, _)) if length < entry.bytes => Some(format!(
                "`{shown}` is truncated: it has {length} bytes and had {}",
                entry.bytes
            )),
            Ok((length, sum))
                if format!("{:08x}", sum.crc32) != entry.crc32
                    || !grows && length > entry.bytes =>
            {
                Some(format!("`{shown}` was changed: its checksum differs"))
            }
            Ok(_) => None,
        }
    }
}
