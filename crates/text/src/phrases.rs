//! Numbers and lists in words.

/// Returns a count with its noun, with a regular plural: `1 entry`, `2 entries`.
pub fn counted(count: usize, noun: &str) -> String {
    match (count, noun.strip_suffix('y')) {
        (1, _) => format!("1 {noun}"),
        (count, Some(stem)) if !stem.ends_with(['a', 'e', 'o', 'u']) => {
            format!("{count} {stem}ies")
        }
        (count, _) => format!("{count} {noun}s"),
    }
}

/// Returns a series: `a`, `a or b`, `a, b or c`.
pub fn series(words: &[impl AsRef<str>], conjunction: &str) -> String {
    match words {
        [] => String::new(),
        [only] => only.as_ref().to_owned(),
        [init @ .., last] => {
            format!("{} {conjunction} {}", separated(init), last.as_ref())
        }
    }
}

/// Returns the first elements and the number of further ones: `a, b and c`, `a, b and 5 more`.
pub fn listed(first: &[impl AsRef<str>], count: usize) -> String {
    match count.saturating_sub(first.len()) {
        0 => series(first, "and"),
        more => format!("{} and {more} more", separated(first)),
    }
}

/// Returns words in backticks: `a`, `b`.
pub fn in_backticks(words: &[String]) -> String {
    let words: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
    words.join(", ")
}

fn separated(words: &[impl AsRef<str>]) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_end_with_a_conjunction_or_a_count() {
        assert_eq!(series(&[""; 0], "or"), "");
        assert_eq!(series(&["a"], "or"), "a");
        assert_eq!(series(&["a", "b", "c"], "or"), "a, b or c");
        assert_eq!(listed(&["a", "b"], 2), "a and b");
        assert_eq!(listed(&["a", "b"], 7), "a, b and 5 more");
    }

    #[test]
    fn nouns_agree_with_their_number() {
        let counts = [
            (0, "block"),
            (1, "block"),
            (2, "block"),
            (1, "entry"),
            (2, "entry"),
            (2, "way"),
        ];
        let counts = counts.map(|(count, noun)| counted(count, noun));
        let expected = [
            "0 blocks",
            "1 block",
            "2 blocks",
            "1 entry",
            "2 entries",
            "2 ways",
        ];
        assert_eq!(counts, expected);
    }
}
