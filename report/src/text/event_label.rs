//! Events that a program has more than once.
use std::collections::HashMap;

/// What the first `most` of a program's events are called in a table: as the program writes them, and with the phase where it has
/// another of the same words. Events are their words, and their phases.
pub fn event_labels(events: &[(String, String)], most: usize) -> Vec<String> {
    let mut counts: HashMap<&str, usize> = HashMap::new();
    for (words, _) in events {
        *counts.entry(words).or_default() += 1;
    }
    let shown = events.iter().take(most);
    shown
        .map(|(words, phase)| match counts[words.as_str()] {
            1 => words.clone(),
            _ => format!("{words} (phase {phase})"),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn events_of_the_same_words_have_their_phases() {
        let events = [
            ("A.up -> B", "one"),
            ("A.up -> C", "one"),
            ("A.up -> B", "two"),
        ];
        let events = events.map(|(words, phase)| (words.to_owned(), phase.to_owned()));
        let labels = super::event_labels(&events, 2);
        assert_eq!(labels, ["A.up -> B (phase one)", "A.up -> C"]);
    }
}
