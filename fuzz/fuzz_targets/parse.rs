//! Parses arbitrary text to its end. The verdict must equal that of the whole grammar, and valid
//! text must survive printing and parsing.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| stochc_fuzz::parse::read(text));
