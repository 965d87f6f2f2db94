//! Expands claims about runs.
use stochc_grammar::Span;
use stochc_grammar::tree::{Expectation, ExpectedEvent, Place, Quantity};
use stochc_ir::scene::units::Dimension;

use super::expander::{Expander, Pass};
use super::units::to_si;
use crate::SourceLocation;
use crate::diagnostic::{Code, Diagnostic};
use crate::expanded::{ClaimKind, ExpandedClaim, ExpandedEventName, NameKey};

impl Expander<'_, '_> {
    /// Expands a claim. Reports wrong numbers. Names are resolved after the expansion.
    pub(super) fn claim(&mut self, claim: &Expectation, span: Span) {
        self.grown.claims += 1;
        let Some(kind) = self.claim_kind(claim) else {
            return;
        };
        if self.pass == Pass::Writing {
            let location = self.location(span);
            self.plan.claims.push(ExpandedClaim { kind, location });
        }
    }

    fn claim_kind(&mut self, claim: &Expectation) -> Option<ClaimKind> {
        match claim {
            Expectation::Probability {
                event,
                within,
                relation,
                bound,
            } => {
                let event = self.event_name(event)?;
                let is_limited = within.is_some();
                let within = self.time(within.as_ref(), "time limit");
                let bound = self.fraction(bound, "probability", "0.95")?;
                (within.is_some() || !is_limited).then_some(ClaimKind::Probability {
                    event,
                    within,
                    relation: *relation,
                    bound,
                })
            }
            Expectation::Mean { relation, bound } => Some(ClaimKind::Mean {
                relation: *relation,
                bound: self.time(Some(bound), "mean time")?,
            }),
            Expectation::Faster { than, by } => Some(ClaimKind::Faster {
                than: (than.symbol, self.location(than.span)),
                by: match by {
                    Some(by) => self.fraction(by, "difference", "20 %")?,
                    None => 0.0,
                },
            }),
        }
    }

    fn event_name(&mut self, event: &ExpectedEvent) -> Option<ExpandedEventName> {
        Some(match event {
            ExpectedEvent::Complete => ExpandedEventName::Completion,
            ExpectedEvent::Phase(place) => {
                let key = self.single_key(place)?;
                let name = self.plan.roles.name_of(key, self.symbols);
                ExpandedEventName::Phase(name, self.location(place.span))
            }
            ExpectedEvent::Captured { block, by } => ExpandedEventName::Capture {
                block: self.claimed_block(block)?,
                by: self.claimed_block(by)?,
            },
        })
    }

    fn claimed_block(&mut self, place: &Place) -> Option<(NameKey, SourceLocation)> {
        let (key, _) = self.single(place, "write one claim for each block", None)?;
        Some((key, self.location(place.span)))
    }

    /// Returns a number between 0 and 1, both excluded. Reports other quantities. `noun` names
    /// the number in the message, and `example` a correct number.
    fn fraction(&mut self, quantity: &Quantity, noun: &str, example: &str) -> Option<f64> {
        let (value, dimension) = to_si(quantity);
        let (code, title, label) = if dimension != Dimension::NUMBER {
            (
                Code::WrongDimension,
                format!("a {noun} must be a number without a unit"),
                "this value has a unit",
            )
        } else if value > 0.0 && value < 1.0 {
            return Some(value);
        } else {
            (
                Code::WrongClaim,
                format!("a {noun} must be between 0 and 1"),
                "this value is 0, 1 or outside of this range",
            )
        };
        let diagnostic = Diagnostic::new(code, title).label(self.location(quantity.span), label);
        let help = format!("write a number such as `{example}`");
        self.diagnostics.push(diagnostic.help(help));
        None
    }
}
