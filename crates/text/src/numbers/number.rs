//! Formats numbers as text.

/// Returns a number as text, with commas between thousands, a minus sign and few digits.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        return value.to_string();
    }
    if size != 0.0 && !(1e-4..1e15).contains(&size) {
        return format!("{value:.3e}");
    }
    let digits = decimals(size);
    let text = format!("{value:.digits$}");
    let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
    let fraction = fraction.trim_end_matches('0');
    let (sign, whole) = match whole.strip_prefix('-') {
        Some(whole) => ("−", whole),
        None => ("", whole),
    };
    let mut parted = String::new();
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i).is_multiple_of(3) {
            parted.push(',');
        }
        parted.push(digit);
    }
    match fraction {
        "" => format!("{sign}{parted}"),
        _ => format!("{sign}{parted}.{fraction}"),
    }
}

/// Returns a value and the half-width of its interval as text, with the same number of decimals:
/// `44.8 ± 9.9`.
pub fn interval(value: f64, half: f64) -> String {
    let digits = decimals(value.abs());
    let rounded = format!("{half:.digits$}");
    let is_shown = rounded.bytes().any(|byte| (b'1'..=b'9').contains(&byte));
    match digits {
        _ if !is_shown => format!("{} ± {}", number(value), number(half)),
        // Thousands have commas.
        0 => format!("{} ± {}", number(value), number(half.round())),
        _ => format!("{value:.digits$} ± {rounded}"),
    }
}

/// Returns the number of decimals of a number of this size.
fn decimals(size: f64) -> usize {
    match size {
        s if s >= 100.0 => 0,
        s if s >= 10.0 => 1,
        s if s >= 1.0 => 2,
        s if s >= 0.1 => 3,
        _ => 5,
    }
}

/// Returns a ratio with two digits.
pub fn ratio(ratio: f64) -> String {
    match ratio {
        r if r >= 9.95 => format!("{r:.0}"),
        r if r >= 0.995 => format!("{r:.1}"),
        r if r >= 0.0995 => format!("{r:.2}"),
        r => format!("{r:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.0, "0"),
            (5178.4, "5,178"),
            (1_000_000.0, "1,000,000"),
            (-1234.0, "−1,234"),
            (12.34, "12.3"),
            (0.25, "0.25"),
            (2.0, "2"),
            (0.000_001, "1.000e-6"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn intervals_have_the_decimals_of_the_value() {
        let cases = [
            (44.82, 9.87, "44.8 ± 9.9"),
            (5178.4, 1234.5, "5,178 ± 1,235"),
            (0.25, 0.0312, "0.250 ± 0.031"),
            (1500.0, 0.6, "1,500 ± 1"),
            (1500.0, 0.3, "1,500 ± 0.3"),
            (44.82, 0.01, "44.8 ± 0.01"),
            (1500.0, 0.0, "1,500 ± 0"),
            (-1500.0, 12.0, "−1,500 ± 12"),
        ];
        for (value, half, text) in cases {
            assert_eq!(interval(value, half), text);
        }
    }
}
