//! `stochc check`.
mod cost;
mod fix;
mod run;
mod scene;

pub use run::{CheckArguments, run};
