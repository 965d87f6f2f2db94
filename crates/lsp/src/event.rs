//! Events of the server.
use serde_json::Value;

use super::jobs::JobId;
use super::wire::{Incoming, RequestFailure};
use crate::workspace::programs::CheckedProgram;

/// Event that the server processes.
pub enum ServerEvent {
    Incoming(Incoming),
    /// End of a job. `None` if the job was cancelled or has failed.
    Done(JobId, Option<Done>),
}

pub enum Done {
    Checked(CheckedProgram),
    /// Response to a request.
    Answered(Result<Value, RequestFailure>),
}

impl From<CheckedProgram> for Done {
    fn from(checked: CheckedProgram) -> Done {
        Done::Checked(checked)
    }
}
