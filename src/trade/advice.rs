//! What to do, in a sentence or two.
use super::refine::{CLOSE, Convergence};
use super::report::{Reference, Rung, Trade};
use crate::statistics::Relative;

/// The sentences for a trade.
pub(super) fn advice(trade: &Trade) -> String {
    let (Some(known), Some(reference)) = (&trade.reference, trade.reference_rung()) else {
        return "Too few runs were completed to hold anything against a reference; more time \
                would help, or a larger `--max-ticks`."
            .to_owned();
    };
    let mut sentences = Vec::new();
    let doubt = match known.convergence {
        Convergence::Converged => None,
        Convergence::Undecided => Some("is not known to have converged"),
        Convergence::NotConverged => Some("has not converged"),
    };
    if let Some(doubt) = doubt {
        sentences.push(format!(
            "The reference, `{}`, {doubt}, so that biases are against it and not against the limit \
             of small steps.",
            reference.options
        ));
    }
    let mut clauses: Vec<String> = recommended(trade).into_iter().map(clause).collect();
    if clauses.is_empty() {
        clauses.push(format!(
            "no setting that is cheaper than the reference, `{}`, is known to be within {} of it",
            reference.options,
            percent(CLOSE)
        ));
    }
    sentences.push(capital(&format!("{}.", clauses.join("; "))));
    let reversed: Vec<String> = (trade.rungs.iter())
        .filter(|rung| rung.reversed)
        .map(|rung| format!("`{}`", rung.options))
        .collect();
    if !reversed.is_empty() {
        sentences.push(format!(
            "Do not compare programs with {}: the order of some comes out reversed.",
            reversed.join(", ")
        ));
    }
    sentences.join(" ")
}

/// The cheapest rung that is known to be close, and the one that is known to be closest.
fn recommended(trade: &Trade) -> Vec<&Rung> {
    let cheaper = |rung: &&Rung| rung.cost_ratio.is_some_and(|ratio| ratio < 1.0);
    let close = |rung: &&Rung| !rung.reversed && rung.bound.is_some_and(|bound| bound <= CLOSE);
    let candidates = || trade.rungs.iter().filter(cheaper).filter(close);
    let cost = |rung: &&Rung| rung.cost.unwrap_or(f64::INFINITY);
    let bound = |rung: &&Rung| rung.bound.unwrap_or(f64::INFINITY);
    let cheapest = candidates().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    let closest = candidates().min_by(|a, b| bound(a).total_cmp(&bound(b)));
    let mut found: Vec<&Rung> = cheapest.into_iter().collect();
    found.extend(closest.filter(|rung| !found.iter().any(|other| other.name == rung.name)));
    found
}

fn clause(rung: &Rung) -> String {
    let bound = rung.bound.map_or_else(String::new, percent);
    let cost = rung.cost_ratio.map_or_else(String::new, share);
    let reduced = match rung.settings.reduction {
        Some(_) => ", though it leaves out what the scene has",
        None => "",
    };
    format!(
        "`{}` is within {bound} of the reference, intervals included, at {cost} of its cost{reduced}",
        rung.options
    )
}

/// What is known of a reference's convergence, as a sentence; `changes` are those of its last doubling.
pub(super) fn convergence(reference: &Reference, changes: &str) -> String {
    let Some(last) = reference.doublings.last() else {
        return "Whether it has converged is undecided: no other substeps were measured."
            .to_owned();
    };
    let (from, to) = (last.from, last.to);
    match (reference.convergence, reference.bound) {
        (Convergence::Converged, Some(bound)) => format!(
            "It has converged within {}: its last doubling, from {from} to {to} substeps, changed no \
             mean by more than {}, intervals included: {changes}.",
            percent(CLOSE),
            percent(bound)
        ),
        (Convergence::NotConverged, _) => format!(
            "It has NOT CONVERGED: one of the last two doublings of its substeps is known to have \
             changed a mean. The last, from {from} to {to}: {changes}."
        ),
        (_, bound) => {
            let open = match bound {
                _ if reference.doublings.len() < 2 => {
                    "only one doubling of its substeps was measured".to_owned()
                }
                Some(bound) => format!(
                    "its last doubling may have changed a mean by up to {}, and more runs would \
                     tell",
                    percent(bound)
                ),
                None => "there are too few runs for an interval".to_owned(),
            };
            format!(
                "Whether it has converged is undecided: {open}. The last doubling, from {from} to \
                 {to} substeps: {changes}."
            )
        }
    }
}

/// A bias without its sign: `4.0 ± 3.1 %`.
pub(super) fn within(bias: &Relative) -> String {
    let size = Relative {
        value: bias.value.abs(),
        ..*bias
    };
    relative(&size)
}

/// A bias: `-4.0 ± 3.1 %`.
pub(super) fn relative(bias: &Relative) -> String {
    let value = 100.0 * bias.value;
    match bias.half_width {
        Some(half_width) => format!("{value:.1} ± {:.1} %", 100.0 * half_width),
        None => format!("{value:.1} ± ? %"),
    }
}

/// A share as a percentage without needless digits.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if (percent - percent.round()).abs() < 0.05 {
        format!("{percent:.0} %")
    } else {
        format!("{percent:.1} %")
    }
}

/// A ratio with two digits.
pub(super) fn share(ratio: f64) -> String {
    match ratio {
        r if r >= 9.95 => format!("{r:.0}"),
        r if r >= 0.995 => format!("{r:.1}"),
        r if r >= 0.0995 => format!("{r:.2}"),
        r => format!("{r:.3}"),
    }
}

fn capital(text: &str) -> String {
    match text.strip_prefix("no ") {
        Some(rest) => format!("No {rest}"),
        None => text.to_owned(),
    }
}
