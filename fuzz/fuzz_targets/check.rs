//! Checks arbitrary bytes. The check must end with valid diagnostics, and a program without errors
//! must have tables.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::check::read(bytes));
