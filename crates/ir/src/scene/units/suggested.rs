//! Recognition of misspelt and unsupported units.
use super::super::quantity::QuantityKind;
use super::{BASES, PREFIXES, to_si};
use stochc_text::suggest::{Suggestion, nearest};

/// Description of the supported units.
pub const UNITS: &str = "units are those of the SI, with prefixes such as `m` and `k`, and min, h, L, bar, P, rpm, rev, deg and ticks";

/// Names of units, with their symbols.
const NAMES: [(&str, &[&str]); 17] = [
    ("s", &["sec", "secs", "second", "seconds"]),
    ("ms", &["msec", "msecs", "millisecond", "milliseconds"]),
    ("us", &["usec", "usecs", "microsecond", "microseconds"]),
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
    (
        "um",
        &["micron", "microns", "micrometer", "micrometre", "mcm"],
    ),
    ("g", &["gram", "grams"]),
    ("kg", &["kilogram", "kilograms", "kilo", "kilos"]),
    ("ug", &["microgram", "micrograms", "mcg"]),
    ("N", &["newton", "newtons"]),
    ("Pa", &["pascal", "pascals"]),
    ("L", &["liter", "liters", "litre", "litres"]),
    ("deg", &["degree", "degrees"]),
    ("K", &["kelvin", "kelvins"]),
];

/// Units that the grammar does not read: their names, a supported unit, and the factor and offset
/// of the conversion to it.
const FOREIGN: [(&[&str], &str, f64, f64); 11] = [
    (&["mmHg", "Torr"], "Pa", 133.322387415, 0.0),
    (&["atm"], "Pa", 101_325.0, 0.0),
    (&["psi"], "Pa", 6_894.757293168, 0.0),
    (&["degC", "celsius"], "K", 1.0, 273.15),
    (&["degF"], "K", 5.0 / 9.0, 459.67 * 5.0 / 9.0),
    (&["inch", "inches", "in"], "cm", 2.54, 0.0),
    (&["dyn", "dyne", "dynes"], "uN", 10.0, 0.0),
    (&["kgf", "kp"], "N", 9.80665, 0.0),
    (&["gf"], "mN", 9.80665, 0.0),
    (&["lb", "lbs"], "g", 453.59237, 0.0),
    (&["ccm", "cc"], "mL", 1.0, 0.0),
];

/// Converts values in an unsupported unit to a supported one, such as 2 `mmHg` to `266.645 Pa`.
///
/// Returns `None` if the unit is unknown or belongs to none of the `kinds`. Without kinds, all
/// units are accepted.
pub fn converted(values: &[f64], word: &str, kinds: &[QuantityKind]) -> Option<String> {
    let matches = |name: &&str| name.eq_ignore_ascii_case(word);
    let mut foreign = FOREIGN.iter().filter(|(_, unit, ..)| fits(unit, kinds));
    let (_, unit, factor, zero) = foreign.find(|(names, ..)| names.iter().any(matches))?;
    let numbers = values.iter().map(|value| {
        // Rounds to 12 digits, to remove errors of the conversion.
        let rounded = format!("{:.11e}", value * factor + zero).parse::<f64>();
        rounded.map(|number| number.to_string())
    });
    let numbers: Vec<String> = numbers.collect::<Result<_, _>>().ok()?;
    Some(format!("{} {unit}", numbers.join(" .. ")))
}

/// Returns the unit of one of the `kinds` that a word probably means. Without kinds, the word alone
/// must be unambiguous. Returns `None` if no unit is likely.
pub fn suggested_unit(word: &str, kinds: &[QuantityKind]) -> Option<Suggestion> {
    let clear = |unit: &str| {
        Some(Suggestion {
            word: unit.to_owned(),
            clear: true,
        })
    };
    let is_word = |name: &&str| name.eq_ignore_ascii_case(word);
    let mut named = (NAMES.iter()).filter(|(_, names)| names.iter().any(is_word));
    if let Some((unit, _)) = named.next() {
        return clear(unit).filter(|_| fits(unit, kinds));
    }
    let units: Vec<String> = symbols().filter(|unit| fits(unit, kinds)).collect();
    // `KG` and `khz` mean `kg` and `kHz`; `MS` is ambiguous.
    let mut same = units.iter().filter(|unit| unit.eq_ignore_ascii_case(word));
    if let (Some(only), None) = (same.next(), same.next()) {
        return clear(only);
    }
    // `mPas` is `mPa s` without its space.
    let products = kinds.iter().flat_map(QuantityKind::units);
    let products = products.filter(|unit| unit.contains([' ', '/']));
    let joined = products.clone().find(|unit| unit.replace(' ', "") == word);
    if let Some(joined) = joined {
        return clear(joined);
    }
    let known = units.into_iter().chain(products.map(str::to_owned));
    nearest(word, known).filter(|_| !kinds.is_empty())
}

