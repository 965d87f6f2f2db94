//! Reads arbitrary bytes as a recording.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::recording::read(bytes));
