//! Any bytes are checked to the end, with findings that can be shown; a program without an error has
//! tables.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::check::read(bytes));
