//! Parses arbitrary text to its end. The verdict must equal the verdict of the whole grammar. Valid
//! text must be equal after printing and parsing.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| stochc_fuzz::parse::read(text));
