//! The settings that are tried.
use stochc_runtime::{Model, Precision, Reduction, Settings, Substeps};

/// The substeps that the refinement starts with, so that there are two doublings and one to spare.
const FIRST: u32 = 8;

/// The substeps that it does not go beyond, unless told.
pub const FINEST: u32 = 64;

/// The candidate that is measured first: what all guesses of costs start from.
pub fn base() -> Settings {
    rigid(1)
}

/// What one thing at a time is changed of: the default steps, or the most of the refinement that are allowed.
fn usual(finest: u32) -> Settings {
    match Substeps::DEFAULT.near <= finest {
        true => base().with_steps(Substeps::DEFAULT),
        false => rigid(1 << finest.max(1).ilog2()),
    }
}

/// All candidates before any refinement, with at most `finest` substeps; [`base`] first, and of each
/// kind the cheapest first.
pub fn candidates(finest: u32) -> Vec<Settings> {
    let within = |substeps: &u32| *substeps <= finest;
    let doubled = || [1, 2, 4, FIRST].into_iter().filter(within);
    let with = |settings: Settings, iterations| Settings {
        solver_iterations: Some(iterations),
        ..settings
    };
    // Nothing means anything without a reference, so that what leads to it comes first.
    let mut candidates: Vec<Settings> = doubled().map(rigid).collect();
    let local = [1, 2].map(|away| Settings {
        away: Some(away),
        ..rigid(FIRST)
    });
    candidates.extend(
        local
            .into_iter()
            .filter(|candidate| within(&candidate.substeps)),
    );
    // A third and three times the default.
    candidates.extend([3, 30].map(|iterations| with(usual(finest), iterations)));
    candidates.push(Settings {
        precision: Precision::Double,
        ..usual(finest)
    });
    candidates.extend(Reduction::ALL.map(|reduction| Settings {
        reduction: Some(reduction),
        ..usual(finest)
    }));
    candidates.push(rapier(1));
    // Rapier's are internal steps that cost as much each: a quarter, and twice the default.
    candidates.extend([1, 8].map(|iterations| with(rapier(1), iterations)));
    candidates.extend(doubled().skip(1).map(rapier));
    candidates.push(Settings::of(Model::Rate, 1));
    candidates
}

/// `rigid` with nothing left out and this many substeps.
pub fn rigid(substeps: u32) -> Settings {
    Settings::of(Model::Rigid, substeps)
}

fn rapier(substeps: u32) -> Settings {
    Settings::of(Model::Rapier, substeps)
}

/// Whether doubling the substeps of this candidate gives another candidate of the refinement.
pub fn refines(settings: &Settings) -> bool {
    *settings == rigid(settings.substeps)
}

/// The candidate in few letters: `rigid 2`, `rapier 1 iterations 8`, `rigid 1 no-friction`.
pub fn short(settings: &Settings) -> String {
    if settings.model == Model::Rate {
        return settings.model.name().to_owned();
    }
    let mut text = format!("{} {}", settings.model.name(), settings.steps());
    if let Some(iterations) = settings.solver_iterations {
        text += &format!(" iterations {iterations}");
    }
    if settings.precision == Precision::Double {
        text += " double";
    }
    if let Some(reduction) = settings.reduction {
        text += &format!(" {}", reduction.name());
    }
    text
}

/// The candidate as options of `simulate`.
pub fn flags(settings: &Settings) -> String {
    // Where nothing moves, no steps are taken.
    if !settings.model.has_places() {
        return format!("--model {}", settings.model.name());
    }
    let mut text = format!(
        "--model {} --substeps {}",
        settings.model.name(),
        settings.steps()
    );
    if let Some(iterations) = settings.solver_iterations {
        text += &format!(" --solver-iterations {iterations}");
    }
    if settings.precision == Precision::Double {
        text += " --precision double";
    }
    if let Some(reduction) = settings.reduction {
        text += &format!(" --reduce {}", reduction.name());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether two settings compute the same runs.
    fn same(first: &Settings, second: &Settings) -> bool {
        first.resolved() == second.resolved()
    }

    #[test]
    fn every_candidate_is_there_once_and_the_base_first() {
        let all = candidates(FINEST);
        assert_eq!(all[0], base());
        for (i, candidate) in all.iter().enumerate() {
            assert!(
                !all[..i].iter().any(|other| same(other, candidate)),
                "{candidate:?}"
            );
        }
        let refined = all.iter().filter(|candidate| refines(candidate));
        assert_eq!(
            refined.map(|r| r.substeps).collect::<Vec<_>>(),
            [1, 2, 4, 8]
        );
        assert!(
            candidates(2)
                .iter()
                .all(|candidate| candidate.substeps <= 2)
        );
        // What is changed is measured unchanged as well.
        let double = |it: &&Settings| it.precision == Precision::Double;
        for finest in 1..8 {
            let all = candidates(finest);
            let changed = all.iter().find(double).unwrap();
            assert!(all.contains(&rigid(changed.substeps)), "{finest}");
        }
        let default = |candidate: &&Settings| candidate.steps() == Substeps::DEFAULT;
        let (alone, changed): (Vec<_>, Vec<_>) = all
            .iter()
            .filter(default)
            .partition(|candidate| same(candidate, &base().with_steps(Substeps::DEFAULT)));
        assert_eq!((alone.len(), changed.len()), (1, 3 + Reduction::ALL.len()));
    }

    #[test]
    fn a_candidate_is_told_as_options() {
        let told = |settings: &Settings| (short(settings), flags(settings));
        assert_eq!(
            told(&rigid(2)),
            ("rigid 2".into(), "--model rigid --substeps 2".into())
        );
        let all = Settings {
            solver_iterations: Some(30),
            precision: Precision::Double,
            reduction: Some(Reduction::Spheres),
            ..base()
        };
        assert_eq!(
            told(&all),
            (
                "rigid 1 iterations 30 double spheres".into(),
                "--model rigid --substeps 1 --solver-iterations 30 --precision double --reduce spheres".into()
            )
        );
    }
}
