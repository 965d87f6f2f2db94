//! Engine of the playground: compiler and simulator as a WebAssembly module.
//!
//! A page writes a request of JSON into the memory that [`input`] returns, and calls [`answer`].
//! The reply is JSON in the memory that [`output`] returns. `playground/web/src/engine.js` makes
//! these calls.
mod check;
mod ensemble;
mod examples;
mod host;
mod plan;
mod request;
mod run;

use std::cell::RefCell;

thread_local! {
    static INPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static OUTPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Returns a pointer to memory for a request of this length \[bytes\].
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    INPUT.with_borrow_mut(|input| {
        input.clear();
        input.resize(length, 0);
        input.as_mut_ptr()
    })
}

/// Answers the request in the memory from [`input`]. Returns the length of the reply \[bytes\].
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    host::report_panics();
    let request = INPUT.take();
    let reply = request::answer(&request);
    OUTPUT.with_borrow_mut(|output| {
        *output = reply.into_bytes();
        output.len()
    })
}

/// Returns a pointer to the last reply.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    OUTPUT.with_borrow(|output| output.as_ptr())
}
