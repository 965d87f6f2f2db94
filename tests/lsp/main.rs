//! The language server, as a client meets it.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests write what the server is to read"
)]
mod cancellation;
mod client;
mod imports;
mod neovim;
mod programs;
mod protocol;
mod rename;
#[path = "../skipped/mod.rs"]
mod skipped;
