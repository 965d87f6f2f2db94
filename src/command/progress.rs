//! How work that takes long is shown: a bar on a terminal, a line now and then elsewhere.
use std::collections::BTreeMap;
use std::io::IsTerminal as _;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use stochc_ensemble::text::{visible, words};
use stochc_ensemble::trade::{self, Extent};
use stochc_ensemble::{Manifest, Progress, Snapshot, time_left};

use super::terminal::warn;

/// How to show progress on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Display {
    /// A bar that is drawn again and again.
    Bar,
    /// Plain lines: after each tenth of the work, but 10 s apart, and after a minute in any case.
    Lines,
    /// Nothing.
    Quiet,
}

/// How far some work is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// The part that is done, 0 to 1.
    pub share: f64,
    /// What is done, as the last line says it too: `3 of 50 runs, 1 failed`.
    pub done: String,
    /// What else there is to say meanwhile; a narrow terminal cuts off the end.
    pub more: String,
}

/// When a plain line is due.
struct Cadence {
    at: Duration,
    tenth: u32,
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

    /// Does some work and shows how far it is, which `state` says after so much time.
    pub fn during<R>(
        self,
        state: impl Fn(Duration) -> State + Send,
        work: impl FnOnce() -> R,
    ) -> R {
        std::thread::scope(|scope| {
            // Dropped at the end of the work, also by a panic; that is what ends the display.
            let (_working, ended) = channel();
            let show = move || match self {
                Display::Bar => bar(state, &ended),
                Display::Lines => lines(state, &ended),
                Display::Quiet => {}
            };
            // The work goes on where the system has no thread to show it.
            let _ = std::thread::Builder::new().spawn_scoped(scope, show);
            work()
        })
    }
}

/// How far an ensemble is.
pub fn of_ensemble(manifest: &Manifest, progress: &Progress, elapsed: Duration) -> State {
    let snapshot = progress.snapshot();
    let (done, total) = (snapshot.done, snapshot.total);
    State {
        share: done as f64 / total.max(1) as f64,
        done: format!("{done} of {total} runs{}", troubles(&snapshot)),
        more: rest(manifest, &snapshot, elapsed),
    }
}

/// How far a trade is.
pub fn of_trade(extent: Extent, progress: &trade::Progress, elapsed: Duration) -> State {
    let runs = progress.runs();
    let share = match (extent, progress.total()) {
        (Extent::Budget(budget), _) => elapsed.as_secs_f64() / budget.as_secs_f64(),
        (_, Some(total)) => runs as f64 / total as f64,
        _ => 0.0,
    };
    let share = share.min(1.0);
    State {
        share,
        done: format!("{runs} runs"),
        more: format!("; {:.0} %", (100.0 * share).floor()),
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "the command tells how long it takes; no result depends on it"
)]
fn now() -> Instant {
    Instant::now()
}

fn bar(state: impl Fn(Duration) -> State, ended: &Receiver<()>) {
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
    say_last(&state(start.elapsed()), start.elapsed());
}

fn lines(state: impl Fn(Duration) -> State, ended: &Receiver<()>) {
    let start = now();
    let mut cadence = Cadence::new(&state(Duration::ZERO));
    while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(Duration::from_secs(1)) {
        let state = state(start.elapsed());
        if cadence.due(start.elapsed(), &state) {
            say(&(state.done + &state.more));
        }
    }
    say_last(&state(start.elapsed()), start.elapsed());
}

fn say_last(state: &State, elapsed: Duration) {
    say(&format!("{}, after {}", state.done, words(elapsed)));
}

/// A line on standard error, if there still is somebody to read it.
fn say(line: &str) {
    warn(&format!("{}\n", visible(line)));
}

/// How long an ensemble will take, and what is under way.
fn rest(manifest: &Manifest, snapshot: &Snapshot, elapsed: Duration) -> String {
    /// More than this is no longer read.
    const TOLD: usize = 3;
    let mut text = String::new();
    if let Some(left) = time_left(snapshot, elapsed) {
        text += &format!("; about {} left", words(left));
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

/// What went wrong in an ensemble.
fn troubles(snapshot: &Snapshot) -> String {
    let mut text = String::new();
    for (runs, what) in [
        (snapshot.totals.stopped, "stopped"),
        (snapshot.totals.failed, "failed"),
    ] {
        if runs > 0 {
            text += &format!(", {runs} {what}");
        }
    }
    text
}

impl Cadence {
    const APART: Duration = Duration::from_secs(10);
    const LONG: Duration = Duration::from_secs(60);

    fn new(state: &State) -> Cadence {
        Cadence {
            at: Duration::ZERO,
            tenth: tenths(state),
        }
    }

    /// Whether to write a line now, `elapsed` after the start.
    fn due(&mut self, elapsed: Duration, state: &State) -> bool {
        let since = elapsed.saturating_sub(self.at);
        let tenth = tenths(state);
        let due = since >= Self::LONG || since >= Self::APART && tenth > self.tenth;
        if due {
            (self.at, self.tenth) = (elapsed, tenth);
        }
        due
    }
}

fn tenths(state: &State) -> u32 {
    (10.0 * state.share) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_rare() {
        let at = |done: u32| State {
            share: f64::from(done) / 100.0,
            ..State::default()
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
