//! Short text of many numbers.

/// Returns ascending numbers as text, with ranges such as `0-4` and a separator between them.
pub fn ranges(numbers: &[u64], between: &str) -> String {
    let stretches = numbers.chunk_by(|a, b| a + 1 == *b);
    let each = stretches.map(|stretch| match stretch {
        [first, .., last] => format!("{first}-{last}"),
        [one] => one.to_string(),
        [] => String::new(),
    });
    each.collect::<Vec<_>>().join(between)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_printed_by_their_ends() {
        assert_eq!(ranges(&[0, 1, 2, 4, 6, 7], ", "), "0-2, 4, 6-7");
        assert_eq!(ranges(&[], ","), "");
    }
}
