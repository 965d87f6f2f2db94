//! How a command ends: its status, and what it says where it fails.
use std::fmt::Display;
use std::path::Path;

use stochc_text::visible;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All is well.
    Success,
    /// The program is wrong.
    InvalidProgram,
    /// The command line is wrong, or a file cannot be read or written.
    Usage,
    /// A run was unsuccessful.
    UnsuccessfulRun,
    /// Stopped by the user.
    Interrupted,
}

impl Exit {
    /// How a command ends whose runs, or what stands for them, were all successful, or were not.
    pub const fn of_runs(are_successful: bool) -> Exit {
        if are_successful {
            Exit::Success
        } else {
            Exit::UnsuccessfulRun
        }
    }

    /// Returns the number that the shell sees.
    pub const fn status(self) -> u8 {
        match self {
            Exit::Success => 0,
            Exit::InvalidProgram => 1,
            Exit::Usage => 2,
            Exit::UnsuccessfulRun => 3,
            Exit::Interrupted => 130,
        }
    }

    /// Returns the one that a shell should rather hear of.
    pub fn or_worse(self, other: Exit) -> Exit {
        if other.status() > self.status() {
            other
        } else {
            self
        }
    }
}

/// Why a command ends before its work is done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// How it ends.
    pub exit: Exit,
    /// What to say of it on standard error, in whole lines; empty: all has been said.
    pub message: String,
}

impl Failure {
    /// Returns the command line is wrong, or a file cannot be used.
    pub fn usage(reason: impl Display) -> Failure {
        Failure::error(Exit::Usage, reason)
    }

    /// Returns a file cannot be written, for this reason.
    pub fn not_written(path: &Path, reason: impl Display) -> Failure {
        Failure::usage(format!("cannot write `{}`: {reason}", path.display()))
    }

    /// Returns a program cannot be run.
    pub fn invalid_program(reason: impl Display) -> Failure {
        Failure::error(Exit::InvalidProgram, reason)
    }

    /// Returns an error in one sentence, whatever names of others it holds.
    pub(crate) fn error(exit: Exit, reason: impl Display) -> Failure {
        Failure {
            exit,
            message: format!("error: {}\n", visible(&reason.to_string())),
        }
    }

    /// Returns an end of which there is nothing to say, or nothing more.
    pub(crate) fn silent(exit: Exit) -> Failure {
        Failure {
            exit,
            message: String::new(),
        }
    }
}
