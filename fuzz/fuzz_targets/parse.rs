//! Any text parses to its end; the grammar as a whole comes to the same verdict, and what
//! is right survives being printed and read again.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| stochc_fuzz::parse::read(text));
