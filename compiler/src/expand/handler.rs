//! Expands the handler of a phase's timeout.
use stochc_grammar::Span;
use stochc_grammar::tree::{Expr, ItemKind, PhaseDeclaration, Place, TimeoutHandler};

use super::expander::{Expander, Pass};
use crate::diagnostic::{Code, Diagnostic};
use crate::expanded::{EventKind, PhaseRecovery};

/// Largest number of repetitions of a phase.
const MAX_RETRIES: i64 = 1000;

impl Expander<'_, '_> {
    /// Returns the reaction to a timeout of a phase whose first event is `start`. Reports errors
    /// of the handler. Returns `None` without a valid handler.
    pub(super) fn recovery(
        &mut self,
        phase: &PhaseDeclaration,
        start: u32,
    ) -> Option<PhaseRecovery> {
        let handler = phase.handler.as_deref()?;
        let name = self.sources.text(self.location(phase.name.span)).to_owned();
        if phase.timeout.is_none() {
            let title = format!("phase `{name}` has no timeout");
            let label = "this handler is never used";
            self.reject_handler(
                title,
                head(handler),
                label,
                format!("write `phase {name} timeout 40000 ticks {{`"),
            );
            return None;
        }
        let count = self.handler_statements(handler, phase, &name)?;
        let retries = self.retries(count);
        let pause = handler.body.iter().find_map(|item| match &item.kind {
            ItemKind::Wait(quantity) => Some(quantity),
            _ => None,
        });
        let pause = pause.map(|quantity| self.time(Some(quantity), "`wait`"));
        if self.pass == Pass::Writing {
            let events = self.plan.events.get(start as usize..).unwrap_or_default();
            let release = events.iter().find(|it| it.kind == EventKind::Release);
            if let Some(release) = release.copied() {
                let diagnostic = Diagnostic::new(
                    Code::InvalidHandler,
                    format!("phase `{name}` releases a block and cannot be retried"),
                )
                .label(release.location, "this release cannot be undone")
                .label(self.location(head(handler)), "the phase would begin again")
                .help("write the releases in a phase of their own, without `on timeout`");
                self.diagnostics.push(diagnostic);
                return None;
            }
        }
        Some(PhaseRecovery {
            retries: retries?,
            pause: match pause {
                Some(pause) => Some(pause?),
                None => None,
            },
        })
    }

    /// Checks the statements of a handler: `release PHASE`, optionally `wait`, then `retry`.
    /// Returns the number of retries as written. Returns `None` after an error.
    fn handler_statements<'h>(
        &mut self,
        handler: &'h TimeoutHandler,
        phase: &PhaseDeclaration,
        name: &str,
    ) -> Option<&'h Expr> {
        let kinds: Vec<&ItemKind> = handler.body.iter().map(|item| &item.kind).collect();
        let (release, count) = match kinds[..] {
            [ItemKind::Release(release), ItemKind::Retry(count)]
            | [
                ItemKind::Release(release),
                ItemKind::Wait(_),
                ItemKind::Retry(count),
            ] => (release, count),
            _ => {
                let title = format!("the handler of phase `{name}` is incomplete");
                let label = "statements are missing or in another order";
                self.reject_handler(
                    title,
                    head(handler),
                    label,
                    format!("write `release {name}`, then `wait 20 s` if needed, then `retry 3`"),
                );
                return None;
            }
        };
        let is_own = match &release.places[..] {
            [place] if release.delay.is_none() => {
                release.after.is_empty() && self.is_phase(place, &phase.name)
            }
            _ => false,
        };
        if !is_own {
            let span = release.places.first().map_or(head(handler), |it| it.span);
            let title = format!("a handler of phase `{name}` releases the whole phase");
            let label = "not the name of the phase";
            self.reject_handler(title, span, label, format!("write `release {name}`"));
        }
        is_own.then_some(count)
    }

    fn is_phase(&mut self, place: &Place, phase: &Place) -> bool {
        if place.face.is_some() || place.path.len() != 1 {
            return false;
        }
        let name = self.single_key(place);
        name.is_some() && name == self.single_key(phase)
    }

    fn retries(&mut self, count: &Expr) -> Option<u32> {
        let value = self.evaluate(count)?;
        if (1..=MAX_RETRIES).contains(&value) {
            return u32::try_from(value).ok();
        }
        let diagnostic = Diagnostic::about(
            Code::WrongValue,
            "a phase cannot be retried {} times",
            &[&value.to_string()],
        )
        .label(
            self.location(count.span),
            format!("must be from 1 to {MAX_RETRIES}"),
        )
        .help("without `on timeout`, a timeout ends the run");
        self.diagnostics.push(diagnostic);
        None
    }

    fn reject_handler(&mut self, title: String, span: Span, label: &str, help: String) {
        let diagnostic = Diagnostic::new(Code::InvalidHandler, title)
            .label(self.location(span), label)
            .help(help);
        self.diagnostics.push(diagnostic);
    }
}

/// Returns the location of the first word of a handler.
fn head(handler: &TimeoutHandler) -> Span {
    let start = handler.span.start;
    Span::new(start, start + "on".len() as u32)
}
