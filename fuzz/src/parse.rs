//! Any text parses to its end; the grammar as a whole comes to the same verdict, and what is right survives being printed and read again.
use stochc_grammar::{Symbols, accepts, parse, print};

/// Reads an input, and panics where something is wrong with what comes of it.
pub fn read(text: &str) {
    let mut symbols = Symbols::default();
    let parsed = parse(text, &mut symbols);
    let is_wrong = (parsed.errors.iter()).any(|error| error.kind.is_of_grammar());
    // Past the first hundred errors nobody looks.
    if parsed.errors.len() < 100 {
        assert_eq!(
            !is_wrong,
            accepts(text),
            "two verdicts: {:?}",
            parsed.errors
        );
    }
    if parsed.errors.is_empty() {
        let printed = print(&parsed.tree, &symbols);
        let again = parse(&printed, &mut symbols);
        assert!(again.errors.is_empty(), "{printed}\n{:?}", again.errors);
        assert_eq!(again.tree, parsed.tree, "{printed}");
    }
}
