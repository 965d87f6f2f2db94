//! A compiled program as a value, and as a file.
use std::fmt;
use std::io::{self, Write};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::graph::EventGraph;
use crate::scene::Scene;
use crate::strict_json::{StrictJsonError, strict_json};
use crate::table::Tables;

/// Version of the file format of executables; another one is not read.
pub const FORMAT: u32 = 1;

/// What the file says that it is.
const KIND: &str = "stochc executable";

/// All that is needed to run a program and to tell of its runs: neither text nor grammar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Executable {
    /// What every block knows, and the names of blocks and phases.
    pub tables: Tables,
    /// The world it runs in.
    pub scene: Scene,
    /// What waits for what.
    pub graph: EventGraph,
    /// Reasons why blocks may jam. The rate model leaves them out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub jam_risks: Vec<JamRisk>,
}

/// A reason why blocks may jam: the code of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JamRisk {
    /// A block comes in through a gap one block wide.
    TightApproach,
    /// Faces near each other attract blocks at the same time.
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

/// Why a file is no executable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExecutableError {
    /// It is something else.
    OtherFile,
    /// It has another [`FORMAT`].
    OtherFormat(u32),
    /// What is damaged, in words.
    Damaged(String),
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
    /// SHA-256, in hexadecimal, of all that decides what a run does; not of the graph, which follows from the tables.
    pub fn identity(&self) -> String {
        sha256(&(&self.tables, &self.scene))
    }

    /// Whether everything in it stands for something: it may have been read from a file.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn validate(&self) -> Result<(), String> {
        self.scene.validate()?;
        self.tables.validate_in(&self.scene)?;
        self.graph.validate(&self.tables)
    }

    /// Writes executables as a file.
    ///
    /// # Errors
    /// When `out` takes no more.
    pub fn write_all(programs: &[Executable], mut out: impl Write) -> io::Result<()> {
        let file = ExecutableFile {
            kind: KIND,
            format: FORMAT,
            programs,
        };
        serde_json::to_writer(&mut out, &file)?;
        writeln!(out)
    }

    /// Whether a file looks like one of executables, however its JSON is laid out.
    pub fn is_file(bytes: &[u8]) -> bool {
        let begin = format!("{{\"kind\":\"{KIND}\"");
        let is_sign = |byte: &u8| !byte.is_ascii_whitespace();
        let mut signs = bytes.iter().copied().filter(is_sign);
        let mut wanted = begin.bytes().filter(is_sign);
        wanted.all(|sign| signs.next() == Some(sign))
    }

    /// Reads the executables of a file, and validates them.
    ///
    /// # Errors
    /// When it is no such file, one of another format, or damaged.
    pub fn read_all(bytes: &[u8]) -> Result<Vec<Executable>, ExecutableError> {
        let head: Head = serde_json::from_slice(bytes).map_err(|error| {
            if Executable::is_file(bytes) {
                ExecutableError::Damaged(error.to_string())
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
        let damaged = |error: StrictJsonError| ExecutableError::Damaged(error.to_string());
        let file: StoredFile = strict_json(bytes).map_err(damaged)?;
        for program in &file.programs {
            program.validate().map_err(ExecutableError::Damaged)?;
        }
        Ok(file.programs)
    }
}

/// SHA-256 of a value as JSON, in hexadecimal.
pub fn sha256(value: &impl Serialize) -> String {
    use fmt::Write as _;

    let mut digest = Digester(Sha256::new());
    serde_json::to_writer(&mut digest, value).expect("plain data, and a digest takes everything");
    let mut hexadecimal = String::with_capacity(64);
    for byte in digest.0.finalize() {
        write!(hexadecimal, "{byte:02x}").expect("a string takes everything");
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

impl fmt::Display for ExecutableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ExecutableError::OtherFile => f.write_str("it is no executable of stochc"),
            ExecutableError::OtherFormat(format) => {
                write!(
                    f,
                    "its format is {format}, and this is {FORMAT}; compile its program again"
                )
            }
            ExecutableError::Damaged(what) => write!(f, "it is damaged: {what}"),
        }
    }
}

impl std::error::Error for ExecutableError {}
