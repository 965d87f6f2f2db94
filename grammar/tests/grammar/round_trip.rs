//! Checks that a printed tree parses to the same tree.
use proptest::prelude::*;
use stochc_grammar::{Symbols, SyntaxErrorKind, accepts, parse, print};

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

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn random_trees_survive_printing(tree in crate::trees::tree()) {
        let mut symbols = crate::trees::symbols();
        let printed = print(&tree, &symbols);
        let parsed = parse(&printed, &mut symbols);
        prop_assert!(parsed.errors.is_empty(), "{:?}\n{}", parsed.errors, printed);
        prop_assert_eq!(&parsed.tree, &tree, "{}", printed);
        prop_assert!(accepts(&printed), "{}", printed);
        prop_assert_eq!(print(&parsed.tree, &symbols), printed);
    }
}

#[test]
fn a_doc_comment_after_a_number_is_not_a_division() {
    for (text, items) in [
        ("let n = 6\n/// doc\nlet m = 2", 2),
        ("let n = 6 /// doc\nlet m = 2", 2),
        ("let n = 6 // 2\n / 3 //// 4\n", 1),
    ] {
        let parsed = parse(text, &mut Symbols::new());
        assert_eq!(parsed.errors, [], "{text}");
        assert_eq!(parsed.tree.items.len(), items, "{text}");
        assert!(accepts(text));
    }
}

#[test]
fn a_clause_after_a_value_is_not_a_unit() {
    let text = "scene s { tick 20 ms\ns 3\nm }";
    let mut symbols = Symbols::new();
    let parsed = parse(text, &mut symbols);
    assert_eq!(parsed.errors, []);
    let printed = print(&parsed.tree, &symbols);
    assert_eq!(parse(&printed, &mut symbols).tree, parsed.tree, "{printed}");
}

#[test]
fn a_value_in_ticks_is_not_a_clause() {
    for text in [
        "scene s { wait 3 tick^1 4 }",
        "scene s { wait 0 .. 3 tick^1 4 .. 5 s }",
    ] {
        let mut symbols = Symbols::new();
        let parsed = parse(text, &mut symbols);
        assert_eq!(parsed.errors, []);
        let printed = print(&parsed.tree, &symbols);
        assert_eq!(parse(&printed, &mut symbols).tree, parsed.tree, "{printed}");
    }
}

#[test]
fn allow_and_deny_may_be_names() {
    let text = "pattern allow(deny) { deny.up -> allow.up -> deny2 }
        assembly a {
            allow unused-seed \"kept\"
            seed plate 2 x 1 { allow at (0, 0)  deny at (1, 0) }
            phase allow {
                allow.up -> B
                allow (B) as deny
                deny empty-phase \"ranges are computed\"
                release allow
            }
        }";
    let mut symbols = Symbols::new();
    let parsed = parse(text, &mut symbols);
    assert_eq!(parsed.errors, []);
    assert!(accepts(text));
    let printed = print(&parsed.tree, &symbols);
    assert_eq!(printed.matches("allow unused-seed \"kept\"\n").count(), 1);
    assert_eq!(parse(&printed, &mut symbols).tree, parsed.tree, "{printed}");
}

#[test]
fn a_level_needs_a_reason() {
    for text in ["allow unused-seed", "deny a-b \"\"", "allow x \" \""] {
        let parsed = parse(text, &mut Symbols::new());
        let kinds: Vec<_> = parsed.errors.into_iter().map(|error| error.kind).collect();
        assert_eq!(kinds, [SyntaxErrorKind::MissingReason], "{text}");
    }
}
