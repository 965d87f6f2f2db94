//! Progress display for long work: a bar on a terminal, otherwise occasional lines.
use std::io::IsTerminal as _;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use stochc_results::now;
use stochc_text::{visible, words};

use super::terminal::{is_dumb, warn};
use crate::progress::WorkProgress;

/// Form of the progress display on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Display {
    /// Bar that is redrawn.
    Bar,
    /// Plain lines, at least 10 s apart. Prints a line after each tenth of the work, and at the
    /// latest 60 s after the previous line.
    Lines,
    /// No progress.
    Quiet,
}

/// State for deciding when to print the next plain line.
struct Cadence {
    at: Duration,
    tenth: u32,
}

impl Display {
    /// Returns [`Display::Quiet`] if `quiet` is set. Otherwise returns a bar for a terminal with
    /// cursor control, or lines if standard error is anything else.
    pub fn on_standard_error(quiet: bool) -> Display {
        if quiet {
            Display::Quiet
        } else if std::io::stderr().is_terminal() && !is_dumb() {
            Display::Bar
        } else {
            Display::Lines
        }
    }

    /// Shows progress until the channel `ended` closes.
    pub fn show(self, state: &dyn Fn(Duration) -> WorkProgress, ended: &Receiver<()>) {
        match self {
            Display::Bar => bar(state, ended),
            Display::Lines => lines(state, ended),
            Display::Quiet => {}
        }
    }
}

fn bar(state: impl Fn(Duration) -> WorkProgress, ended: &Receiver<()>) {
    const LENGTH: u64 = 1000;
    let start = now();
    let bar = ProgressBar::with_draw_target(Some(LENGTH), ProgressDrawTarget::stderr());
    let style = "{bar:24.cyan} {wide_msg}";
    bar.set_style(ProgressStyle::with_template(style).expect("the template is well formed"));
    loop {
        let state = state(start.elapsed());
        bar.set_position((state.share * LENGTH as f64) as u64);
        bar.set_message(visible(&(state.done + &state.more)));
        match ended.recv_timeout(Duration::from_millis(200)) {
            Err(RecvTimeoutError::Timeout) => {}
            _ => break,
        }
    }
    bar.finish_and_clear();
    print_last(&state(start.elapsed()), start.elapsed());
}

fn lines(state: impl Fn(Duration) -> WorkProgress, ended: &Receiver<()>) {
    let start = now();
    let mut cadence = Cadence::new(&state(Duration::ZERO));
    while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(Duration::from_secs(1)) {
        let state = state(start.elapsed());
        if cadence.due(start.elapsed(), &state) {
            print_line(&(state.done + &state.more));
        }
    }
    print_last(&state(start.elapsed()), start.elapsed());
}

fn print_last(state: &WorkProgress, elapsed: Duration) {
    if state.done.is_empty() {
        return;
    }
    print_line(&format!("{} in {}", state.done, words(elapsed)));
}

/// Prints a line to standard error. Ignores errors of writing.
fn print_line(line: &str) {
    warn(&format!("{}\n", visible(line)));
}

impl Cadence {
    const APART: Duration = Duration::from_secs(10);
    const LONG: Duration = Duration::from_secs(60);

    fn new(state: &WorkProgress) -> Cadence {
        Cadence {
            at: Duration::ZERO,
            tenth: tenths(state),
        }
    }

    /// Returns whether to print a line at the time `elapsed` after the start.
    fn due(&mut self, elapsed: Duration, state: &WorkProgress) -> bool {
        let since = elapsed.saturating_sub(self.at);
        let tenth = tenths(state);
        let due = since >= Self::LONG || since >= Self::APART && tenth > self.tenth;
        if due {
            (self.at, self.tenth) = (elapsed, tenth);
        }
        due
    }
}

fn tenths(state: &WorkProgress) -> u32 {
    (10.0 * state.share) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_lines_are_rare() {
        let at = |done: u32| WorkProgress {
            share: f64::from(done) / 100.0,
            ..WorkProgress::default()
        };
        let mut cadence = Cadence::new(&at(0));
        let printed: Vec<u64> = [
            (1, 50),
            (10, 9),
            (11, 12),
            (15, 40),
            (21, 40),
            (22, 49),
            (81, 49),
        ]
        .into_iter()
        .filter(|&(second, done)| cadence.due(Duration::from_secs(second), &at(done)))
        .map(|(second, _)| second)
        .collect();
        assert_eq!(printed, [11, 21, 81]);
    }
}
