//! Reads arbitrary text as a manifest. A valid manifest must be equal after writing and reading.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| stochc_fuzz::manifest::read(text));
