//! Observation of a running simulation: block positions and the structure's events.
mod observation;
mod observer;
mod rows;

pub(crate) use observation::{EventObservation, Log, StepObserver};
pub use observer::{MessageContent, ObservedEvent, Observer};
pub use rows::{EventRows, TimedEvent};
