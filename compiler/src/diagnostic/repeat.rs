//! Merges diagnostics of one statement that differ only in their subjects.
//!
//! A statement in a loop or pattern may cause the same error many times.
use super::Diagnostic;
use super::subjects::Others;

impl Diagnostic {
    /// Merges another diagnostic with the same code and location. Its title, or the format of its
    /// title, must be equal. Returns whether it was merged.
    pub(super) fn absorb(&mut self, other: &Diagnostic) -> bool {
        let place = |diagnostic: &Diagnostic| diagnostic.labels.first().map(|label| label.location);
        if self.code != other.code || place(self) != place(other) || place(self).is_none() {
            return false;
        }
        if self.title == other.title {
            self.add_programs(&other.programs);
            return true;
        }
        let subjects = self.subjects.as_ref().zip(other.subjects.as_ref());
        let Some(subject) = subjects.and_then(|(ours, theirs)| ours.difference(theirs)) else {
            return false;
        };
        // Both diagnostics are about the same source, so one change cannot fix both.
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

    fn add_programs(&mut self, programs: &[usize]) {
        self.programs.extend(programs);
        self.programs.sort_unstable();
        self.programs.dedup();
    }

    /// Adds the remedy of a merged diagnostic to the help if it is not there yet.
    fn add_remedy(&mut self, subject: &str, remedy: &str) {
        let (Some(help), Some(stated)) = (&mut self.help, &mut self.remedy) else {
            return;
        };
        let more = match stated.lines().count() {
            _ if stated.contains(remedy) => return,
            0..=Others::NAMED => format!("for {subject}, {remedy}"),
            lines if lines == Others::NAMED + 1 => "others need changes of their own".to_owned(),
            _ => return,
        };
        let all = format!("{stated}\n{more}");
        *help = help.replacen(stated.as_str(), &all, 1);
        *stated = all;
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Code, Fix};
    use super::*;
    use crate::{FileId, SourceLocation, Span};

    fn at(start: u32, format: &'static str, subjects: &[&str]) -> Diagnostic {
        let location = SourceLocation {
            file: FileId(0),
            span: Span::new(start, start + 1),
        };
        Diagnostic::about(Code::AbsentBlock, format, subjects).label(location, "here")
    }

    fn messages(format: &'static str, subjects: &[&[&str]]) -> Vec<String> {
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        for subjects in subjects {
            super::super::report(&mut diagnostics, at(0, format, subjects));
        }
        diagnostics.iter().map(Diagnostic::message).collect()
    }

    #[test]
    fn diagnostics_of_one_place_and_format_are_merged() {
        for (format, subjects, message) in [
            (
                "no block is called `{}`",
                &[&["T[1, 0]"][..]; 3][..],
                "no block is called `T[1, 0]`",
            ),
            (
                "`{}` is absent",
                &[&["T[1]"], &["T[2]"]],
                "`T[1]` is absent; the same for `T[2]`",
            ),
            (
                "`{}` is absent",
                &[&["T[1]"], &["T[2]"], &["T[2]"], &["U"]],
                "`T[1]` is absent; the same for `T[2]` and `U`",
            ),
            (
                "a plate of {} blocks",
                &[&["-1"], &["0"], &["-2"], &["-3"]],
                "a plate of -1 blocks; the same for 0, -2 and 1 more",
            ),
            (
                "{} is not on the plate",
                &[&["(5, 0)"], &["(6, 0)"]],
                "(5, 0) is not on the plate; the same for (6, 0)",
            ),
            (
                "releasing `{}` sets `{}` adrift",
                &[&["A", "B"], &["C", "D"]],
                "releasing `A` sets `B` adrift; the same for `C`",
            ),
        ] {
            assert_eq!(messages(format, subjects), [message]);
        }
    }

    #[test]
    fn other_formats_and_places_are_not_merged() {
        let mut diagnostics = vec![at(0, "`{}` is absent", &["A"])];
        super::super::report(&mut diagnostics, at(0, "`{}` is late", &["B"]));
        super::super::report(&mut diagnostics, at(1, "`{}` is absent", &["B"]));
        assert_eq!(diagnostics.len(), 3);
        let nowhere = Diagnostic::new(Code::ImportMissing, "cannot read `a`");
        assert!(!nowhere.clone().absorb(&nowhere));
    }

    #[test]
    fn a_fix_for_one_of_several_places_is_dropped() {
        let fix = |name: &str| {
            let diagnostic = at(0, "no `{}`", &[name]);
            let location = diagnostic.labels[0].location;
            diagnostic.fix(Fix::replace(location, name, "write it"))
        };
        let mut first = fix("A");
        assert!(first.absorb(&fix("A")));
        assert!(first.fix.is_some());
        assert!(first.absorb(&fix("B")));
        assert!(first.fix.is_none());
    }
}
