//! What the server waits for.
use serde_json::Value;

use super::jobs::JobId;
use super::programs::CheckedProgram;
use super::wire::{Incoming, RequestFailure};

/// What the server waits for.
pub enum ServerEvent {
    /// Something from the client.
    Incoming(Incoming),
    /// The end of a job; nothing has come out of one that was cancelled or has failed.
    Done(JobId, Option<Done>),
}

/// What comes out of a job.
pub enum Done {
    /// A program has been checked.
    Checked(CheckedProgram),
    /// A request has been worked out.
    Answered(Result<Value, RequestFailure>),
}

impl From<CheckedProgram> for Done {
    fn from(checked: CheckedProgram) -> Done {
        Done::Checked(checked)
    }
}
