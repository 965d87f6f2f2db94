//! `stochc check`.
mod arguments;
mod cost;
mod fix;
mod run;
mod scene;

pub use arguments::CheckArguments;
pub use run::run;
