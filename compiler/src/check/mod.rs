//! The pipeline of a check and its results.
pub(crate) mod assembly;
pub(crate) mod changes;
pub(crate) mod checked;
mod claims;
pub(crate) mod executable;
pub(crate) mod fix;
pub mod model_check;
pub(crate) mod program;
pub(crate) mod proof;
pub(crate) mod short_timeout;
pub(crate) mod texts;
pub(crate) mod trial;
