//! Reads arbitrary bytes as a recording. The reader must return an error or a valid recording.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::recording::read(bytes));