/// Returns whether a symbol has the dimension of one of the `kinds`, or there are no kinds.
fn fits(unit: &str, kinds: &[QuantityKind]) -> bool {
    let (_, dimension) = to_si(1.0, [(unit, 1)]);
    kinds.is_empty() || kinds.iter().any(|kind| kind.dimension == dimension)
}

/// Returns the symbols of units. Short symbols are also returned with common prefixes.
fn symbols() -> impl Iterator<Item = String> {
    let bases = BASES.iter().map(|(base, ..)| *base);
    // A percent sign is not a word, and the plural of ticks suffices.
    let bases = bases.filter(|base| !["%", "tick"].contains(base));
    let common = PREFIXES.iter().filter(|prefix| prefix.is_common);
    let short = bases
        .clone()
        .filter(|base| base.len() <= 2 || *base == "bar");
    let prefixed = common.flat_map(move |prefix| {
        let short = short.clone();
        short.map(|base| format!("{}{base}", prefix.sign))
    });
    bases.map(str::to_owned).chain(prefixed)
}

#[cfg(test)]
mod tests {
    use super::super::{Dimension, WrittenQuantity};
    use super::*;

    #[test]
    fn names_of_units_are_understood() {
        let foreign = FOREIGN.iter().map(|(_, unit, ..)| unit);
        for unit in NAMES.iter().map(|(unit, _)| unit).chain(foreign) {
            let (size, dimension) = to_si(1.0, [(*unit, 1)]);
            assert!((size, dimension) != (1.0, Dimension::NUMBER), "{unit}");
        }
    }

    #[test]
    fn units_are_suggested() {
        let kinds = [
            QuantityKind::TIME,
            QuantityKind::MASS,
            QuantityKind::RATE,
            QuantityKind::TICKS,
            QuantityKind::VISCOSITY,
        ];
        let suggestion = |word| {
            suggested_unit(word, &kinds).map(|suggestion| (suggestion.word, suggestion.clear))
        };
        let clear = |word: &str| Some((word.to_owned(), true));
        assert_eq!(suggestion("seconds"), clear("s"));
        assert_eq!(suggestion("KG"), clear("kg"));
        assert_eq!(suggestion("khz"), clear("kHz"));
        assert_eq!(suggestion("tics"), clear("ticks"));
        assert_eq!(suggestion("mss"), Some(("ms".to_owned(), false)));
        assert_eq!(suggestion("mPas"), clear("mPa s"));
        assert_eq!(suggestion("furlong"), None);
    }

    /// Returns unit symbols that the grammar does not read, such as laboratory units and
    /// misspellings.
    fn words() -> Vec<String> {
        let odd = [
            "mcg", "mcm", "mcL", "mbr", "torr", "cst", "cSt", "kgm", "Nm", "Ns", "mPas", "ccm",
            "rps", "rps", "hz", "PSI", "lbs", "gauss", "oe", "c", "f", "mol", "mM", "dm", "hPa",
        ];
        let mut words: Vec<String> = odd.map(str::to_owned).to_vec();
        for unit in symbols() {
            words.push(unit.to_uppercase());
            words.extend(["m", "a", "s"].map(|letter| format!("{unit}{letter}")));
            words.extend(["m", "c", "x"].map(|letter| format!("{letter}{unit}")));
            words.extend(unit.char_indices().map(|(i, _)| {
                let (before, behind) = unit.split_at(i);
                format!("{before}x{}", behind.get(1..).unwrap_or_default())
            }));
        }
        words
    }

    #[test]
    fn suggestions_have_the_expected_dimension() {
        let words = words();
        for kind in QuantityKind::ALL {
            let suggested = words
                .iter()
                .filter_map(|word| suggested_unit(word, &[*kind]));
            for suggestion in suggested {
                let text = format!("1 {}", suggestion.word);
                let (_, dimension) = WrittenQuantity::parse(&text).unwrap().to_si();
                assert_eq!(dimension, kind.dimension, "{text} for {}", kind.noun);
            }
        }
    }

    #[test]
    fn foreign_units_are_converted() {
        for (values, word, written) in [
            (&[2.0][..], "mmHg", "266.64477483 Pa"),
            (&[1.0], "atm", "101325 Pa"),
            (&[20.0], "degC", "293.15 K"),
            (&[68.0], "degF", "293.15 K"),
            (&[1.0, 3.0], "inch", "2.54 .. 7.62 cm"),
        ] {
            assert_eq!(converted(values, word, &[]).as_deref(), Some(written));
        }
        assert_eq!(converted(&[1.0], "furlong", &[]), None);
        assert_eq!(converted(&[1.0], "atm", &[QuantityKind::LENGTH]), None);
    }
}
