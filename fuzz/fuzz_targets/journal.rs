//! Reads arbitrary bytes as a journal. Valid runs must belong to the manifest, and each must occur
//! only once. All other content must be reported.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::journal::read(bytes));
