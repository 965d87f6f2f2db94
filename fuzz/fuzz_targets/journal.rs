//! Any bytes are read as a journal: what is sound is a run that the manifest allows, each once, and all else is told.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::journal::read(bytes));
