//! Which programs the arguments of a command stand for.
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;
use std::sync::OnceLock;

use stochc_ir::Executable;

use super::budget::{EXECUTABLE, PROGRAM};

/// The argument that stands for the standard input.
pub const STDIN: &str = "-";

/// What messages call the standard input.
pub const STDIN_NAME: &str = "<stdin>";

/// An argument that stands for no program, and why, in a message.
pub type Unusable = String;

/// The programs that arguments stand for, each once: files themselves, the programs (`*.sa`) of
/// folders and those below them, and [`STDIN_NAME`] for [`STDIN`].
pub fn programs(arguments: &[String]) -> Vec<Result<String, Unusable>> {
    let mut seen = BTreeSet::new();
    let mut programs = Vec::new();
    for argument in arguments {
        let found = match argument.as_str() {
            STDIN => Ok(BTreeSet::from([STDIN_NAME.to_owned()])),
            path if Path::new(path).is_dir() => in_folder(path),
            path => Ok(BTreeSet::from([path.to_owned()])),
        };
        match found {
            Ok(found) if found.is_empty() => {
                programs.push(Err(format!("`{argument}` holds no program (`*.sa`)")));
            }
            Ok(found) => programs.extend(found.into_iter().filter_map(|program| {
                let is_new = seen.insert(program.clone());
                is_new.then_some(Ok(program))
            })),
            Err(reason) => programs.push(Err(format!("cannot read `{argument}`: {reason}"))),
        }
    }
    programs
}

fn in_folder(path: &str) -> Result<BTreeSet<String>, String> {
    let mut programs = BTreeSet::new();
    let mut folders = vec![path.to_owned()];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).map_err(|error| format!("{folder}: {error}"))?;
        for entry in entries {
            let entry = entry.map_err(|error| error.to_string())?;
            let kind = entry.file_type().map_err(|error| error.to_string())?;
            let name = entry.file_name();
            // A folder that is hidden or elsewhere was not meant.
            let Some(name) = name.to_str().filter(|name| !name.starts_with('.')) else {
                continue;
            };
            let path = match folder.as_str() {
                "." => name.to_owned(),
                folder => format!("{}/{name}", folder.trim_end_matches('/')),
            };
            if kind.is_dir() {
                folders.push(path);
            } else if kind.is_file() && name.ends_with(".sa") {
                programs.insert(path);
            }
        }
    }
    Ok(programs)
}

/// The bytes of one of the [`programs`]; those of the standard input are kept, since they come once.
///
/// # Errors
///
/// In the system's words, or those of [`super::read`], and of a file of compiled programs.
pub fn read(program: &str) -> Result<Vec<u8>, String> {
    static INPUT: OnceLock<Result<Vec<u8>, String>> = OnceLock::new();
    let all =
        || super::read_stream(std::io::stdin().lock(), PROGRAM).map_err(|error| error.to_string());
    let text = match program {
        STDIN_NAME => INPUT.get_or_init(all).clone(),
        file => super::read(file),
    }?;
    match Executable::is_file(&text) {
        true => Err("it is compiled already: name the file of its text".to_owned()),
        false => Ok(text),
    }
}

/// Whether a file looks like one of compiled programs.
///
/// # Errors
/// Those of the file system.
pub fn is_executable(file: &mut File) -> io::Result<bool> {
    /// Enough to tell.
    const HEAD: u64 = 64;
    let mut head = Vec::new();
    file.take(HEAD).read_to_end(&mut head)?;
    Ok(Executable::is_file(&head))
}

/// The compiled programs of a file; `None`: it does not look like one of those.
pub fn executables(path: &str) -> Option<Result<Vec<Executable>, String>> {
    let mut file = super::open(Path::new(path)).ok()?;
    is_executable(file.as_plain()).ok()?.then(|| {
        let bytes = super::read_file(Path::new(path), EXECUTABLE);
        let bytes = bytes.map_err(|error| error.to_string())?;
        Executable::read_all(&bytes).map_err(|error| error.to_string())
    })
}

/// Why an argument cannot be had by a command that takes nothing but files.
pub fn not_a_file(argument: &str) -> Option<String> {
    let what = match argument {
        STDIN => "the standard input",
        path if Path::new(path).is_dir() => "a folder",
        _ => return None,
    };
    Some(format!(
        "`{argument}` is {what}: name the file of a program; only `check` and `fmt` take folders and `-`"
    ))
}
