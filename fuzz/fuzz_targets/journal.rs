//! Reads arbitrary bytes as a journal. Valid runs must belong to the manifest, each once;
//! everything else must be reported.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::journal::read(bytes));
