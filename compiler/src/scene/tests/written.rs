//! Compares single values with the same values in a scene.
use stochc_grammar::tree::{ItemKind, Term};
use stochc_grammar::{Symbols, parse};
use stochc_ir::scene::units::{BASES, Dimension, PREFIXES, WrittenQuantity};

use crate::expand::units::to_si;

/// Returns the value that the grammar reads if a text is only a value.
fn in_scene(text: &str) -> Option<(f64, Dimension)> {
    let parsed = parse(&format!("scene s {{ v {text} }}"), &mut Symbols::new());
    let [item] = &parsed.tree.items[..] else {
        return None;
    };
    let ItemKind::Scene(scene) = &item.kind else {
        return None;
    };
    match &scene.terms[1..] {
        [Term::Quantity(quantity)] if parsed.errors.is_empty() => Some(to_si(quantity)),
        _ => None,
    }
}

#[test]
fn a_lone_value_is_read_as_by_the_grammar() {
    let bases = || BASES.iter().map(|(base, ..)| (*base).to_owned());
    let prefixed = |sign: char| bases().map(move |base| format!("{sign}{base}"));
    let prefixed = PREFIXES.iter().flat_map(|prefix| prefixed(prefix.sign));
    let mut texts: Vec<String> = Vec::new();
    for unit in bases().chain(prefixed) {
        texts.extend([
            format!("2 {unit}"),
            format!("2{unit}^-2"),
            format!("-2.5e-3  N / {unit}"),
            format!("2 {unit} s*{unit}^12"),
            format!("2 {unit}s"),
            format!("2 {unit}5"),
        ]);
    }
    let odd = [
        "",
        "-",
        "5.",
        ".5",
        "+5",
        "5 .5",
        "- 5",
        "1e5",
        "1e",
        "1E+2 m",
        "1e-m",
        "1e400",
        "5_",
        "5 N^",
        "5 N^-",
        "5 N^123",
        "5 N ^2",
        "5 N/",
        "5 / N",
        "5 N//m",
        "5 N / / m",
        "5 N\tm",
        "5\nN",
        "5 N\n/m",
        "5 tick 3",
        "5 s tick 3",
        "5 s tick",
        "5 tick s",
        "5 tick",
        "5 ticks 3",
        "5 %",
        "5%m",
        "5 %/s",
        "5 m%",
        "5 kk",
        "5 dm",
        "5 µ",
        "5 µg",
        "5 \u{3bc}m",
        "5 N m",
        "5 Nm",
        "5 N 3",
        "5 N m ",
        "0x10",
        "5 // N",
        "5 N {",
        "½ N",
        "5\u{a0}N",
    ];
    texts.extend(odd.map(str::to_owned));
    for text in texts {
        let alone = WrittenQuantity::parse(&text).map(|it| it.to_si());
        assert_eq!(
            alone.clone().ok(),
            in_scene(text.trim()),
            "{text}: {alone:?}"
        );
    }
}
