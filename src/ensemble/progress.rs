//! How an ensemble shows that it is at work: a bar on a terminal, a line now and then elsewhere.
use std::collections::BTreeMap;
use std::io::{IsTerminal as _, Write as _};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::board::{Board, Snapshot};
use super::{Manifest, clock, estimate};

/// How to show progress on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Display {
    /// A bar that is drawn again and again.
    Bar,
    /// Plain lines: after each tenth of the runs, but 10 s apart, and after a minute in any case.
    Lines,
    /// Nothing.
    Quiet,
}

/// When a plain line is due.
struct Cadence {
    at: Duration,
    tenth: u64,
}

impl Display {
    /// A bar where standard error is a terminal, lines where it is not, nothing for `quiet`.
    pub fn on_standard_error(quiet: bool) -> Display {
        if quiet {
            Display::Quiet
        } else if std::io::stderr().is_terminal() {
            Display::Bar
        } else {
            Display::Lines
        }
    }
}

/// Does some work and shows how far it is.
pub(super) fn during<R>(
    display: Display,
    manifest: &Manifest,
    board: &Board,
    work: impl FnOnce() -> R,
) -> R {
    std::thread::scope(|scope| {
        // Dropped at the end of the work, also by a panic; that is what ends the display.
        let (_working, ended) = channel();
        scope.spawn(move || match display {
            Display::Bar => bar(manifest, board, &ended),
            Display::Lines => lines(manifest, board, &ended),
            Display::Quiet => {}
        });
        work()
    })
}

fn bar(manifest: &Manifest, board: &Board, ended: &Receiver<()>) {
    let start = clock::now();
    let target = ProgressDrawTarget::stderr();
    let bar = ProgressBar::with_draw_target(Some(manifest.total()), target);
    let style = "{bar:24.cyan} {pos} of {len} runs{wide_msg}";
    bar.set_style(ProgressStyle::with_template(style).expect("the template is well formed"));
    loop {
        let snapshot = board.snapshot();
        bar.set_position(snapshot.done);
        bar.set_message(rest(manifest, &snapshot, start.elapsed()));
        match ended.recv_timeout(Duration::from_millis(200)) {
            Err(RecvTimeoutError::Timeout) => {}
            _ => break,
        }
    }
    bar.finish_and_clear();
    say(&last(&board.snapshot(), start.elapsed()));
}

fn lines(manifest: &Manifest, board: &Board, ended: &Receiver<()>) {
    let start = clock::now();
    let mut cadence = Cadence::new(&board.snapshot());
    while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(Duration::from_secs(1)) {
        let snapshot = board.snapshot();
        if cadence.due(start.elapsed(), &snapshot) {
            let rest = rest(manifest, &snapshot, start.elapsed());
            say(&format!(
                "{} of {} runs{rest}",
                snapshot.done, snapshot.total
            ));
        }
    }
    say(&last(&board.snapshot(), start.elapsed()));
}

/// A line on standard error, if there still is somebody to read it.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// What follows the number of runs: what went wrong, how long it will take, what is under way; a
/// narrow terminal cuts off the end.
fn rest(manifest: &Manifest, snapshot: &Snapshot, elapsed: Duration) -> String {
    /// More than this is no longer read.
    const TOLD: usize = 3;
    let mut text = troubles(snapshot);
    if let Some(left) = estimate::time_left(snapshot, elapsed) {
        text += &format!("; about {} left", estimate::words(left));
    }
    let mut under_way = BTreeMap::<_, u64>::new();
    for &(program, phase) in &snapshot.under_way {
        *under_way.entry((program, phase)).or_default() += 1;
    }
    let mut places: Vec<_> = under_way
        .iter()
        .map(|(&(program, phase), runs)| {
            let program = &manifest.programs[program];
            let phase = program.phase(phase);
            match manifest.programs.len() {
                1 => format!("{runs} in {phase}"),
                _ => format!("{runs} in {} {phase}", program.name),
            }
        })
        .collect();
    if places.len() > TOLD {
        places.truncate(TOLD);
        places.push("...".to_owned());
    }
    if !places.is_empty() {
        text += &format!("; {}", places.join(", "));
    }
    text
}

fn troubles(snapshot: &Snapshot) -> String {
    let mut text = String::new();
    for (runs, what) in [
        (snapshot.tally.stopped, "stopped"),
        (snapshot.tally.failed, "failed"),
    ] {
        if runs > 0 {
            text += &format!(", {runs} {what}");
        }
    }
    text
}

fn last(snapshot: &Snapshot, elapsed: Duration) -> String {
    format!(
        "{} of {} runs{}, after {}",
        snapshot.done,
        snapshot.total,
        troubles(snapshot),
        estimate::words(elapsed)
    )
}

impl Cadence {
    const APART: Duration = Duration::from_secs(10);
    const LONG: Duration = Duration::from_secs(60);

    fn new(snapshot: &Snapshot) -> Cadence {
        Cadence {
            at: Duration::ZERO,
            tenth: tenths(snapshot),
        }
    }

    /// Whether to write a line now, `elapsed` after the start.
    fn due(&mut self, elapsed: Duration, snapshot: &Snapshot) -> bool {
        let since = elapsed.saturating_sub(self.at);
        let tenth = tenths(snapshot);
        let due = since >= Self::LONG || since >= Self::APART && tenth > self.tenth;
        if due {
            (self.at, self.tenth) = (elapsed, tenth);
        }
        due
    }
}

fn tenths(snapshot: &Snapshot) -> u64 {
    (snapshot.done * 10)
        .checked_div(snapshot.total)
        .unwrap_or(10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_rare() {
        let at = |done| Snapshot {
            total: 100,
            done,
            ..Snapshot::default()
        };
        let mut cadence = Cadence::new(&at(0));
        let told: Vec<u64> = [
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
        assert_eq!(told, [11, 21, 81]);
    }
}
