//! How a measurement shows that it is at work.
use std::io::Write as _;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::ensemble::{Display, now, words};

/// How far it is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Far {
    /// Runs that have ended.
    pub runs: u64,
    /// The share of all that is to do, 0 to 1.
    pub share: f64,
}

/// Does some work and shows how far it is.
pub(super) fn during<R>(
    display: Display,
    far: impl Fn() -> Far + Send,
    work: impl FnOnce() -> R,
) -> R {
    std::thread::scope(|scope| {
        // Dropped at the end of the work, also by a panic; that is what ends the display.
        let (_working, ended) = channel();
        scope.spawn(move || match display {
            Display::Bar => bar(far, &ended),
            Display::Lines => lines(far, &ended),
            Display::Quiet => {}
        });
        work()
    })
}

fn bar(far: impl Fn() -> Far, ended: &Receiver<()>) {
    const LENGTH: u64 = 1000;
    let start = now();
    let bar = ProgressBar::with_draw_target(Some(LENGTH), ProgressDrawTarget::stderr());
    let style = "{bar:24.cyan} {percent} %, {msg}";
    bar.set_style(ProgressStyle::with_template(style).expect("the template is well formed"));
    loop {
        let at = far();
        bar.set_position((at.share * LENGTH as f64) as u64);
        bar.set_message(format!("{} runs", at.runs));
        match ended.recv_timeout(Duration::from_millis(200)) {
            Err(RecvTimeoutError::Timeout) => {}
            _ => break,
        }
    }
    bar.finish_and_clear();
    say(&format!(
        "{} runs, after {}",
        far().runs,
        words(start.elapsed())
    ));
}

/// A line for each tenth, but ten seconds apart.
fn lines(far: impl Fn() -> Far, ended: &Receiver<()>) {
    const APART: Duration = Duration::from_secs(10);
    let start = now();
    let tenth = |far: &Far| (10.0 * far.share) as u32;
    let (mut told, mut at) = (0, Duration::ZERO);
    while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(Duration::from_secs(1)) {
        let far = far();
        if tenth(&far) > told && start.elapsed() - at >= APART {
            (told, at) = (tenth(&far), start.elapsed());
            say(&format!("{} %, {} runs", 10 * told, far.runs));
        }
    }
    say(&format!(
        "{} runs, after {}",
        far().runs,
        words(start.elapsed())
    ));
}

/// A line on standard error, if there still is somebody to read it.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
