//! Any text parses to its end; what has no error is accepted by the grammar as a whole, and
//! survives being printed and read again.
#![no_main]
use libfuzzer_sys::fuzz_target;
use stochc_grammar::{Symbols, accepts, parse, print};

fuzz_target!(|text: &str| {
    let mut symbols = Symbols::default();
    let parsed = parse(text, &mut symbols);
    // Some mistakes, such as documentation of nothing, are none of the grammar's.
    if parsed.errors.is_empty() {
        assert!(accepts(text), "two verdicts");
        let printed = print(&parsed.tree, &symbols);
        let again = parse(&printed, &mut symbols);
        assert!(again.errors.is_empty(), "{printed}\n{:?}", again.errors);
        assert_eq!(again.tree, parsed.tree, "{printed}");
    }
});
