//! Any bytes are compiled programs or none; those that are survive being written and read again, and can be run.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::executable::read(bytes));
