//! Any bytes are the state of a run or none: it goes on from them for a while, or is refused.
#![no_main]
use libfuzzer_sys::fuzz_target;

// A state that makes no sense may make the run panic, which is caught; the hook of the fuzzer would end the process before.
fuzz_target!(
    init: std::panic::set_hook(Box::new(|_| {})),
    |bytes: &[u8]| stochc_fuzz::checkpoint::read(bytes)
);
