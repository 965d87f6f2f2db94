//! Tries remedies as changes of the source.
use super::analysis::ReachAnalysis;
use super::closable_phase::ClosablePhase;
use super::edit::CaptureStatement;
use super::proposal::{Proposal, ReportedError};
use crate::SourceLocation;
use crate::check::trial::OF_AN_EVENT;
use crate::diagnostic::{Code, Fix};
use crate::expanded::EventId;

/// A statement that must wait for the capture of a block.
#[derive(Clone)]
struct DelayedStatement<'a> {
    statement: CaptureStatement<'a>,
    location: SourceLocation,
    /// Name of the block that it must wait for.
    name: String,
}

/// Largest number of sets that are tried for one cell. Each set contains captures to delay.
const MAX_LISTS: usize = 6;
/// Largest number of spellings that are tried for one set of captures.
const MAX_WRITINGS: usize = 16;
/// Largest number of further spellings that are tried after a successful one.
const MAX_BETTER: usize = 3;
/// Fixed cost of a trial, as a number of events.
const OVERHEAD: u64 = 250;

impl<'a> ReachAnalysis<'a> {
    /// Returns a minimal change that removes the error of capture `id` with this title and causes
    /// no other error. Each set in `first` contains captures to delay until `id` has happened.
    pub fn proposal(
        &mut self,
        phase: &ClosablePhase,
        id: EventId,
        first: Vec<Vec<EventId>>,
        title: &str,
    ) -> Option<Proposal> {
        let error = (Code::SealedCavity, title.to_owned());
        // A proposed change for another capture may also fix this error.
        let before = self.untouched.as_deref().unwrap_or_default();
        let is_fixed = |after: &[ReportedError]| count(after, &error) < count(before, &error);
        if let Some((_, known)) = self.proposed.iter().find(|(after, _)| is_fixed(after)) {
            return Some(known.clone());
        }
        let plan = self.subject.plan;
        let mut lists = first;
        let mut barred: Vec<SourceLocation> = Vec::new();
        for i in 0..MAX_LISTS {
            let later = lists.get(i)?;
            // The spelling with the fewest remaining errors. Among equals, the likeliest one.
            let mut best: Option<(Vec<ReportedError>, Vec<DelayedStatement<'a>>)> = None;
            let mut tried = 0;
            for delayed in self.writings(id, later) {
                let Some(after) = self.errors_after(&error, &delayed) else {
                    break;
                };
                let is_better = |after: &Vec<ReportedError>| {
                    (best.as_ref()).is_none_or(|(least, _)| after.len() < least.len())
                };
                if let Some(after) = after.filter(is_better) {
                    best = Some((after, delayed));
                }
                tried += usize::from(best.is_some());
                let is_perfect = best.as_ref().is_some_and(|(after, _)| after.is_empty());
                if is_perfect || tried > MAX_BETTER {
                    break;
                }
            }
            if best.is_none() && self.trials.is_spent() {
                return None;
            }
            if let Some((mut after, mut delayed)) = best {
                let mut i = 0;
                while i < delayed.len() && delayed.len() > 1 {
                    let mut fewer = delayed.clone();
                    fewer.remove(i);
                    match self.errors_after(&error, &fewer) {
                        Some(Some(left)) => (after, delayed) = (left, fewer),
                        Some(None) => i += 1,
                        None => break,
                    }
                }
                let proposal = self.propose(phase, &delayed);
                self.proposed.push((after, proposal.clone()));
                return Some(proposal);
            }
            // Other statements may keep the path open.
            barred.extend(later.iter().map(|&other| plan.event(other).location));
            if let (Some(apart), true) = (&phase.apart, i + 1 == lists.len()) {
                lists.extend(self.later(phase, apart, id, &barred));
            }
        }
        None
    }

    /// Returns the possible spellings of statements that make captures wait for a block, the
    /// likeliest first.
    fn writings(&self, id: EventId, later: &[EventId]) -> Vec<Vec<DelayedStatement<'a>>> {
        let plan = self.subject.plan;
        let role = plan.event(id).role;
        let mut statements: Vec<(CaptureStatement<'a>, SourceLocation, Vec<String>)> = Vec::new();
        for &other in later {
            let location = plan.event(other).location;
            if statements.iter().any(|(_, known, _)| *known == location) {
                continue;
            }
            let Some(statement) = CaptureStatement::new(&self.subject, other) else {
                return Vec::new();
            };
            let names = statement.names(&self.subject, other, role);
            if names.is_empty() {
                return Vec::new();
            }
            statements.push((statement, location, names));
        }
        let most = statements.iter().map(|(.., names)| names.len()).max();
        (0..most.unwrap_or(0).min(MAX_WRITINGS))
            .map(|choice| {
                let delayed = |(statement, location, names): &(
                    CaptureStatement<'a>,
                    SourceLocation,
                    Vec<String>,
                )| {
                    DelayedStatement {
                        statement: *statement,
                        location: *location,
                        name: names[choice.min(names.len() - 1)].clone(),
                    }
                };
                statements.iter().map(delayed).collect()
            })
            .collect()
    }

    fn fix(&self, delayed: &[DelayedStatement<'a>]) -> Fix {
        let mut names: Vec<String> = delayed
            .iter()
            .map(|delayed| format!("`{}`", delayed.name))
            .collect();
        names.dedup();
        Fix {
            title: format!("wait for {}", names.join(" and ")),
            edits: (delayed.iter())
                .flat_map(|delayed| delayed.statement.wait(&self.subject, &delayed.name))
                .collect(),
            safe: false,
        }
    }

    fn propose(&self, phase: &ClosablePhase, delayed: &[DelayedStatement<'a>]) -> Proposal {
        let plan = self.subject.plan;
        let mut fix = self.fix(delayed);
        if let [delayed] = delayed {
            let mut made = plan
                .events
                .iter()
                .filter(|event| event.location == delayed.location);
            let is_plain = made
                .next()
                .is_some_and(|event| plan.roles.key(event.role).scope == 0);
            // Such changes keep the structure, and all agree with one order of the phase.
            fix.safe = is_plain && made.next().is_none() && phase.is_whole();
        }
        let text =
            |delayed: &DelayedStatement<'a>| delayed.statement.text(&self.subject).to_owned();
        Proposal {
            waits: delayed
                .iter()
                .map(|delayed| (text(delayed), delayed.name.clone()))
                .collect(),
            fix,
        }
    }

    /// Returns the errors that remain after a change. `Some(None)` means that the change does not
    /// remove `error`, or causes another error. `None` means that the limit of trials is reached.
    fn errors_after(
        &mut self,
        error: &ReportedError,
        delayed: &[DelayedStatement<'a>],
    ) -> Option<Option<Vec<ReportedError>>> {
        let trial = self.subject.trial.filter(|_| !self.trials.is_spent())?;
        let plan = self.subject.plan;
        self.trials.steps += (plan.events.len() + plan.steps / OF_AN_EVENT) as u64 + OVERHEAD;
        let before = match self.untouched.take() {
            Some(before) => before,
            None => trial(&[])?,
        };
        let left = trial(&[&self.fix(delayed)]).filter(|after| {
            count(after, error) < count(&before, error)
                && (after.iter()).all(|one| count(after, one) <= count(&before, one))
        });
        self.untouched = Some(before);
        Some(left)
    }
}

fn count(errors: &[ReportedError], one: &ReportedError) -> usize {
    errors.iter().filter(|errors| *errors == one).count()
}
