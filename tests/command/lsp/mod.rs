//! Tests the language server through its protocol.
mod cancellation;
mod client;
mod damaged;
mod editing;
mod imports;
mod neovim;
mod programs;
mod protocol;
mod rename;
