//! `--memory`.
use clap::Args;

use crate::exit::Failure;

/// How much memory a command may take.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct MemoryOption {
    /// Take no more memory than this, such as 2GiB or 512MiB: fewer runs at the same time, or an end with status 2; what is
    /// finished is kept
    #[arg(id = "memory", long = "memory", value_name = "SIZE", value_parser = bytes)]
    pub limit: Option<u64>,
}

/// A number of bytes that somebody has typed.
fn bytes(text: &str) -> Result<u64, String> {
    let malformed = || "give a number and its unit: 512MiB, 2GiB".to_owned();
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit: u64 = match &text[digits.len()..] {
        "MiB" => 1 << 20,
        "GiB" => 1 << 30,
        "TiB" => 1 << 40,
        _ => return Err(malformed()),
    };
    let number: u64 = digits.trim_end().parse().map_err(|_| malformed())?;
    match number.checked_mul(unit) {
        None => Err("there is no such memory".to_owned()),
        Some(0) => Err("no memory is too little".to_owned()),
        Some(bytes) => Ok(bytes),
    }
}

impl MemoryOption {
    /// Has the system refuse the process any more than that.
    ///
    /// # Errors
    /// Where the system knows of no such limit.
    pub fn apply(self) -> Result<(), Failure> {
        let Some(limit) = self.limit else {
            return Ok(());
        };
        restrict(limit)
            .map_err(|reason| Failure::usage(format!("memory cannot be limited: {reason}")))
    }
}

/// What counts is what could be written to: address space alone, such as that of a program's code, is no memory.
#[cfg(target_os = "linux")]
fn restrict(limit: u64) -> Result<(), rustix::io::Errno> {
    use rustix::process::{Resource, getrlimit, setrlimit};
    let mut restricted = getrlimit(Resource::Data);
    let lower = |known: Option<u64>| known.map_or(limit, |known| known.min(limit));
    restricted.current = Some(lower(restricted.current));
    setrlimit(Resource::Data, restricted)
}

#[cfg(not(target_os = "linux"))]
fn restrict(_: u64) -> Result<(), &'static str> {
    Err("this system has no limit for it; use one of its own")
}
