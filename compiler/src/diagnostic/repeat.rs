//! One statement in a loop, or in a pattern, may be wrong many times: it is told of once.
use stochc_ir::listed;

use super::{Code, Diagnostic};

/// Findings like another one, at the same place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Others {
    /// How many there are.
    pub count: usize,
    /// What the first few speak of, as their titles write it.
    pub first: Vec<String>,
}

impl Others {
    /// How many are named.
    const NAMED: usize = 2;

    /// ``; the same for `T[5]`, `T[6]` and 494 more``
    pub(super) fn text(&self) -> String {
        if self.first.is_empty() {
            String::new()
        } else {
            format!("; the same for {}", listed(&self.first, self.count))
        }
    }
}

impl Diagnostic {
    /// Takes another finding in, if it says the same at the same place; at most of another block,
    /// cell or number.
    pub(super) fn absorb(&mut self, other: &Diagnostic) -> bool {
        let place = |diagnostic: &Diagnostic| diagnostic.labels.first().map(|label| label.location);
        if self.code != other.code || place(self) != place(other) || place(self).is_none() {
            return false;
        }
        if self.title == other.title {
            self.add_programs(&other.programs);
            return true;
        }
        // Several things may be missing at one place.
        if self.code == Code::MissingTerm {
            return false;
        }
        let Some(subject) = difference(&self.title, &other.title) else {
            return false;
        };
        // The text is the same, so that a change that is right for one is not for the other.
        if self.fix != other.fix {
            self.fix = None;
        }
        self.add_programs(&other.programs);
        let subject = subject.to_owned();
        if let Some(remedy) = &other.remedy {
            self.add_remedy(&subject, remedy);
        }
        if !self.others.first.contains(&subject) {
            self.others.count += 1 + other.others.count;
            if self.others.first.len() < Others::NAMED {
                self.others.first.push(subject);
            }
        }
        true
    }

    /// Has it be about these programs as well.
    fn add_programs(&mut self, programs: &[usize]) {
        self.programs.extend(programs);
        self.programs.sort_unstable();
        self.programs.dedup();
    }

    /// Adds what helps another one to the help, unless that has been said.
    fn add_remedy(&mut self, subject: &str, remedy: &str) {
        let (Some(help), Some(told)) = (&mut self.help, &mut self.remedy) else {
            return;
        };
        let more = match told.lines().count() {
            _ if told.contains(remedy) => return,
            0..=Others::NAMED => format!("for {subject}, {remedy}"),
            lines if lines == Others::NAMED + 1 => "others need changes of their own".to_owned(),
            _ => return,
        };
        let all = format!("{told}\n{more}");
        *help = help.replacen(told.as_str(), &all, 1);
        *told = all;
    }
}

/// What a title speaks of where another one, alike but for names and numbers, speaks of something
/// else.
fn difference<'a>(title: &str, other: &'a str) -> Option<&'a str> {
    let mut subject = None;
    let (mut ours, mut theirs) = (words(title), words(other));
    loop {
        match (ours.next(), theirs.next()) {
            (None, None) => return subject,
            (Some(one), Some(two)) if one == two => {}
            (Some(one), Some(two)) if is_subject(one) && is_subject(two) => {
                subject = subject.or(Some(two));
            }
            _ => return None,
        }
    }
}

/// Whether a word stands for something of the program: a name, a cell or a number.
fn is_subject(word: &str) -> bool {
    let number = word.strip_prefix('-').unwrap_or(word);
    word.starts_with(['`', '(']) || number.starts_with(|c: char| c.is_ascii_digit())
}

/// The words of a title; what stands between backticks or parentheses is one.
fn words(title: &str) -> impl Iterator<Item = &str> {
    let mut rest = title;
    std::iter::from_fn(move || {
        rest = rest.trim_start();
        let first = rest.chars().next()?;
        let closing = match first {
            '`' => rest[1..].find('`').map(|at| at + 2),
            '(' => rest.find(')').map(|at| at + 1),
            _ => None,
        };
        let end = closing.unwrap_or_else(|| {
            let is_end = |c: char| c.is_whitespace() || matches!(c, '`' | '(');
            let length = first.len_utf8();
            rest[length..]
                .find(is_end)
                .map_or(rest.len(), |at| at + length)
        });
        let (word, behind) = rest.split_at(end);
        rest = behind;
        Some(word)
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Code, Fix};
    use super::*;
    use crate::{FileId, SourceLocation, Span};

    fn at(start: u32, title: &str) -> Diagnostic {
        let location = SourceLocation {
            file: FileId(0),
            span: Span::new(start, start + 1),
        };
        Diagnostic::new(Code::AbsentBlock, title).label(location, "here")
    }

    fn told(titles: &[&str]) -> Vec<String> {
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        for title in titles {
            super::super::report(&mut diagnostics, at(0, title));
        }
        diagnostics.iter().map(Diagnostic::message).collect()
    }

    #[test]
    fn findings_of_one_place_that_differ_in_what_they_speak_of_are_one() {
        for (titles, message) in [
            (
                &["no block is called `T[1, 0]`"; 3][..],
                "no block is called `T[1, 0]`",
            ),
            (
                &["`T[1]` is absent", "`T[2]` is absent"],
                "`T[1]` is absent; the same for `T[2]`",
            ),
            (
                &[
                    "`T[1]` is absent",
                    "`T[2]` is absent",
                    "`T[2]` is absent",
                    "`U` is absent",
                ],
                "`T[1]` is absent; the same for `T[2]` and `U`",
            ),
            (
                &[
                    "a plate of -1 blocks",
                    "a plate of 0 blocks",
                    "a plate of -2 blocks",
                    "a plate of -3 blocks",
                ],
                "a plate of -1 blocks; the same for 0, -2 and 1 more",
            ),
            (
                &["(5, 0) is not on the plate", "(6, 0) is not on the plate"],
                "(5, 0) is not on the plate; the same for (6, 0)",
            ),
            (
                &[
                    "releasing `A` sets `B` adrift",
                    "releasing `C` sets `D` adrift",
                ],
                "releasing `A` sets `B` adrift; the same for `C`",
            ),
        ] {
            assert_eq!(told(titles), [message]);
        }
    }

    #[test]
    fn what_says_something_else_is_told_by_itself() {
        let titles = [
            "`T[1]` is absent",
            "`T[1]` is late",
            "`T[2]`",
            "it is absent",
        ];
        assert_eq!(told(&titles), titles);
        let mut diagnostics = vec![at(0, "`A` is absent")];
        super::super::report(&mut diagnostics, at(1, "`B` is absent"));
        assert_eq!(diagnostics.len(), 2);
        let nowhere = Diagnostic::new(Code::ImportMissing, "cannot read `a`");
        assert!(!nowhere.clone().absorb(&nowhere));
    }

    #[test]
    fn a_change_for_one_of_several_is_dropped() {
        let fix = |text: &str| {
            let diagnostic = at(0, text);
            let location = diagnostic.labels[0].location;
            diagnostic.fix(Fix::replace(location, text, "write it"))
        };
        let mut first = fix("no `A`");
        assert!(first.absorb(&fix("no `A`")));
        assert!(first.fix.is_some());
        assert!(first.absorb(&fix("no `B`")));
        assert!(first.fix.is_none());
    }
}
