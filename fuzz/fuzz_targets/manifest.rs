//! Reads arbitrary text as a manifest. A valid one must survive writing and reading.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| stochc_fuzz::manifest::read(text));
