//! Reads arbitrary bytes as a voxel file. The cells of a valid file must rest on the plate.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| stochc_fuzz::voxels::read(bytes));
