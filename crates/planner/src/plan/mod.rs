//! Plans, their captures and their explanation.
pub(crate) mod baseline;
pub(crate) mod build_plan;
pub(crate) mod capture;
pub(crate) mod explanation;
