//! Writing to the terminal, or to whatever stands in its place.
use std::io::{self, BufWriter, ErrorKind, IsTerminal as _, Write};

use console::Term;

use crate::exit::{Exit, Failure};

/// Prints; a reader that has gone away, such as `head`, changes nothing, and any other reason why nothing can be
/// written, such as a full disk, ends the command with a word.
pub fn print(text: &str) -> Result<(), Failure> {
    print_with(|out| out.write_all(text.as_bytes()))
}

/// [`print`]s what is written to a stream, as it comes.
pub fn print_with(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    let written = write(&mut out).and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::usage(format!("cannot write the output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Says something about the work on standard error; nobody listening is no reason to stop.
pub fn warn(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Says why a part of the work failed, where the rest of it goes on; how that part ended.
pub fn told(done: Result<Exit, Failure>) -> Exit {
    done.unwrap_or_else(|failure| {
        warn(&failure.message);
        failure.exit
    })
}

/// Whether standard error shows colours.
pub fn has_colour() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

/// Whether the output shows colours.
pub fn output_has_colour() -> bool {
    std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

/// Whether somebody looks at the output, now.
pub fn output_is_watched() -> bool {
    std::io::stdout().is_terminal()
}

/// Columns of the output: those of the terminal, or [`WIDTH`] where it is none.
pub fn output_width() -> usize {
    columns(&Term::stdout()).unwrap_or(WIDTH)
}

/// Columns for messages: those of the terminal, but no more than are easy to read.
pub fn message_width() -> usize {
    columns(&Term::stderr()).map_or(WIDTH, |columns| columns.min(WIDTH))
}

/// Columns where nobody says how many there are.
const WIDTH: usize = 100;

fn columns(terminal: &Term) -> Option<usize> {
    /// With fewer than this, a break by the terminal itself is easier to read.
    const LEAST: usize = 40;
    let (_, columns) = terminal.size_checked()?;
    Some(usize::from(columns).max(LEAST))
}
