//! Units as people write them.
use super::{BASES, PREFIXES};
use crate::suggest::{Suggestion, nearest};

/// Which units there are.
pub const UNITS: &str = "units are those of the SI, with prefixes such as `m` and `k`, and min, h, L, rev, deg and ticks";

/// Names of units and the symbols for them.
const NAMES: [(&str, &[&str]); 13] = [
    ("s", &["sec", "secs", "second", "seconds"]),
    ("ms", &["msec", "msecs", "millisecond", "milliseconds"]),
    ("min", &["mins", "minute", "minutes"]),
    ("h", &["hr", "hrs", "hour", "hours"]),
    ("m", &["meter", "meters", "metre", "metres"]),
    (
        "mm",
        &["millimeter", "millimeters", "millimetre", "millimetres"],
    ),
    (
        "cm",
        &["centimeter", "centimeters", "centimetre", "centimetres"],
    ),
    ("g", &["gram", "grams"]),
    ("kg", &["kilogram", "kilograms", "kilo", "kilos"]),
    ("N", &["newton", "newtons"]),
    ("Pa", &["pascal", "pascals"]),
    ("L", &["liter", "liters", "litre", "litres"]),
    ("deg", &["degree", "degrees"]),
];

/// The unit that a word is probably meant to be.
pub fn unit_meant(word: &str) -> Option<Suggestion> {
    let named = NAMES
        .iter()
        .find(|(_, names)| names.iter().any(|name| name.eq_ignore_ascii_case(word)));
    if let Some((unit, _)) = named {
        return Some(Suggestion {
            word: (*unit).to_owned(),
            clear: true,
        });
    }
    // A percent sign is no word, and of ticks the plural will do.
    let bases = BASES.iter().map(|(base, ..)| *base);
    let bases: Vec<&str> = bases.filter(|base| !["%", "tick"].contains(base)).collect();
    let plain = bases.iter().map(|base| (*base).to_owned());
    let common = PREFIXES.iter().filter(|prefix| prefix.is_common);
    let prefixed = common.flat_map(|prefix| {
        let bases = bases.iter().filter(|base| base.len() <= 2);
        bases.map(|base| format!("{}{base}", prefix.sign))
    });
    let units: Vec<String> = plain.chain(prefixed).collect();
    // `KG` and `khz` are meant to be `kg` and `kHz`; `MS` could be two units.
    let mut same = units.iter().filter(|unit| unit.eq_ignore_ascii_case(word));
    match (same.next(), same.next()) {
        (Some(only), None) => Some(Suggestion {
            word: only.clone(),
            clear: true,
        }),
        _ => nearest(word, units),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Dimension, to_si};
    use super::*;

    #[test]
    fn what_a_name_stands_for_is_a_unit() {
        for (unit, _) in NAMES {
            let (size, dimension) = to_si(1.0, [(unit, 1)]);
            assert!((size, dimension) != (1.0, Dimension::NUMBER), "{unit}");
        }
    }

    #[test]
    fn units_are_suggested() {
        let meant = |word| unit_meant(word).map(|meant| (meant.word, meant.clear));
        let clear = |word: &str| Some((word.to_owned(), true));
        assert_eq!(meant("seconds"), clear("s"));
        assert_eq!(meant("KG"), clear("kg"));
        assert_eq!(meant("khz"), clear("kHz"));
        assert_eq!(meant("tics"), clear("ticks"));
        assert_eq!(meant("mss"), Some(("ms".to_owned(), false)));
        assert_eq!(meant("furlong"), None);
    }
}
