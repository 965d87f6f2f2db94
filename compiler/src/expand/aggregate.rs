//! Expands aggregates. An aggregate has one phase for each size of the largest group of free
//! blocks.
use stochc_grammar::tree::Aggregate;

use super::expander::Expander;
use crate::diagnostic::{Code, Diagnostic};
use crate::expanded::ExpandedPhase;

/// Largest size of an aggregate \[blocks\].
const MAX_SIZE: i64 = 10_000;

impl Expander<'_, '_> {
    /// Expands the phases of an aggregate. Each phase is named after the size that ends it.
    pub fn aggregate(&mut self, aggregate: &Aggregate) {
        let timeout = self.time(aggregate.timeout.as_ref(), "timeout");
        let Some(value) = self.evaluate(&aggregate.size) else {
            return;
        };
        let location = self.location(aggregate.size.span);
        let size = u32::try_from(value).ok();
        let Some(size) = size.filter(|_| (2..=MAX_SIZE).contains(&value)) else {
            self.diagnostics.push(
                Diagnostic::new(
                    Code::WrongValue,
                    format!("an aggregate cannot have {value} blocks"),
                )
                .label(location, format!("must be from 2 to {MAX_SIZE}"))
                .help("write the number of bonded blocks that completes it: `aggregate NAME to 8`"),
            );
            return;
        };
        self.plan.aggregate = Some(size);
        self.plan.phases = (2..=size)
            .map(|size| ExpandedPhase {
                name: size.to_string(),
                location,
                timeout,
                events: 0..0,
                pre_attached: false,
                claims: Vec::new(),
                recovery: None,
                waits: Vec::new(),
            })
            .collect();
    }
}
