//! Records of finished runs.
mod finished;
mod json;
mod location;
mod partial_run;
mod program_events;
mod store;
mod validation;

pub use finished::Finished;
pub use json::record_json;
pub(crate) use location::LineLocation;
pub use partial_run::partial_run;
pub(crate) use program_events::ProgramEvents;
pub use store::Records;
pub(crate) use validation::RecordValidator;
