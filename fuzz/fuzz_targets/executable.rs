//! Reads arbitrary bytes as compiled programs. Valid programs must be equal after writing and
//! reading, and must run.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::executable::read(bytes));
