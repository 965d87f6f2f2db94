//! The language server, as a client meets it.
mod cancellation;
mod client;
mod imports;
mod neovim;
mod programs;
mod protocol;
mod rename;
