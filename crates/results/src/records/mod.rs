//! Records of finished runs.
mod finished;
mod json;
mod location;
mod program_events;
mod store;
mod validation;

pub use finished::Finished;
pub use json::record_json;
pub(crate) use location::LineLocation;
pub(crate) use program_events::ProgramEvents;
pub use store::Records;
pub(crate) use validation::RecordValidator;
