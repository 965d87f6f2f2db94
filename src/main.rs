//! The `stochc` command.
fn main() {}
