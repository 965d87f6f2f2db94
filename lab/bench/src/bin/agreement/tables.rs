//! Markdown tables of the samples of one case.
use std::fmt::Write as _;

use stochc_runtime::{Model, Settings};

use super::cases::{Case, SUBSTEPS};
use super::samples::Sample;
use super::statistics::{kolmogorov_smirnov, mann_whitney, mean};

type Measure = (&'static str, fn(&Sample) -> f64);

/// Compared quantities: completion time, waiting times of the first and last capture, and their
/// parts.
const MEASURES: [Measure; 5] = [
    ("completion time", |s| s.ticks),
    ("wait for the first bond", |s| s.first_wait),
    ("wait for the last bond", |s| s.last_wait),
    ("entries per bond", |s| s.entries),
    ("docking time", |s| s.docking),
];

/// Returns the tables of one case as Markdown.
pub fn page(case: &Case, samples: &[Sample]) -> String {
    let mut page = format!("### `{}`: {}\n\n", case.name, case.what);
    if samples.is_empty() {
        return String::new();
    }
    let usual = |model: Model| {
        Settings {
            model,
            ..Settings::new(Model::Rigid, 1)
        }
        .iterations()
    };
    let of = |model: Model, substeps: u32, iterations: u32, measure: fn(&Sample) -> f64| {
        let chosen = samples.iter().filter(|s| {
            s.completed
                && s.model == model.name()
                && s.substeps == substeps
                && s.iterations == iterations
        });
        chosen.map(measure).collect::<Vec<f64>>()
    };
    let measures = if case.count == 1 {
        vec![MEASURES[0], MEASURES[3], MEASURES[4]]
    } else {
        MEASURES.to_vec()
    };
    page += "| | substeps | n | `rigid` | `rapier` | ratio | KS | MW | `rigid` as at 16 | `rapier` as at 16 |\n";
    page += "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";
    for (name, measure) in measures {
        let [rigid, rapier] = [Model::Rigid, Model::Rapier]
            .map(|model| SUBSTEPS.map(|k| of(model, k, usual(model), measure)));
        for (k, substeps) in SUBSTEPS.into_iter().enumerate() {
            let (a, b) = (&rigid[k], &rapier[k]);
            if a.len() < 2 || b.len() < 2 {
                continue;
            }
            let settled = |all: &[Vec<f64>]| match all.last() {
                Some(last) if k + 1 < all.len() && last.len() > 1 => {
                    probability(kolmogorov_smirnov(&all[k], last))
                }
                _ => String::new(),
            };
            let (of_rigid, of_rapier) = (mean(a), mean(b));
            let _ = writeln!(
                page,
                "| {} | {substeps} | {}, {} | {} | {} | {} | {} | {} | {} | {} |",
                if k == 0 { name } else { "" },
                a.len(),
                b.len(),
                interval(of_rigid),
                interval(of_rapier),
                ratio(of_rigid, of_rapier),
                probability(kolmogorov_smirnov(a, b)),
                probability(mann_whitney(a, b)),
                settled(&rigid),
                settled(&rapier),
            );
        }
    }
    let mut others: Vec<(u32, u32)> = samples
        .iter()
        .filter(|s| s.model == Model::Rapier.name() && s.iterations != usual(Model::Rapier))
        .map(|s| (s.substeps, s.iterations))
        .collect();
    others.sort_unstable();
    others.dedup();
    for (substeps, iterations) in others {
        let [ticks, docking] = [MEASURES[0].1, MEASURES[4].1]
            .map(|measure| interval(mean(&of(Model::Rapier, substeps, iterations, measure))));
        let _ = writeln!(
            page,
            "\n`rapier`, {substeps} substeps, {iterations} solver iterations: completion {ticks}, docking {docking}."
        );
    }
    let lost = samples.iter().filter(|s| !s.completed).count();
    let _ = writeln!(
        page,
        "\n{lost} of {} runs did not complete.\n",
        samples.len()
    );
    page
}

fn interval((mean, half): (f64, f64)) -> String {
    let digits = usize::from(half < 5.0) + usize::from(half < 0.5);
    format!("{mean:.digits$} ± {half:.digits$}")
}

/// Returns the ratio of two means with its interval. The squares of the relative errors add.
fn ratio((a, da): (f64, f64), (b, db): (f64, f64)) -> String {
    let ratio = b / a;
    let half = ratio * ((da / a).powi(2) + (db / b).powi(2)).sqrt();
    format!("{ratio:.2} ± {half:.2}")
}

fn probability(p: f64) -> String {
    if p < 0.0005 {
        "< 0.001".to_owned()
    } else {
        format!("{p:.3}")
    }
}
