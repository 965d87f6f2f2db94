//! Expands programs and aggregates.
use stochc_grammar::tree::{Aggregate, Assembly};
use stochc_grammar::{Cancellation, Cancelled, Symbols};

use super::declared_items::Shapes;
use super::expander::{Declarations, Expander, Pass};
use super::limits::{ExpansionSettings, Limits, UNCOUNTED};
use super::probe::Probe;
use crate::diagnostic::{Code, Diagnostic};
use crate::expanded::ExpandedProgram;
use crate::{FileId, Sources};

/// An expanded program, and the shapes that its phases can claim.
pub type Expanded<'a> = (ExpandedProgram, Shapes<'a>);

/// Expands a program.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub(crate) fn expand<'a>(
    declarations: &Declarations<'a>,
    assembly: (FileId, &'a Assembly),
    sources: &Sources,
    symbols: &mut Symbols,
    settings: ExpansionSettings<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Expanded<'a>, Cancelled> {
    let mut nowhere = Probe::default();
    expand_probed(
        declarations,
        assembly,
        sources,
        symbols,
        settings,
        diagnostics,
        &mut nowhere,
    )
}

/// Expands a program like [`expand`], and records the blocks that a source location names.
pub(crate) fn expand_probed<'a>(
    declarations: &Declarations<'a>,
    (file, assembly): (FileId, &'a Assembly),
    sources: &Sources,
    symbols: &mut Symbols,
    settings: ExpansionSettings<'_>,
    diagnostics: &mut Vec<Diagnostic>,
    probe: &mut Probe,
) -> Result<Expanded<'a>, Cancelled> {
    let ExpansionSettings {
        limits,
        cancellation,
        ..
    } = settings;
    let mut attempt = |limits: Limits, pass: Pass, probe: &mut Probe| {
        let mut reported = Vec::new();
        let mut expander = Expander::new(
            declarations,
            (file, assembly.name),
            sources,
            symbols,
            ExpansionSettings { limits, ..settings },
            &mut reported,
            probe,
        );
        expander.pass = pass;
        expander.assembly(assembly);
        expander.plan.steps = expander.steps;
        let (plan, shapes, outgrown) = (expander.plan, expander.declared.shapes, expander.outgrown);
        // A cancelled expansion is incomplete.
        cancellation.check()?;
        Ok((plan, shapes, outgrown, reported))
    };
    let few = Limits {
        events: limits.events / UNCOUNTED,
        ..limits
    };
    let (mut plan, mut shapes, outgrown, mut reported) = attempt(few, Pass::Writing, probe)?;
    if outgrown {
        (plan, shapes, _, reported) = attempt(limits, Pass::Counting, &mut Probe::default())?;
        let is_limit = |diagnostic: &Diagnostic| diagnostic.code == Code::ExpansionLimit;
        if !reported.iter().any(is_limit) {
            (plan, shapes, _, reported) = attempt(limits, Pass::Writing, probe)?;
        }
    }
    diagnostics.append(&mut reported);
    Ok((plan, shapes))
}

/// Expands an aggregate to one phase for each size.
pub(crate) fn expand_aggregate(
    declarations: &Declarations<'_>,
    (file, aggregate): (FileId, &Aggregate),
    sources: &Sources,
    symbols: &mut Symbols,
    diagnostics: &mut Vec<Diagnostic>,
) -> ExpandedProgram {
    let settings = ExpansionSettings {
        limits: Limits::default(),
        parameters: &[],
        cancellation: Cancellation::NEVER,
    };
    let mut nowhere = Probe::default();
    let mut expander = Expander::new(
        declarations,
        (file, aggregate.name),
        sources,
        symbols,
        settings,
        diagnostics,
        &mut nowhere,
    );
    expander.aggregate(aggregate);
    expander.plan
}
