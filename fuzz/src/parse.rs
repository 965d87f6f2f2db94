//! Parses arbitrary text to its end. The verdict must equal the verdict of the whole grammar. Valid
//! text must be equal after printing and parsing.
use stochc_grammar::{Symbols, accepts, parse, print};

/// Parses an input. Panics if the result is wrong.
pub fn read(text: &str) {
    let mut symbols = Symbols::default();
    let parsed = parse(text, &mut symbols);
    let is_wrong = (parsed.errors.iter()).any(|error| error.kind.is_of_grammar());
    // The verdicts are not compared after a hundred errors.
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
