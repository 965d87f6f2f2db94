//! Compiled program as a value and as a file.
use std::io::{self, Write};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error;

use crate::graph::{EventGraph, InvalidGraph};
use crate::json::strict::{StrictJsonError, strict_json};
use crate::scene::{InvalidScene, Scene};
use crate::table::{InvalidTables, Tables};

/// Version of the file format. No other version is read.
pub const FORMAT: u32 = 1;

/// Kind of the file.
const KIND: &str = "stochc executable";

/// Everything needed to run a program and to report its runs, without source or grammar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Executable {
    /// Rules of every block, and the names of blocks and phases.
    pub tables: Tables,
    /// Scene of the program.
    pub scene: Scene,
    /// Dependencies between events.
    pub graph: EventGraph,
    /// Risks of jamming, which the rate model does not include.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub jam_risks: Vec<JamRisk>,
}

/// Risk of jamming. Each risk has the code of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JamRisk {
    /// A block must enter through a gap one block wide.
    TightApproach,
    /// Nearby faces are open at the same time.
    CrowdedCaptures,
}

impl JamRisk {
    /// Returns the code of the warning.
    pub const fn code(self) -> &'static str {
        match self {
            JamRisk::TightApproach => "tight-approach",
            JamRisk::CrowdedCaptures => "crowded-captures",
        }
    }
}

/// Reason why a file is not an executable.
#[derive(Debug, Error)]
pub enum ExecutableError {
    /// The file has another kind.
    #[error("it is no executable of stochc")]
    OtherFile,
    /// The file has another [`FORMAT`].
    #[error("its format is {0}, and this is {FORMAT}; compile its program again")]
    OtherFormat(u32),
    /// The file is not valid JSON of an executable.
    #[error("it is damaged: {0}")]
    Corrupted(#[from] StrictJsonError),
    /// A program of the file is invalid.
    #[error("it is damaged: {0}")]
    Invalid(#[from] InvalidExecutable),
}

/// Reason why a program from a file is invalid.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum InvalidExecutable {
    /// The scene is invalid.
    #[error(transparent)]
    Scene(#[from] InvalidScene),
    /// The event tables are invalid.
    #[error(transparent)]
    Tables(#[from] InvalidTables),
    /// The dependency graph is invalid.
    #[error(transparent)]
    Graph(#[from] InvalidGraph),
}

#[derive(Deserialize)]
struct Head {
    kind: String,
    format: u32,
}

#[derive(Serialize)]
struct ExecutableFile<'a> {
    kind: &'a str,
    format: u32,
    programs: &'a [Executable],
}

#[derive(Deserialize)]
struct StoredFile {
    #[serde(rename = "kind")]
    _kind: String,
    #[serde(rename = "format")]
    _format: u32,
    programs: Vec<Executable>,
}

impl Executable {
    /// Returns the SHA-256, in hexadecimal, of everything that determines a run. The graph follows
    /// from the tables and is excluded.
    pub fn identity(&self) -> String {
        sha256(&(&self.tables, &self.scene))
    }

    /// Validates the program, which may come from a file.
    ///
    /// # Errors
    ///
    /// If a part of it is invalid.
    pub fn validate(&self) -> Result<(), InvalidExecutable> {
        self.scene.validate()?;
        self.tables.validate_in(&self.scene)?;
        Ok(self.graph.validate(&self.tables)?)
    }

    /// Writes executables as a file.
    ///
    /// # Errors
    ///
    /// Errors of `out`.
    pub fn write_all(programs: &[Executable], mut out: impl Write) -> io::Result<()> {
        let file = ExecutableFile {
            kind: KIND,
            format: FORMAT,
            programs,
        };
        serde_json::to_writer(&mut out, &file)?;
        writeln!(out)
    }

    /// Returns whether a file looks like executables, for any layout of its JSON.
    pub fn is_file(bytes: &[u8]) -> bool {
        let begin = format!("{{\"kind\":\"{KIND}\"");
        let is_sign = |byte: &u8| !byte.is_ascii_whitespace();
        let mut signs = bytes.iter().copied().filter(is_sign);
        let mut expected = begin.bytes().filter(is_sign);
        expected.all(|sign| signs.next() == Some(sign))
    }

    /// Reads and validates the executables of a file.
    ///
    /// # Errors
    ///
    /// If the file has another kind or format, or is corrupted.
    pub fn read_all(bytes: &[u8]) -> Result<Vec<Executable>, ExecutableError> {
        let head: Head = serde_json::from_slice(bytes).map_err(|error| {
            if Executable::is_file(bytes) {
                StrictJsonError::Corrupted(error).into()
            } else {
                ExecutableError::OtherFile
            }
        })?;
        if head.kind != KIND {
            return Err(ExecutableError::OtherFile);
        }
        if head.format != FORMAT {
            return Err(ExecutableError::OtherFormat(head.format));
        }
        let file: StoredFile = strict_json(bytes)?;
        for program in &file.programs {
            program.validate()?;
        }
        Ok(file.programs)
    }
}

/// Returns the SHA-256 of a value as JSON, in hexadecimal.
pub fn sha256(value: &impl Serialize) -> String {
    use std::fmt::Write as _;

    let mut digest = Digester(Sha256::new());
    serde_json::to_writer(&mut digest, value).expect("plain data can be serialized to a digest");
    let mut hexadecimal = String::with_capacity(64);
    for byte in digest.0.finalize() {
        write!(hexadecimal, "{byte:02x}").expect("writing to a string cannot fail");
    }
    hexadecimal
}

struct Digester(Sha256);

impl Write for Digester {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
