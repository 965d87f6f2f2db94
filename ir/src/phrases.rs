//! Numbers of things in words.

/// So many of what has this name, the plural of which is regular: `1 entry`, `2 entries`.
pub fn counted(count: usize, noun: &str) -> String {
    match (count, noun.strip_suffix('y')) {
        (1, _) => format!("1 {noun}"),
        (count, Some(stem)) if !stem.ends_with(['a', 'e', 'o', 'u']) => {
            format!("{count} {stem}ies")
        }
        (count, _) => format!("{count} {noun}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_one_and_the_rest_are_many() {
        let told = [
            (0, "block"),
            (1, "block"),
            (2, "block"),
            (1, "entry"),
            (2, "entry"),
            (2, "way"),
        ];
        let told = told.map(|(count, noun)| counted(count, noun));
        let expected = [
            "0 blocks",
            "1 block",
            "2 blocks",
            "1 entry",
            "2 entries",
            "2 ways",
        ];
        assert_eq!(told, expected);
    }
}
