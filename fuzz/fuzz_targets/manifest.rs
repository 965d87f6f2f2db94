//! Any text is a manifest or none; what is one survives being written and read again.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| stochc_fuzz::manifest::read(text));
