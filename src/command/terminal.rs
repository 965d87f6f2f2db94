//! Writing to the terminal, or to whatever stands in its place.
use std::io::{IsTerminal as _, Write as _};

/// Prints; a reader that has gone away, such as `head`, ends the command quietly.
pub fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    if out
        .write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .is_err()
    {
        std::process::exit(0);
    }
}

/// Says something about the work on standard error; nobody listening is no reason to stop.
pub fn warn(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Whether standard error shows colours.
pub fn has_colour() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

/// Columns for messages.
pub const WIDTH: usize = 100;
