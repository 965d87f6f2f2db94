//! Compile and simulate stochastic assembly programs.
pub mod ensemble;
pub mod statistics;
