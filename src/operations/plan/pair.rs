//! Two numbers that belong together, as options have them.
use std::str::FromStr;

/// Reads `2, 1`.
pub fn pair<T: FromStr>(text: &str) -> Option<(T, T)> {
    let (one, other) = text.split_once(',')?;
    Some((one.trim().parse().ok()?, other.trim().parse().ok()?))
}
