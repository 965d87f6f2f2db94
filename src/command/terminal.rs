//! Output to standard output and standard error.
use std::io::{self, BufWriter, ErrorKind, IsTerminal as _, Write};
use std::path::Path;
use std::sync::{Mutex, OnceLock, PoisonError};

use clap::ValueEnum;
use console::Term;
use stochc_files::shell::file as shell_file;
use stochc_text::{visible, visible_lines};

use crate::exit::{Exit, Failure};

/// Global options about the terminal.
#[derive(Clone, Copy, Debug, Default)]
pub struct TerminalOptions {
    /// Whether to omit progress, notes and warnings.
    pub is_quiet: bool,
    /// Rule for using colours.
    pub color: Color,
}

/// When to use colors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Color {
    /// On terminals, unless `NO_COLOR` is set
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

static OPTIONS: OnceLock<TerminalOptions> = OnceLock::new();

/// Sets the global terminal options. Must be called once, at the start.
pub fn configure(options: TerminalOptions) {
    let _ = OPTIONS.set(options);
}

fn options() -> TerminalOptions {
    OPTIONS.get().copied().unwrap_or_default()
}

pub fn is_quiet() -> bool {
    options().is_quiet
}

/// Prints a text to standard output. On a terminal, escapes invisible characters. A closed pipe,
/// such as to `head`, is not an error.
///
/// # Errors
/// If the output cannot be written for another reason, such as a full disk.
pub fn print(text: &str) -> Result<(), Failure> {
    print_with(|out| out.write_all(text.as_bytes()))
}

/// Prints lines as [`print`] does, folded to the width of the terminal.
pub fn print_folded(text: &str) -> Result<(), Failure> {
    match columns(&Term::stdout()) {
        Some(width) => print(&folded(text, width)),
        None => print(text),
    }
}

/// Breaks lines that are wider than `width` at spaces. Continuation lines are indented by four
/// additional columns.
fn folded(text: &str, width: usize) -> String {
    let mut out = String::new();
    for line in text.lines() {
        let indent = line.chars().take_while(|&it| it == ' ').count();
        let rest_indent = (indent + 4).min(width / 2);
        let mut left: Vec<char> = line.chars().collect();
        while left.len() > width {
            let start = left.iter().take_while(|&&it| it == ' ').count();
            let words = left.get(start..=width).unwrap_or_default();
            let space = words.iter().rposition(|&it| it == ' ');
            let Some(space) = space.filter(|&space| space > 0) else {
                break;
            };
            let rest = left.split_off(start + space);
            out.extend(left);
            out.push('\n');
            left = vec![' '; rest_indent];
            left.extend(rest.into_iter().skip(1));
        }
        out.extend(left);
        out.push('\n');
    }
    out
}

/// Prints the output of `write` while it is being written, as [`print`] does.
pub fn print_with(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    if output_is_watched() {
        print_to(VisibleWriter::new(io::stdout().lock()), write)
    } else {
        print_to(io::stdout().lock(), write)
    }
}

/// Prints a text that contains the colours of stochc. All names in the text must already be
/// escaped.
pub fn print_drawn(text: &str) -> Result<(), Failure> {
    print_to(io::stdout().lock(), |out| out.write_all(text.as_bytes()))
}

