//! Tests the command: its output, its messages and its exit status.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests read what the command has written"
)]
mod aggregate;
#[cfg(target_os = "linux")]
mod budget;
mod check;
mod checkpoints;
mod claims;
mod compile;
#[cfg(target_os = "linux")]
mod emulated;
mod explain;
mod fit;
mod fix;
mod fmt;
mod fsck;
mod hardware;
mod hostile;
mod import;
#[cfg(unix)]
mod interrupted;
mod json;
#[cfg(unix)]
mod kinds;
#[path = "../../crates/report/tests/report/layout.rs"]
#[allow(dead_code, reason = "shared with the tests of reports")]
mod layout;
mod levels;
#[path = "../experiment_log/mod.rs"]
#[allow(dead_code, reason = "shared with the tests of results folders")]
mod logs;
mod lsp;
mod manifest;
mod manual;
mod new;
mod optimize;
#[cfg(target_os = "linux")]
#[path = "../pages/mod.rs"]
mod pages;
mod parameters;
mod physical;
mod plan;
mod plan_scene;
mod plan_voxels;
mod proof;
mod rates;
#[path = "../../crates/report/tests/report/reading.rs"]
mod reading;
mod refused;
mod report;
#[cfg(target_os = "linux")]
mod scarce;
mod scene;
mod shards;
mod show;
mod simulate;
#[path = "../skipped/mod.rs"]
mod skipped;
mod stochc;
mod streams;
#[cfg(unix)]
mod submit;
mod sweep;
mod tanks;
mod trade;
mod watch;
#[cfg(unix)]
mod written;
