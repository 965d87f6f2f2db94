//! `stochc fmt`.
use std::collections::BTreeSet;
use std::io::Read as _;
use std::path::Path;

use clap::Args;
use similar::TextDiff;
use stochc_compiler::Sources;
use stochc_compiler::finding::{Finding, Renderer};
use stochc_grammar::{Refusal, format};

use super::terminal::{has_colour, message_width, print, warn};
use crate::cli::Exit;
use crate::files;

/// What `fmt` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// Programs, or folders with programs (`*.sa`) in them; `-` formats standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,
    /// Show what would change without writing it; exit with status 1 if anything would
    #[arg(long)]
    check: bool,
}

/// The name of the standard input.
const STDIN: &str = "-";

/// Lays out each file; one that is no program is left as it is.
pub fn run(options: &Options) -> Exit {
    let mut exit = Exit::Success;
    for file in &options.files {
        let found = if file == STDIN {
            Ok(BTreeSet::from([STDIN.to_owned()]))
        } else {
            programs(file)
        };
        let done = match found {
            Ok(files) => files.iter().map(|file| one(file, options.check)).collect(),
            Err(reason) => vec![unusable(file, &reason)],
        };
        for done in done {
            if done.status() > exit.status() {
                exit = done;
            }
        }
    }
    exit
}

/// A file itself, or the programs in a folder and those below it.
fn programs(path: &str) -> Result<BTreeSet<String>, String> {
    let mut programs = BTreeSet::new();
    let mut folders = Vec::new();
    match Path::new(path).is_dir() {
        true => folders.push(path.to_owned()),
        false => {
            programs.insert(path.to_owned());
        }
    }
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
            let path = format!("{}/{name}", folder.trim_end_matches('/'));
            if kind.is_dir() {
                folders.push(path);
            } else if kind.is_file() && name.ends_with(".sa") {
                programs.insert(path);
            }
        }
    }
    Ok(programs)
}

fn one(file: &str, check: bool) -> Exit {
    let text = match read(file) {
        Ok(Ok(text)) => text,
        Ok(Err(_)) => {
            warn(&format!("error: `{file}` is not UTF-8 text\n"));
            return Exit::WrongProgram;
        }
        Err(reason) => return unusable(file, &reason),
    };
    // The mark of the byte order says nothing in UTF-8, and is dropped.
    let bare = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let laid_out = match format(bare) {
        Ok(laid_out) => laid_out,
        Err(refusal) => return refused(file, bare, refusal),
    };
    if check {
        return compare(file, &text, &laid_out);
    }
    if file == STDIN {
        print(&laid_out);
    } else if laid_out != text
        && let Err(error) = files::replace(Path::new(file), laid_out.as_bytes())
    {
        warn(&format!("error: cannot write `{file}`: {error}\n"));
        return Exit::Usage;
    }
    Exit::Success
}

fn read(file: &str) -> Result<Result<String, std::string::FromUtf8Error>, String> {
    if file != STDIN {
        return files::read(file).map(String::from_utf8);
    }
    let mut bytes = Vec::new();
    match std::io::stdin().lock().read_to_end(&mut bytes) {
        Ok(_) => Ok(String::from_utf8(bytes)),
        Err(error) => Err(error.to_string()),
    }
}

fn unusable(file: &str, reason: &str) -> Exit {
    warn(&format!("error: cannot read `{file}`: {reason}\n"));
    Exit::Usage
}

fn refused(file: &str, text: &str, refusal: Refusal) -> Exit {
    let Refusal::Wrong(errors) = refusal else {
        warn(&format!(
            "error: the layout of `{file}` would change its meaning, so it was left as it is; \
             this is a mistake of stochc: please report it with the file\n"
        ));
        return Exit::Usage;
    };
    let mut sources = Sources::default();
    let id = sources.add(file, text);
    let renderer = Renderer::new(has_colour(), message_width());
    for error in &errors {
        let finding = Finding::from_syntax(id, error, text);
        warn(&format!("{}\n", renderer.render(&finding, &sources)));
    }
    Exit::WrongProgram
}

fn compare(file: &str, text: &str, laid_out: &str) -> Exit {
    if laid_out == text {
        return Exit::Success;
    }
    let diff = TextDiff::from_lines(text, laid_out);
    let mut diff = diff.unified_diff();
    print(&diff.header(file, &format!("{file} laid out")).to_string());
    Exit::WrongProgram
}
