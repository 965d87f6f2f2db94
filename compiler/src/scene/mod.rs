//! Reads scenes, including built-in and changed ones.
mod builtin;
mod change;
pub(crate) mod declared_scenes;
mod read;
pub(crate) mod scene_check;
pub(crate) mod scenes;
#[cfg(test)]
mod tests;
mod words;

pub use builtin::{BUILT_IN, DEFAULT, built_in, built_in_names, is_built_in};
pub(crate) use change::diagnostic;
pub(crate) use read::read;
pub use words::WordContext;
