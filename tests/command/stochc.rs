//! Calls of the command `stochc`, and their results.
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Result of a command: its status and output.
pub struct Outcome {
    /// Exit status of the command.
    pub status: i32,
    /// Text on standard output.
    pub out: String,
    /// Text on standard error.
    pub err: String,
}

/// Returns the command with these arguments, in the folder of the project, without starting it.
pub fn command<'a>(arguments: impl IntoIterator<Item = &'a str>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stochc"));
    command.args(arguments).stdin(Stdio::null());
    command
}

/// Runs `stochc` with the words of `line` as arguments, followed by `more`, which may contain
/// spaces.
pub fn stochc_with(line: &str, more: &[&str]) -> Outcome {
    let arguments = line.split_whitespace().chain(more.iter().copied());
    run_command(&mut command(arguments))
}

/// Runs `stochc` with the words of `line` as arguments.
pub fn stochc(line: &str) -> Outcome {
    stochc_with(line, &[])
}

/// Runs `stochc` with the words of `line` as arguments, and a text as standard input.
pub fn stochc_reading(line: &str, text: &str) -> Outcome {
    let mut command = command(line.split_whitespace());
    command.stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    // A command that does not read its input may have exited.
    let _ = input.write_all(text.as_bytes());
    drop(input);
    of(child.wait_with_output().unwrap())
}

/// Runs a command and returns its result.
pub fn run_command(command: &mut Command) -> Outcome {
    of(command.output().unwrap())
}

fn of(output: Output) -> Outcome {
    Outcome {
        status: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

impl Outcome {
    /// Returns the standard output, parsed as JSON.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).unwrap()
    }

    /// Returns the values in the row of the comparison whose label is `label`.
    pub fn row(&self, label: &str) -> Vec<&str> {
        let row = self.out.lines().find_map(|line| line.strip_prefix(label));
        row.unwrap().split_whitespace().collect()
    }
}

/// Returns a message with the folded lines of titles joined.
pub fn unfolded(message: &str) -> String {
    message.replace("\n  │ ", " ")
}

/// Returns the command line that splits an ensemble into shards instead of simulating it.
pub fn shard_new(line: &str) -> String {
    let (_, options) = line.split_once(' ').unwrap();
    format!("shard new {options}")
}

/// Returns the path of a file below a folder, as an argument.
pub fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().unwrap().to_owned()
}

/// Returns whether a JSON value contains all fields of another one.
pub fn contains(whole: &serde_json::Value, part: &serde_json::Value) -> bool {
    use serde_json::Value::{Array, Object};
    match (whole, part) {
        (Object(whole), Object(part)) => {
            let mut fields = part.iter();
            fields.all(|(name, part)| whole.get(name).is_some_and(|it| contains(it, part)))
        }
        (Array(whole), Array(part)) => {
            let mut pairs = whole.iter().zip(part);
            whole.len() == part.len() && pairs.all(|(whole, part)| contains(whole, part))
        }
        _ => whole == part,
    }
}

/// Returns the bytes of all tables in a results folder.
pub fn tables(folder: &str) -> Vec<Vec<u8>> {
    let names = stochc::results::tables().into_iter();
    let files = names.map(|table| Path::new(folder).join(format!("{}.parquet", table.name)));
    files.map(|file| std::fs::read(file).unwrap()).collect()
}
