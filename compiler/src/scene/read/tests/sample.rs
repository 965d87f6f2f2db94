//! Scenes for tests of the reader.
use stochc_grammar::tree::ItemKind;
use stochc_grammar::{Symbols, parse, print};
use stochc_ir::scene::Scene;

use super::super::read;
use crate::Sources;
use crate::diagnostic::Diagnostic;
use crate::scene::built_in;

/// Returns a scene from `hemisphere` with these clauses replaced, and its diagnostics.
pub fn scene(clauses: &str) -> (Option<Scene>, Vec<Diagnostic>) {
    let text = format!("scene s from hemisphere {{ {clauses} }}");
    let mut symbols = Symbols::new();
    let parsed = parse(&text, &mut symbols);
    assert_eq!(parsed.errors, [], "{clauses}");
    let printed = print(&parsed.tree, &symbols);
    assert_eq!(parse(&printed, &mut symbols).tree, parsed.tree, "{printed}");
    let ItemKind::Scene(tree) = &parsed.tree.items[0].kind else {
        panic!("{clauses} is not a scene");
    };
    let mut diagnostics = Vec::new();
    let file = Sources::default().add("s.sa", text.as_str());
    let scene = read(
        tree,
        built_in("hemisphere"),
        file,
        &symbols,
        &mut diagnostics,
    );
    (scene, diagnostics)
}
