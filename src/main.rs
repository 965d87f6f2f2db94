//! The `stochc` command.
use std::io::Write as _;
use std::process::ExitCode;

use stochc::cli::{parse, report_usage_error, run, show_deferred};

fn main() -> ExitCode {
    let done = parse().map_or_else(report_usage_error, run);
    let exit = done.unwrap_or_else(|failure| {
        // If standard error is closed, the exit status is still correct.
        let _ = std::io::stderr()
            .lock()
            .write_all(failure.message.as_bytes());
        failure.exit
    });
    show_deferred();
    ExitCode::from(exit.status())
}
