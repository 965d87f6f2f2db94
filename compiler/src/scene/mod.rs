//! Scenes as they are written: read, built in, and changed.
mod builtin;
mod change;
mod quantity;
mod read;
mod spelling;
#[cfg(test)]
mod tests;
mod words;

pub use builtin::{BUILT_IN, DEFAULT, built_in};
pub(crate) use change::diagnostic;
pub use quantity::{quantity, to_si};
pub(crate) use read::read;
pub(crate) use spelling::unit_meant;
pub use words::WordContext;
