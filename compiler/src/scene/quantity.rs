//! A value that stands alone, read as in a scene.
use stochc_grammar::tree::{ItemKind, Quantity, Term};
use stochc_grammar::{Symbols, parse};

use crate::units::unit_meant;

/// Reads a number with its unit, such as `4.5 N`, by the rules of the language.
///
/// # Errors
/// In words, when it is none.
pub fn quantity(text: &str) -> Result<Quantity, String> {
    let text = text.trim();
    let none = || format!("`{text}` is no value; write a number and its unit, such as `4.5 N`");
    let mut symbols = Symbols::new();
    let parsed = parse(&format!("scene s {{ v {text} }}"), &mut symbols);
    let [item] = &parsed.tree.items[..] else {
        return Err(none());
    };
    let ItemKind::Scene(scene) = &item.kind else {
        return Err(none());
    };
    match &scene.terms[1..] {
        [Term::Quantity(quantity)] if parsed.errors.is_empty() => Ok(quantity.clone()),
        [Term::Quantity(_), Term::Word(word), ..] if parsed.errors.is_empty() => {
            let word = symbols.word(word.symbol);
            Err(match unit_meant(word) {
                Some(meant) => format!("`{word}` is no unit; {}", meant.help()),
                None => format!(
                    "`{word}` is no unit; units are those of the SI, with prefixes such as `m` \
                     and `k`, and min, h, L, rev, deg and ticks"
                ),
            })
        }
        _ => Err(none()),
    }
}

#[cfg(test)]
mod tests {
    use stochc_ir::scene::units::Dimension;

    use super::*;
    use crate::units::to_si;

    #[test]
    fn values_are_those_of_the_language() {
        let si = |text: &str| to_si(&quantity(text).unwrap());
        assert_eq!(si("20cm"), (0.2, Dimension::LENGTH));
        assert_eq!(si(" 5 N s/m "), (5.0, Dimension::DAMPING));
        assert_eq!(si("300"), (300.0, Dimension::NUMBER));
        assert_eq!(si("-1.5e-3 N"), (-0.0015, Dimension::FORCE));
        for micro in ["u", "\u{b5}", "\u{3bc}"] {
            assert_eq!(
                si(&format!("20 {micro}s")),
                (20e-6, Dimension::TIME),
                "{micro}"
            );
        }
    }

    #[test]
    fn what_is_no_value_is_told() {
        for text in [
            "",
            "x",
            "1..2",
            "1 2",
            "}",
            "1 } scene t { v 2",
            "1 { }",
            "1 //",
            "{",
            "1\n2",
            "∞",
        ] {
            let told = quantity(text).unwrap_err();
            assert!(told.contains("is no value"), "{text}: {told}");
        }
        assert_eq!(
            quantity("3 newton").unwrap_err(),
            "`newton` is no unit; did you mean `N`?"
        );
        assert!(quantity("3 furlongs").unwrap_err().contains("of the SI"));
    }
}
