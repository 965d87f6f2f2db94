//! Execution of an ensemble: threads, progress, and estimates of the remaining time.
mod clock;
mod executor;
mod forecast;
mod pending_runs;
mod program_run;
mod progress;
mod run;
mod thread_time;
mod time_left;

pub use clock::now;
pub use executor::RunCancelled;
pub(crate) use executor::{attempt, execute, is_panic};
pub use forecast::{CpuForecast, forecast_cpu_time};
pub(crate) use pending_runs::{PendingRun, PendingRuns, job, number};
pub use program_run::{unless, until};
pub use progress::{ProgramProgress, Progress, RunWatch, Snapshot, Totals};
pub use run::{Destination, EnsembleError, Results, check_stored, run};
pub(crate) use run::{RunTracker, check_again, journaled};
pub(crate) use thread_time::thread_time;
pub use time_left::time_left;
