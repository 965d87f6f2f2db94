//! Compile and simulate stochastic assembly programs.
