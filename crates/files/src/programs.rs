//! Programs named by command-line arguments.
use std::collections::BTreeSet;
use std::fmt::Display;
use std::fs::{DirEntry, File};
use std::io::{self, Read as _};
use std::path::Path;
use std::sync::OnceLock;

use stochc_ir::{Executable, ExecutableError};
use thiserror::Error;

use super::bound::identity;
use super::budget::{EXECUTABLE, PROGRAM};

/// Argument for the standard input.
pub const STDIN: &str = "-";

/// Name of the standard input in messages.
pub const STDIN_NAME: &str = "<stdin>";

/// Reason why an argument cannot be used as a program.
#[derive(Debug, Error)]
pub enum Unusable {
    /// A folder without programs.
    #[error("`{0}` contains no program (`*.sa`)")]
    NoProgram(String),
    /// A file or folder that cannot be read.
    #[error("cannot read {path}: {reason}")]
    Unreadable {
        /// Path of the file or folder.
        path: String,
        /// Reason.
        reason: String,
    },
}

/// Reason why a file of compiled programs cannot be used.
#[derive(Debug, Error)]
pub enum UnusableExecutable {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file is invalid.
    #[error(transparent)]
    Invalid(#[from] ExecutableError),
}

/// Returns the programs named by arguments, each once: files, programs (`*.sa`) in folders and
/// subfolders, and [`STDIN_NAME`] for [`STDIN`].
pub fn programs(arguments: &[String]) -> Vec<Result<String, Unusable>> {
    let mut seen = BTreeSet::new();
    let mut programs = Vec::new();
    for argument in arguments {
        let found = match argument.as_str() {
            STDIN => vec![Ok(STDIN_NAME.to_owned())],
            path if Path::new(path).is_dir() => in_folder(path),
            path => vec![Ok(path.to_owned())],
        };
        if found.is_empty() {
            programs.push(Err(Unusable::NoProgram(argument.clone())));
        }
        programs.extend(found.into_iter().filter(|program| match program {
            Ok(program) => seen.insert(program.clone()),
            Err(_) => true,
        }));
    }
    programs
}

/// Returns the programs of a folder and its subfolders, sorted. Errors come first.
///
/// Links are followed, and each file and folder is visited once. Hidden entries are skipped.
fn in_folder(path: &str) -> Vec<Result<String, Unusable>> {
    let mut found = FolderPrograms::default();
    found.folders.push(path.to_owned());
    let mut visited = BTreeSet::new();
    while let Some(folder) = found.next_folder() {
        if identity(&folder).is_some_and(|folder| !visited.insert(folder)) {
            continue;
        }
        match std::fs::read_dir(&folder) {
            Ok(entries) => entries.for_each(|entry| found.add(&folder, entry)),
            Err(error) => found.cannot_read(&folder, error),
        }
    }
    found.into_list()
}

/// Entries found in folders so far.
#[derive(Default)]
struct FolderPrograms {
    folders: Vec<String>,
    linked_folders: BTreeSet<String>,
    programs: BTreeSet<String>,
    linked_programs: BTreeSet<String>,
    unusable: Vec<Unusable>,
}

impl FolderPrograms {
    /// Returns the next folder to read. Links come last. Returns `None` after the last folder.
    fn next_folder(&mut self) -> Option<String> {
        self.folders
            .pop()
            .or_else(|| self.linked_folders.pop_first())
    }

    fn add(&mut self, folder: &str, entry: io::Result<DirEntry>) {
        let entry = match entry {
            Ok(entry) => entry,
            Err(error) => return self.cannot_read(folder, error),
        };
        let name = entry.file_name();
        let shown = name.to_string_lossy();
        let is_folder = entry.path().is_dir();
        if shown.starts_with('.') || !(is_folder || shown.ends_with(".sa")) {
            return;
        }
        let path = match folder {
            "." => shown.to_string(),
            folder => format!("{}/{shown}", folder.trim_end_matches('/')),
        };
        if name.to_str().is_none() {
            return self.cannot_read(&path, "its name is not UTF-8");
        }
        let is_link = entry.path().is_symlink();
        if is_folder && !is_link {
            self.folders.push(path);
            return;
        }
        let list = match (is_folder, is_link) {
            (true, _) => &mut self.linked_folders,
            (false, false) => &mut self.programs,
            (false, true) => &mut self.linked_programs,
        };
        list.insert(path);
    }

    fn cannot_read(&mut self, path: &str, reason: impl Display) {
        self.unusable.push(Unusable::Unreadable {
            path: path.to_owned(),
            reason: reason.to_string(),
        });
    }

    /// Returns all results, with each file once.
    fn into_list(self) -> Vec<Result<String, Unusable>> {
        let mut listed = BTreeSet::new();
        let all = self.programs.into_iter().chain(self.linked_programs);
        let mut programs: Vec<String> = all
            .filter(|path| identity(path).is_none_or(|file| listed.insert(file)))
            .collect();
        programs.sort_unstable();
        let unusable = self.unusable.into_iter().map(Err);
        unusable.chain(programs.into_iter().map(Ok)).collect()
    }
}

/// Returns the bytes of one of the [`programs`]. The standard input is read once and kept.
///
/// # Errors
///
/// The errors of [`super::read`]. A file of compiled programs is also an error.
pub fn read(program: &str) -> io::Result<Vec<u8>> {
    static INPUT: OnceLock<io::Result<Vec<u8>>> = OnceLock::new();
    let text = match program {
        STDIN_NAME => {
            let all = || super::read_stream(std::io::stdin().lock(), PROGRAM);
            let input = INPUT.get_or_init(all).as_ref();
            let again = |error: &io::Error| io::Error::new(error.kind(), error.to_string());
            input.map_err(again)?.clone()
        }
        file => super::read(file)?,
    };
    if Executable::is_file(&text) {
        return Err(io::Error::other(
            "it is already compiled; name its source file",
        ));
    }
    Ok(text)
}

/// Returns whether a file looks like compiled programs.
///
/// # Errors
///
/// Errors of the file system.
pub fn is_executable(file: &mut File) -> io::Result<bool> {
    /// Number of bytes examined.
    const HEAD: u64 = 64;
    let mut head = Vec::new();
    file.take(HEAD).read_to_end(&mut head)?;
    Ok(Executable::is_file(&head))
}

/// Returns the compiled programs of a file. Returns `None` if the file does not look like compiled
/// programs.
pub fn executables(path: &str) -> Option<Result<Vec<Executable>, UnusableExecutable>> {
    let mut file = super::open(Path::new(path)).ok()?;
    is_executable(file.as_plain()).ok()?.then(|| {
        let bytes = super::read_file(Path::new(path), EXECUTABLE)?;
        Ok(Executable::read_all(&bytes)?)
    })
}

/// Returns a message about an argument that is not a file, for commands that accept only files.
/// Returns `None` if the argument is a file.
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
