//! Parsing of options that consist of two numbers.
use std::str::FromStr;

/// Parses two numbers, such as `2, 1`. Returns `None` for any other text.
pub fn pair<T: FromStr>(text: &str) -> Option<(T, T)> {
    let (one, other) = text.split_once(',')?;
    Some((one.trim().parse().ok()?, other.trim().parse().ok()?))
}
