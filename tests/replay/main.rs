//! Tests recordings of runs, and their replays.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests write what the command is to read"
)]
mod accessible;
mod browser;
mod drawn;
mod exported;
mod firefox;
mod folder;
mod grouped;
mod hostile;
mod interaction;
mod observed;
mod page;
mod page_under_test;
mod recorded;
#[path = "../skipped/mod.rs"]
mod skipped;
mod tours;
mod unreadable;
