//! `stochc fmt`.
use std::path::Path;

use clap::Args;
use similar::TextDiff;
use stochc_compiler::diagnostic::{Diagnostic, Renderer};
use stochc_compiler::{Sources, lone_returns};
use stochc_files::atomic::replace_text;
use stochc_files::programs::{STDIN_NAME, programs, read};
use stochc_grammar::{BYTE_ORDER_MARK, FormatError, format};
use stochc_text::visible;

use super::terminal::{exit_of, has_colour, message_width, print};
use crate::exit::{Exit, Failure};
use crate::operations::programs::cannot_read;

/// Arguments of `fmt`.
#[derive(Debug, Args)]
pub struct FmtArguments {
    /// Programs to format, or folders that contain programs (`*.sa`). `-` formats the standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,
    /// Show the changes without writing them. The exit status is 1 if there are changes
    #[arg(long)]
    check: bool,
}

/// Formats each file. A file with syntax errors is not changed.
pub fn run(options: &FmtArguments) -> Result<Exit, Failure> {
    let mut exit = Exit::Success;
    for file in programs(&options.files) {
        let done = file.map_err(Failure::usage);
        let done = done.and_then(|file| one(&file, options.check));
        exit = exit.or_worse(exit_of(done));
    }
    Ok(exit)
}

fn one(file: &str, check: bool) -> Result<Exit, Failure> {
    let text = match read(file).map(String::from_utf8) {
        Ok(Ok(text)) => text,
        Ok(Err(_)) => {
            return Err(Failure::invalid_program(format!(
                "`{file}` is not UTF-8 text"
            )));
        }
        Err(reason) => return Err(cannot_read(file, reason)),
    };
    let bare = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&text);
    let mut sources = Sources::default();
    let id = sources.add(file, bare);
    let wrong = match (lone_returns(id, bare), format(bare)) {
        (Some(returns), _) => vec![returns],
        (None, Ok(laid_out)) => return write(file, &text, &laid_out, check),
        (None, Err(FormatError::Wrong(errors))) => {
            let errors = errors.iter();
            let errors = errors.map(|error| Diagnostic::from_syntax(id, error, bare));
            errors.collect()
        }
        (None, Err(_)) => {
            return Err(Failure::usage(format!(
                "the layout of `{file}` would change its meaning, so it was left as it is. \
                 This is a mistake of stochc; please report it with the file"
            )));
        }
    };
    let renderer = Renderer::new(has_colour(), message_width());
    let drawn = wrong.iter().map(|it| renderer.render(it, &sources) + "\n");
    Err(Failure {
        exit: Exit::InvalidProgram,
        message: drawn.collect(),
    })
}

/// Writes the formatted source to a file. With `check`, only reports that the source differs.
fn write(file: &str, text: &str, laid_out: &str, check: bool) -> Result<Exit, Failure> {
    if check {
        return compare(file, text, laid_out);
    }
    if file == STDIN_NAME {
        print(laid_out)?;
    } else if laid_out != text {
        let path = Path::new(file);
        let replaced = replace_text(path, text.as_bytes(), laid_out.as_bytes());
        if !replaced.map_err(|error| Failure::not_written(path, error))? {
            let reason = "it has changed while it was laid out; try again";
            return Err(Failure::not_written(path, reason));
        }
    }
    Ok(Exit::Success)
}

fn compare(file: &str, text: &str, laid_out: &str) -> Result<Exit, Failure> {
    if laid_out == text {
        return Ok(Exit::Success);
    }
    let diff = TextDiff::from_lines(text, laid_out);
    let mut diff = diff.unified_diff();
    let file = visible(file);
    print(&diff.header(&file, &format!("{file} laid out")).to_string())?;
    Ok(Exit::InvalidProgram)
}