fn print_to(
    out: impl Write,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    show_deferred();
    let mut out = BufWriter::with_capacity(1 << 16, out);
    let written = write(&mut out).and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::usage(format!("cannot write the output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writer that escapes invisible characters in UTF-8 text, as [`visible_lines`] does.
struct VisibleWriter<W> {
    out: W,
    /// First bytes of a character whose other bytes have not been written yet.
    begun: Vec<u8>,
}

impl<W: Write> VisibleWriter<W> {
    fn new(out: W) -> VisibleWriter<W> {
        let begun = Vec::new();
        VisibleWriter { out, begun }
    }
}

impl<W: Write> Write for VisibleWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.begun.extend_from_slice(bytes);
        let whole = match std::str::from_utf8(&self.begun) {
            // Invalid bytes are passed on and then escaped.
            Err(error) if error.error_len().is_none() => error.valid_up_to(),
            _ => self.begun.len(),
        };
        let rest = self.begun.split_off(whole);
        let text = std::mem::replace(&mut self.begun, rest);
        let text = visible_lines(&String::from_utf8_lossy(&text));
        self.out.write_all(text.as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Prints a message to standard error. Escapes invisible characters and ignores errors of writing.
pub fn warn(text: &str) {
    warn_drawn(&visible_lines(text));
}

/// Prints a note, the location of results or the next commands, unless the command is quiet.
pub fn close(text: &str) {
    if !is_quiet() {
        warn(text);
    }
}

/// Returns a path, quoted as an argument of a command line.
pub fn argument(path: &Path) -> String {
    shell_file(&visible(&path.to_string_lossy()))
}

/// Prints a message that contains the colours of stochc to standard error. All names in the message
/// must already be escaped.
pub fn warn_drawn(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Delayed warnings. They are printed when work starts or the command ends.
static DEFERRED: Mutex<String> = Mutex::new(String::new());

/// Delays a warning until work starts or the command ends, so that errors are printed first.
pub fn defer(text: &str) {
    let mut deferred = DEFERRED.lock().unwrap_or_else(PoisonError::into_inner);
    deferred.push_str(text);
}

/// Prints the delayed warnings.
pub fn show_deferred() {
    let mut deferred = DEFERRED.lock().unwrap_or_else(PoisonError::into_inner);
    warn_drawn(&std::mem::take(&mut *deferred));
}

/// Prints the failure of one part of the work. Returns the part's exit status, so that the caller
/// can continue with other parts.
pub fn exit_of(done: Result<Exit, Failure>) -> Exit {
    done.unwrap_or_else(|failure| {
        warn_drawn(&failure.message);
        failure.exit
    })
}

/// Returns whether messages on standard error have colours.
pub fn has_colour() -> bool {
    uses_colour(std::io::stderr().is_terminal())
}

pub fn output_has_colour() -> bool {
    uses_colour(std::io::stdout().is_terminal())
}

fn uses_colour(is_terminal: bool) -> bool {
    match options().color {
        Color::Auto => is_terminal && wants_colour(),
        Color::Always => true,
        Color::Never => false,
    }
}

/// Returns whether the environment permits colours: `NO_COLOR` is unset and the terminal supports
/// colours.
fn wants_colour() -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty()) && !is_dumb()
}

/// Returns whether the terminal does not support control sequences.
pub fn is_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|name| name == "dumb")
}

/// Returns whether standard output is a terminal.
pub fn output_is_watched() -> bool {
    std::io::stdout().is_terminal()
}

/// Returns the width of standard output \[columns\]. Returns [`WIDTH`] if it is unknown.
pub fn output_width() -> usize {
    columns(&Term::stdout()).unwrap_or(WIDTH)
}

/// Returns the width of messages on standard error \[columns\], at most [`WIDTH`].
pub fn message_width() -> usize {
    columns(&Term::stderr()).map_or(WIDTH, |columns| columns.min(WIDTH))
}

/// Width of output that does not go to a terminal \[columns\].
pub const WIDTH: usize = 80;

/// Returns the width of a terminal \[columns\]. For other output, returns the number in the
/// environment variable `COLUMNS`, or `None`.
fn columns(terminal: &Term) -> Option<usize> {
    /// Smallest width that text is folded to \[columns\]. Narrower terminals break lines
    /// themselves.
    const MIN: usize = 40;
    let given = || std::env::var("COLUMNS").ok()?.parse().ok();
    let columns = terminal.size_checked().map(|(_, columns)| columns);
    Some(usize::from(columns.or_else(given)?).max(MIN))
}

/// Wraps a text at `width` columns. The first line begins with `first`, and other lines are
/// indented by the width of `first`.
pub fn wrapped(text: &str, first: &str, width: usize) -> String {
    let indent = first.chars().count();
    let (mut out, mut used) = (first.to_owned(), indent);
    for (number, word) in text.split_whitespace().enumerate() {
        let length = word.chars().count();
        if number > 0 && used + 1 + length > width {
            out += &format!("\n{:indent$}", "");
            used = indent;
        } else if number > 0 {
            out.push(' ');
            used += 1;
        }
        out += word;
        used += length;
    }
    out + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_lines_are_folded_at_spaces() {
        let text = "  phase grow: one two three four\nshort\nunbreakableunbreakable\n";
        let expected =
            "  phase grow: one\n      two three\n      four\nshort\nunbreakableunbreakable\n";
        assert_eq!(folded(text, 18), expected);
        assert_eq!(folded(text, 100), text);
    }

    #[test]
    fn invisible_characters_are_escaped_on_terminals() {
        let text = "é\u{1b}[2J\u{202e}∞\r\n\tend\n".as_bytes();
        for size in 1..=text.len() {
            let mut out = Vec::new();
            let mut shown = VisibleWriter::new(&mut out);
            for part in text.chunks(size) {
                shown.write_all(part).unwrap();
            }
            let expected = "é⟨U+001B⟩[2J⟨U+202E⟩∞⟨U+000D⟩\n\tend\n";
            assert_eq!(String::from_utf8(out).unwrap(), expected, "{size}");
        }
    }
}
