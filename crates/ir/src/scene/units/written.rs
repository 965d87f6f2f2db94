//! Parser of a single value, with the syntax of a scene.
use super::{BASES, Dimension, PREFIXES, UNITS, converted, suggested_unit, to_si};

/// Number with its unit, such as `4.5 N`.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenQuantity<'a> {
    /// Number as written.
    pub value: f64,
    /// Unit as written. Empty without a unit.
    pub unit: &'a str,
    /// Factors of the unit, each with its power.
    factors: Vec<(&'a str, i8)>,
}

/// Error of a single value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InvalidQuantity {
    /// The text does not begin with a number, or other text follows the number and its unit.
    #[error("`{0}` is no value; write a number and its unit, such as `4.5 N`")]
    NoValue(String),
    /// The unit is unknown.
    #[error("`{unit}` is not a unit; {help}")]
    NoUnit {
        /// The word after the number.
        unit: String,
        /// Suggestion.
        help: String,
    },
}

impl<'a> WrittenQuantity<'a> {
    /// Parses a text that consists of one value.
    ///
    /// # Errors
    ///
    /// If it is invalid.
    pub fn parse(text: &'a str) -> Result<WrittenQuantity<'a>, InvalidQuantity> {
        let text = text.trim();
        let none = || InvalidQuantity::NoValue(text.to_owned());
        let (number, behind) = text.split_at(number(text));
        let value: f64 = number.parse().map_err(|_| none())?;
        let start = behind.trim_start_matches(BLANK);
        let (factors, length) = if begins_tick(start) {
            (Vec::new(), 0)
        } else {
            factors(start)
        };
        let (unit, behind) = start.split_at(length);
        let rest = behind.trim_start();
        let word = rest.split(|c| !is_word(c)).next().unwrap_or_default();
        if !value.is_finite() || !rest.is_empty() && (word.is_empty() || begins_digit(word)) {
            return Err(none());
        }
        if !word.is_empty() {
            let converted = converted(&[value], word, &[]).map(|text| format!("write `{text}`"));
            let suggestion = || suggested_unit(word, &[]).map(|suggestion| suggestion.help());
            let help = converted
                .or_else(suggestion)
                .unwrap_or_else(|| UNITS.to_owned());
            let unit = word.to_owned();
            return Err(InvalidQuantity::NoUnit { unit, help });
        }
        Ok(WrittenQuantity {
            value,
            unit,
            factors,
        })
    }

    /// Returns the value in SI units and its dimension.
    pub fn to_si(&self) -> (f64, Dimension) {
        to_si(self.value, self.factors.iter().copied())
    }
}

/// Signs that the grammar does not read in a value, with the text that replaces them.
const SIGNS: [(&str, &str); 12] = [
    ("\u{b0}", "deg"),
    ("\u{b7}", " "),
    ("\u{22c5}", " "),
    ("\u{d7}", " "),
    ("\u{207b}\u{b9}", "^-1"),
    ("\u{207b}\u{b2}", "^-2"),
    ("\u{207b}\u{b3}", "^-3"),
    ("\u{b2}", "^2"),
    ("\u{b3}", "^3"),
    ("**", "^"),
    ("\u{2103}", "degC"),
    ("\u{2109}", "degF"),
];

/// Corrects a value with signs or symbols that the grammar does not read: `26\u{b0}` becomes
/// `26 deg`, and `1 g/ml` becomes `1 g/mL`. Returns `None` if the corrected text is not a value, or
/// if nothing changes.
pub fn corrected(text: &str) -> Option<String> {
    let text = text.trim();
    let (number, unit) = text.split_at(number(text));
    let value: f64 = number.parse().ok()?;
    let is_value = |text: &String| WrittenQuantity::parse(text).is_ok();
    if let Some(decimals) = unit.strip_prefix(',').filter(|it| begins_digit(it)) {
        return Some(format!("{number}.{decimals}")).filter(is_value);
    }
    let mut unit = unit.trim_start_matches(BLANK).to_owned();
    for (sign, plain) in SIGNS {
        unit = unit.replace(sign, plain);
    }
    if let Some(converted) = converted(&[value], &unit, &[]) {
        return Some(converted);
    }
    let mut plain = format!("{number} ");
    let mut rest = &*unit;
    while let Some(c) = rest.chars().next() {
        let length = rest.find(|c: char| !c.is_alphabetic());
        let length = length.unwrap_or(rest.len());
        let (word, behind) = rest.split_at(length.max(c.len_utf8()));
        match length {
            0 => plain += word,
            _ => plain += &symbol(word)?,
        }
        rest = behind;
    }
    let is_changed = |it: &String| it.replace(BLANK, "") != text.replace(BLANK, "");
    Some(plain).filter(|it| is_changed(it) && is_value(it))
}

/// Returns the symbol that a word of a unit means, such as `mL` for `ml`. Returns `None` if it is
/// unknown.
fn symbol(word: &str) -> Option<String> {
    let is_read = |word: &str| factor(word).is_some_and(|(.., length)| length == word.len());
    let litres = || Some(format!("{}L", word.strip_suffix('l')?));
    let suggested = || suggested_unit(word, &[]).map(|suggestion| suggestion.word);
    (Some(word.to_owned()).filter(|word| is_read(word)))
        .or_else(|| litres().filter(|word| is_read(word)))
        .or_else(suggested)
}

const BLANK: [char; 2] = [' ', '\t'];

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

fn begins_digit(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit())
}

