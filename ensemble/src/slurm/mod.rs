//! An ensemble in pieces on a cluster that Slurm schedules: one job array makes what is missing, and a job after it
//! puts the pieces together.
//!
//! | file | what |
//! |---|---|
//! | `slurm/pieces.sh`, `slurm/merge.sh` | the scripts of the jobs |
//! | `slurm/jobs.json` | the jobs that were submitted ([`Submission`]) |
//! | `slurm/12_3.log` | what task 3 of job array 12 has said, unless it ended well |
//! | `slurm/merge_13.log` | why job 13 could not put the pieces together |
//! | `slurm/.lock` | held by the process that submits |
//!
//! What is submitted next follows from the pieces that are there and from what Slurm says of jobs with the name of this
//! folder ([`Workflow`]), so that it can be asked again at any time, by anybody. Nothing here starts a process: that is the command's.
mod answer;
mod array;
mod limits;
mod log;
mod queue;
mod script;
mod submission;
mod workflow;

pub use answer::is_passing;
pub use array::JobArray;
pub use limits::SlurmLimits;
pub use log::last_lines;
pub use queue::{FORMAT, Queue, SlurmJob};
pub use script::{merge_script, pieces_script};
pub use submission::{FoundPieces, Opened, SlurmEnsemble, Submission, Submitting};
pub use workflow::{Stop, Workflow, WorkflowStep};
