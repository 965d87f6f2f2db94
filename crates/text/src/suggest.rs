//! Suggestions for unknown words.

/// Largest number of words compared, to limit the time for large programs with many errors.
const MAX: usize = 5_000;

/// Known word that an unknown one probably means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suggestion {
    /// The suggested word.
    pub word: String,
    /// Whether the suggestion is unambiguous: one or two letters differ, and no other word is as
    /// close.
    pub clear: bool,
}

impl Suggestion {
    /// Returns the help: ``did you mean `tower`?``
    pub fn help(&self) -> String {
        format!("did you mean `{}`?", self.word)
    }
}

/// Returns the nearest known word. Returns `None` if no word is near enough.
pub fn nearest<S: AsRef<str>>(
    unknown: &str,
    known: impl IntoIterator<Item = S>,
) -> Option<Suggestion> {
    if unknown.len() > 64 {
        return None;
    }
    // Distance, difference in length, and word.
    let mut best: Option<(usize, usize, S)> = None;
    // Distance of the second nearest word.
    let mut second = usize::MAX;
    let mut count = 0;
    for word in known.into_iter().take(MAX) {
        count += 1;
        if word.as_ref() == unknown || is_far(unknown, word.as_ref()) {
            continue;
        }
        // Names of one letter are unrelated, whatever their indices.
        let stems = (stem(unknown), stem(word.as_ref()));
        if stems.0.len() == 1 && stems.1.len() == 1 && !stems.0.eq_ignore_ascii_case(stems.1) {
            continue;
        }
        let distance = strsim::damerau_levenshtein(unknown, word.as_ref());
        let length = unknown.len().abs_diff(word.as_ref().len());
        match &best {
            Some((.., chosen)) if chosen.as_ref() == word.as_ref() => {}
            Some((least, shortest, chosen))
                if (distance, length, word.as_ref()) >= (*least, *shortest, chosen.as_ref()) =>
            {
                second = second.min(distance);
            }
            _ => {
                second = best.map_or(second, |(least, ..)| second.min(least));
                best = Some((distance, length, word));
            }
        }
    }
    let (distance, _, word) = best?;
    let word = word.as_ref();
    let letters = |word: &str| word.chars().count();
    let longest = letters(unknown).max(letters(word));
    let near =
        distance <= longest.div_ceil(3) && distance < longest || unknown.eq_ignore_ascii_case(word);
    near.then(|| Suggestion {
        clear: count < MAX && is_slip(unknown, word, distance, second),
        word: word.to_owned(),
    })
}

/// Returns whether two words certainly differ too much for a suggestion, by a bound that is fast to
/// compute. A word that is too different also does not make another suggestion ambiguous.
fn is_far(one: &str, other: &str) -> bool {
    if one.len().abs_diff(other.len()) > 3 {
        return true;
    }
    if !one.is_ascii() || !other.is_ascii() || one.eq_ignore_ascii_case(other) {
        return false;
    }
    let (one, other) = (one.as_bytes(), other.as_bytes());
    let longest = one.len().max(other.len());
    // Letters that occur more often in one word must be inserted, deleted or changed.
    let mut more = [0_i8; 128];
    one.iter()
        .for_each(|&letter| more[usize::from(letter)] += 1);
    let common = other.iter().filter(|&&letter| {
        let more = &mut more[usize::from(letter)];
        *more -= 1;
        *more >= 0
    });
    longest - common.count() > longest.div_ceil(3)
}

/// Returns a name without its indices and enclosing instances.
fn stem(word: &str) -> &str {
    let bare = word.split('[').next().unwrap_or(word);
    if word.contains('.') {
        word.rsplit('.').next().map_or(bare, stem)
    } else {
        bare
    }
}

/// Returns whether a word is a misspelling of another one. `second` is the distance of the second
/// nearest word.
fn is_slip(unknown: &str, word: &str, distance: usize, second: usize) -> bool {
    // `T[2]` and `T[3]` are different names, not misspellings.
    let digits = |word: &str| -> String { word.chars().filter(char::is_ascii_digit).collect() };
    if digits(unknown) != digits(word) {
        return false;
    }
    let letters = word.chars().count();
    match distance {
        1 => letters >= 4 && second > 1,
        2 => letters >= 8 && second > 3,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn suggests_similar_words_only() {
        let help =
            |unknown, known: &[&str]| nearest(unknown, known).map(|suggestion| suggestion.help());
        let known = ["tower", "bridge", "T[2]"];
        let suggestion = |word: &str| Some(format!("did you mean `{word}`?"));
        assert_eq!(help("towr", &known), suggestion("tower"));
        assert_eq!(help("T[3]", &known), suggestion("T[2]"));
        assert_eq!(help("platform", &known), None);
        assert_eq!(help("M", &["X"]), None);
        assert_eq!(help("Q[1]", &["M[1]"]), None);
        assert_eq!(help("a[1].T", &["a[1].M", "M"]), None);
        assert_eq!(help("a.t[1]", &["a.T[1]"]), suggestion("a.T[1]"));
        assert_eq!(help("m", &["M"]), suggestion("M"));
        assert_eq!(help("ES", &["E", "SE", "S"]), suggestion("SE"));
        assert_eq!(help("TOWER", &["tower"]), suggestion("tower"));
        assert_eq!(
            help("reocnfigurate", &["reconfigured"]),
            suggestion("reconfigured")
        );
    }

    #[test]
    fn only_a_typo_of_one_letter_is_clear() {
        let clear =
            |unknown, known: &[&str]| nearest(unknown, known).map(|suggestion| suggestion.clear);
        assert_eq!(clear("phaze", &["phase", "shape"]), Some(true));
        assert_eq!(clear("relese", &["release", "scene"]), Some(true));
        assert_eq!(clear("towr", &["tower", "tower"]), Some(true));
        assert_eq!(clear("towr", &["tower", "town"]), Some(false));
        assert_eq!(clear("T[3]", &["T[2]"]), Some(false));
        assert_eq!(clear("leg1", &["legs1", "leg2"]), Some(false));
        assert_eq!(clear("tip", &["top"]), Some(false));
        assert_eq!(clear("m", &["M"]), Some(false));
        assert_eq!(clear("redundatn-atfer", &["redundant-after"]), Some(true));
    }
}
