//! Exit statuses and failures of commands.
use std::fmt::Display;
use std::path::Path;

use stochc_text::visible;

/// Result of a command. It determines the exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// The command succeeded.
    Success,
    /// A program has errors.
    InvalidProgram,
    /// The command line is invalid, or a file cannot be read or written.
    Usage,
    /// A run, estimate or exploration did not complete successfully.
    UnsuccessfulRun,
    /// The user interrupted the command.
    Interrupted,
}

impl Exit {
    /// Returns success or [`Exit::UnsuccessfulRun`], for runs, estimates or explorations.
    pub const fn from_runs(are_successful: bool) -> Exit {
        if are_successful {
            Exit::Success
        } else {
            Exit::UnsuccessfulRun
        }
    }

    /// Returns the number of the exit status.
    pub const fn status(self) -> u8 {
        match self {
            Exit::Success => 0,
            Exit::InvalidProgram => 1,
            Exit::Usage => 2,
            Exit::UnsuccessfulRun => 3,
            Exit::Interrupted => 130,
        }
    }

    /// Returns the more severe of two results.
    pub fn or_worse(self, other: Exit) -> Exit {
        if other.status() > self.status() {
            other
        } else {
            self
        }
    }
}

/// Result and message of a failed command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Result of the command.
    pub exit: Exit,
    /// Message for standard error, in complete lines. Empty if everything was already reported.
    pub message: String,
}

impl Failure {
    /// Creates the failure for an invalid command line or an unusable file.
    pub fn usage(reason: impl Display) -> Failure {
        Failure::error(Exit::Usage, reason)
    }

    /// Creates the failure for a file that cannot be written.
    pub fn not_written(path: &Path, reason: impl Display) -> Failure {
        Failure::usage(format!("cannot write `{}`: {reason}", path.display()))
    }

    /// Creates the failure for a program that cannot be run.
    pub fn invalid_program(reason: impl Display) -> Failure {
        Failure::error(Exit::InvalidProgram, reason)
    }

    /// Creates a failure with a one-line message. Escapes invisible characters in the reason.
    pub(crate) fn error(exit: Exit, reason: impl Display) -> Failure {
        Failure {
            exit,
            message: format!("error: {}\n", visible(&reason.to_string())),
        }
    }

    /// Creates a failure without a message, for errors that were already reported.
    pub(crate) fn silent(exit: Exit) -> Failure {
        Failure {
            exit,
            message: String::new(),
        }
    }
}