fn digits(text: &str) -> usize {
    text.bytes().take_while(u8::is_ascii_digit).count()
}

/// Returns the length of the number at the start of a text, such as `-1.5e-3`.
fn number(text: &str) -> usize {
    let sign = usize::from(text.starts_with('-'));
    let mut end = sign + digits(&text[sign..]);
    if end == sign {
        return 0;
    }
    if let Some(fraction) = text[end..].strip_prefix('.').filter(|it| begins_digit(it)) {
        end += 1 + digits(fraction);
    }
    if let Some(exponent) = text[end..].strip_prefix(['e', 'E']) {
        let sign = usize::from(exponent.starts_with(['+', '-']));
        if begins_digit(&exponent[sign..]) {
            end += 1 + sign + digits(&exponent[sign..]);
        }
    }
    end
}

/// Returns the factors and the length of the unit at the start of a text. Returns no factors and 0
/// if the text does not begin with a unit.
fn factors(text: &str) -> (Vec<(&str, i8)>, usize) {
    let (mut factors, mut end) = (Vec::new(), 0);
    let mut next = Some((false, 0));
    while let Some((divides, space)) = next {
        let Some((symbol, power, length)) = factor(&text[end + space..]) else {
            break;
        };
        factors.push((symbol, if divides { -power } else { power }));
        end += space + length;
        next = operator(&text[end..]);
    }
    (factors, end)
}

/// Returns the factor at the start of a text, such as `mm^2`: symbol, power and length. Returns
/// `None` if there is none.
fn factor(text: &str) -> Option<(&str, i8, usize)> {
    let base = |text: &str| {
        let mut lengths = BASES.iter().filter(|(base, ..)| text.starts_with(base));
        let is_whole = |length: &usize| !text[*length..].starts_with(is_word);
        lengths.find_map(|(base, ..)| Some(base.len()).filter(is_whole))
    };
    let prefixed = || {
        PREFIXES.iter().find_map(|prefix| {
            let length = base(text.strip_prefix(prefix.sign)?)?;
            Some(prefix.sign.len_utf8() + length)
        })
    };
    let (symbol, behind) = text.split_at(base(text).or_else(prefixed)?);
    let Some(exponent) = behind.strip_prefix('^') else {
        return Some((symbol, 1, symbol.len()));
    };
    let sign = usize::from(exponent.starts_with('-'));
    let length = sign + digits(&exponent[sign..]).min(2);
    Some(match exponent[..length].parse() {
        Ok(power) => (symbol, power, symbol.len() + 1 + length),
        Err(_) => (symbol, 1, symbol.len()),
    })
}

/// Reads the operator between two factors at the start of a text. Returns whether it divides, and
/// its length. Returns `None` if there is no operator.
fn operator(text: &str) -> Option<(bool, usize)> {
    let behind = text.trim_start_matches(BLANK);
    let space = text.len() - behind.len();
    if let Some(next) = behind.strip_prefix(['/', '*']) {
        let length = text.len() - next.trim_start_matches(BLANK).len();
        return Some((behind.starts_with('/'), length));
    }
    (space > 0 && !begins_tick(behind)).then_some((false, space))
}

/// Returns whether a text begins with the clause `tick 20 ms`, which is not a unit of the value
/// before it.
fn begins_tick(text: &str) -> bool {
    let behind = text.strip_prefix("tick").unwrap_or_default();
    let next = behind.trim_start_matches([' ', '\t', '\r', '\n']);
    next.len() < behind.len() && begins_digit(next)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_in_the_language() {
        let si = |text: &str| WrittenQuantity::parse(text).unwrap().to_si();
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
        assert_eq!(WrittenQuantity::parse(" 5 N s/m ").unwrap().unit, "N s/m");
    }

    #[test]
    fn values_with_foreign_signs_are_corrected() {
        for (text, expected) in [
            ("26°", Some("26 deg")),
            ("1.1 g/ml", Some("1.1 g/mL")),
            ("1.1 g/cm³", Some("1.1 g/cm^3")),
            ("1 mPa·s", Some("1 mPa s")),
            ("9.81 m s⁻²", Some("9.81 m s^-2")),
            ("20 °C", Some("293.15 K")),
            ("1,05", Some("1.05")),
            ("1.1 g/cm^3", None),
            ("40,", None),
            ("10um", None),
            ("3 °furlong", None),
            ("x", None),
        ] {
            assert_eq!(corrected(text).as_deref(), expected, "{text}");
        }
    }

    #[test]
    fn rejects_invalid_values() {
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
            let error = WrittenQuantity::parse(text).unwrap_err().to_string();
            assert!(error.contains("is no value"), "{text}: {error}");
        }
        let error = |text| WrittenQuantity::parse(text).unwrap_err().to_string();
        assert_eq!(
            error("3 newton"),
            "`newton` is not a unit; did you mean `N`?"
        );
        assert_eq!(error("2 atm"), "`atm` is not a unit; write `202650 Pa`");
        assert!(error("3 furlongs").contains("of the SI"));
    }
}
