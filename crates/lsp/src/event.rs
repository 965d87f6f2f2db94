//! Events of the server.
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
    /// Response to a request, as JSON.
    Answered(Result<String, RequestFailure>),
}

impl From<CheckedProgram> for Done {
    fn from(checked: CheckedProgram) -> Done {
        Done::Checked(checked)
    }
}
