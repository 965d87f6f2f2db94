//! Tests the compiler through its interface: sources, diagnostics, fixes and proofs.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests read programs from the disk"
)]
mod adrift;
mod bad_input;
mod bounds;
mod cancellation;
mod conditions;
mod cost;
mod diagnostics;
mod fixes;
mod handlers;
mod levels;
mod mount;
mod names;
mod patterns;
mod planar;
#[allow(dead_code, reason = "the texts alone are needed here")]
mod random;
mod reach;
mod scene_warnings;
mod times;
mod units;

use stochc_compiler::diagnostic::{Code, Diagnostic};
use stochc_compiler::{Checked, Limits, check};

/// Checks a text that imports nothing.
fn checked(text: &str) -> Checked {
    checked_within(text, Limits::default())
}

/// Checks a text that imports nothing within other limits.
fn checked_within(text: &str, limits: Limits) -> Checked {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    check("a.sa", &mut reader, limits)
}

/// Returns the diagnostics with a code.
fn with_code(checked: &Checked, code: Code) -> Vec<&Diagnostic> {
    let all = checked.diagnostics.iter();
    all.filter(|diagnostic| diagnostic.code == code).collect()
}
