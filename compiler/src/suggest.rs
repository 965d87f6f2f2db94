//! The nearest known word to an unknown one.

/// Words that are compared at most, so that a large program with many errors stays quick.
const MOST: usize = 5_000;

/// ``did you mean `tower`?``, if a known word is near enough.
pub fn suggest<S: AsRef<str>>(unknown: &str, known: impl IntoIterator<Item = S>) -> Option<String> {
    if unknown.len() > 64 {
        return None;
    }
    let mut best: Option<(usize, S)> = None;
    for word in known.into_iter().take(MOST) {
        let near = word.as_ref().len().abs_diff(unknown.len()) <= 3;
        if !near || word.as_ref() == unknown {
            continue;
        }
        let distance = strsim::damerau_levenshtein(unknown, word.as_ref());
        let nearer = match &best {
            None => true,
            Some((least, chosen)) => (distance, word.as_ref()) < (*least, chosen.as_ref()),
        };
        if nearer {
            best = Some((distance, word));
        }
    }
    let (distance, word) = best?;
    let letters = |word: &str| word.chars().count();
    let longest = letters(unknown).max(letters(word.as_ref()));
    // Two names of one letter have nothing in common.
    let near = distance <= longest.div_ceil(3) && distance < longest
        || unknown.eq_ignore_ascii_case(word.as_ref());
    near.then(|| format!("did you mean `{}`?", word.as_ref()))
}

#[cfg(test)]
mod tests {
    use super::suggest;

    #[test]
    fn near_words_are_suggested_and_far_ones_not() {
        let known = ["tower", "bridge", "T[2]"];
        assert_eq!(
            suggest("towr", known).as_deref(),
            Some("did you mean `tower`?")
        );
        assert_eq!(
            suggest("T[3]", known).as_deref(),
            Some("did you mean `T[2]`?")
        );
        assert_eq!(suggest("platform", known), None);
        assert_eq!(suggest("M", ["X"]), None);
        assert_eq!(suggest("m", ["M"]).as_deref(), Some("did you mean `M`?"));
    }
}
