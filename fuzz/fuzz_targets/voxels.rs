//! Reads arbitrary bytes as voxels.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::voxels::read(bytes));
