//! Resumes a run from arbitrary bytes. The run must either continue for some ticks or be rejected.
#![no_main]
use libfuzzer_sys::fuzz_target;

// An invalid state may make the run panic, which is caught. The panic hook of the fuzzer would end
// the process first.
fuzz_target!(
    init: std::panic::set_hook(Box::new(|_| {})),
    |bytes: &[u8]| stochc_fuzz::checkpoint::read(bytes)
);
