//! Labels that distinguish the events of a program.
use std::collections::HashMap;
use std::hash::Hash;

/// Returns a label for each event of `shown`: the event's text. The phase of the event follows if
/// `all` contains its action twice. `shown` contains the action, the text and the phase of each
/// event.
pub fn event_labels<'a, A: Eq + Hash>(
    all: impl IntoIterator<Item = A>,
    shown: impl IntoIterator<Item = (A, String, &'a str)>,
) -> Vec<String> {
    let mut counts: HashMap<A, usize> = HashMap::new();
    for action in all {
        *counts.entry(action).or_default() += 1;
    }
    let labels = shown.into_iter();
    labels
        .map(|(action, words, phase)| match counts.get(&action) {
            Some(2..) => format!("{words} (phase {phase})"),
            _ => words,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn equal_labels_are_distinguished_by_phase() {
        let events = [
            ("A.up -> B", "one"),
            ("A.up -> C", "one"),
            ("A.up -> B", "two"),
        ];
        let all = events.map(|(words, _)| words);
        let shown = events.map(|(words, phase)| (words, words.to_owned(), phase));
        let labels = super::event_labels(all, shown.into_iter().take(2));
        assert_eq!(labels, ["A.up -> B (phase one)", "A.up -> C"]);
    }
}
