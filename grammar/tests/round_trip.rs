//! Printing a tree and parsing it again gives the same tree.
use stochc_grammar::{Symbols, accepts, parse, print};

#[test]
fn examples_survive_printing() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "sa") {
            continue;
        }
        seen += 1;
        let text = String::from_utf8(std::fs::read(&path).unwrap()).unwrap();
        let mut symbols = Symbols::new();
        let parsed = parse(&text, &mut symbols);
        assert_eq!(parsed.errors, [], "{}", path.display());
        assert!(accepts(&text), "{}", path.display());
        let printed = print(&parsed.tree, &symbols);
        let again = parse(&printed, &mut symbols);
        assert_eq!(again.errors, [], "{printed}");
        assert_eq!(again.tree, parsed.tree, "{printed}");
    }
    assert!(seen >= 5);
}
