//! Subjects of diagnostics that can be merged.
use stochc_text::listed;

/// Format of a title, with the subjects to insert.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Subjects {
    /// Diagnostics with the same format can be merged.
    pub(super) format: &'static str,
    /// One subject per `{}`, in backticks if the format has them.
    pub(super) words: Vec<String>,
}

impl Subjects {
    pub(super) fn new(format: &'static str, subjects: &[&str]) -> Subjects {
        let fragments: Vec<&str> = format.split("{}").collect();
        debug_assert_eq!(fragments.len(), subjects.len() + 1, "{format}");
        let is_quoted = |number: usize| fragments[number].ends_with('`');
        let words = subjects.iter().enumerate().map(|(number, subject)| {
            if is_quoted(number) {
                format!("`{subject}`")
            } else {
                (*subject).to_owned()
            }
        });
        Subjects {
            format,
            words: words.collect(),
        }
    }

    pub(super) fn title(&self) -> String {
        let mut fragments = self.format.split("{}");
        let mut title = fragments.next().unwrap_or_default().to_owned();
        for (word, fragment) in self.words.iter().zip(fragments) {
            title.push_str(word.trim_matches('`'));
            title.push_str(fragment);
        }
        title
    }

    /// Returns the first subject of `other` that differs, if the formats are the same.
    pub(super) fn difference<'a>(&self, other: &'a Subjects) -> Option<&'a str> {
        if self.format != other.format {
            return None;
        }
        let mut pairs = self.words.iter().zip(&other.words);
        let (_, word) = pairs.find(|(ours, theirs)| ours != theirs)?;
        Some(word)
    }
}

/// Other diagnostics that were merged into this one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Others {
    /// Number of merged diagnostics.
    pub count: usize,
    /// The first few subjects of merged diagnostics.
    pub first: Vec<String>,
}

impl Others {
    /// Largest number of subjects that are named.
    pub(super) const NAMED: usize = 2;

    /// Returns the text for merged diagnostics, such as ``; the same for `T[5]`, `T[6]` and 494
    /// more``. Empty if there are none.
    pub(super) fn text(&self) -> String {
        if self.first.is_empty() {
            String::new()
        } else {
            format!("; the same for {}", listed(&self.first, self.count))
        }
    }
}
