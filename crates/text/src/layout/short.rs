//! Shortens names.
use crate::visible;

/// Shortens a name to a number of letters by leaving out its middle.
pub fn short(name: &str, letters: usize) -> String {
    let signs: Vec<char> = visible(name).chars().collect();
    if signs.len() <= letters {
        return signs.into_iter().collect();
    }
    let half = letters.saturating_sub(1) / 2;
    let (head, tail) = (&signs[..letters - 1 - half], &signs[signs.len() - half..]);
    head.iter().chain(&['…']).chain(tail).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn long_names_retain_both_ends() {
        assert_eq!(super::short("abcdefghij", 5), "ab…ij");
        assert_eq!(super::short("abcde", 5), "abcde");
    }
}
