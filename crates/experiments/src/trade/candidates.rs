//! Candidates: the settings that `stochc trade` compares.
use stochc_runtime::{Model, Precision, Reduction, Settings, Substeps};

use stochc_results::ChosenSetting;

/// Default number of substeps of the reference, the finest candidate.
pub const FINEST: u32 = 32;

/// Returns the candidates of a trade, with at most `finest` substeps. The candidates that double
/// the substeps from 1 to `finest` come first.
pub fn candidates(finest: u32) -> Vec<Vec<ChosenSetting>> {
    let all = settings(finest);
    all.iter().map(ChosenSetting::all_of).collect()
}

fn settings(finest: u32) -> Vec<Settings> {
    let within = |substeps: &u32| *substeps <= finest;
    let doubled = || std::iter::successors(Some(1_u32), |it| it.checked_mul(2)).take_while(within);
    let with = |settings: Settings, iterations| Settings {
        solver_iterations: Some(iterations),
        ..settings
    };
    let mut all: Vec<Settings> = doubled().map(rigid).collect();
    let local = [1, 2].map(|away| Settings {
        away: Some(away),
        ..rigid(Substeps::DEFAULT.near)
    });
    all.extend(local.into_iter().filter(|it| within(&it.substeps)));
    // A third of the default number of iterations, and three times the default.
    all.extend([3, 30].map(|iterations| with(usual(finest), iterations)));
    all.push(Settings {
        precision: Precision::Double,
        ..usual(finest)
    });
    all.extend(Reduction::ALL.map(|reduction| Settings {
        reduction: Some(reduction),
        ..usual(finest)
    }));
    // Iterations of `rapier` are internal steps. Try a quarter and twice the default.
    all.extend([1, 8].map(|iterations| with(rapier(1), iterations)));
    all.extend(doubled().take_while(|&it| it <= 8).map(rapier));
    all.push(Settings::new(Model::Rate, 1));
    all
}

/// Returns the base settings. Some candidates differ from them in one setting only. These are the
/// defaults, or the finest uniform steps if the default steps are finer than `finest`.
fn usual(finest: u32) -> Settings {
    if Substeps::DEFAULT.near <= finest {
        Settings::default()
    } else {
        rigid(1 << finest.max(1).ilog2())
    }
}

fn rigid(substeps: u32) -> Settings {
    Settings::new(Model::Rigid, substeps)
}

fn rapier(substeps: u32) -> Settings {
    Settings::new(Model::Rapier, substeps)
}

/// Returns whether settings may serve as the reference: `rigid` with uniform steps and no other
/// change.
pub(super) fn refines(settings: &Settings) -> bool {
    let plain = Settings {
        max_ticks: settings.max_ticks,
        ..rigid(settings.substeps)
    };
    plain.resolved() == settings.resolved()
}

/// Returns a short text for settings: `rigid 2`, `rapier 1 iterations 8`, `rigid 1 no-friction`.
pub(super) fn short(settings: &Settings) -> String {
    written(settings, ["", " ", " iterations ", " ", " no-"])
}

/// Returns settings as command line options of `simulate`.
pub(super) fn flags(settings: &Settings) -> String {
    let options = [
        "--model ",
        " --substeps ",
        " --solver-iterations ",
        " --precision ",
        " --without ",
    ];
    written(settings, options)
}

/// Returns each setting that is not a default, preceded by its label. The labels are in the order
/// of [`ChosenSetting::all_of`].
fn written(settings: &Settings, labels: [&str; 5]) -> String {
    let labelled = |chosen: &ChosenSetting| {
        let label = labels[chosen.index()];
        format!("{label}{}", chosen.value())
    };
    let all = ChosenSetting::all_of(settings);
    all.iter().map(labelled).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_every_candidate_once() {
        for finest in [1, 2, 5, 8, FINEST] {
            let all = settings(finest);
            for (i, candidate) in all.iter().enumerate() {
                let is_same = |other: &Settings| other.resolved() == candidate.resolved();
                assert!(!all[..i].iter().any(is_same), "{candidate:?}");
                assert!(candidate.substeps <= finest);
            }
            let changed = all.iter().find(|it| it.precision == Precision::Double);
            let unchanged = Settings {
                precision: Precision::Single,
                ..changed.unwrap().clone()
            };
            assert!(all.contains(&unchanged), "{finest}");
        }
        let all = settings(FINEST);
        let refined = all.iter().filter(|it| refines(it)).map(|it| it.substeps);
        assert_eq!(refined.collect::<Vec<_>>(), [1, 2, 4, 8, 16, 32]);
    }

    #[test]
    fn a_candidate_is_written_as_options() {
        let written = |settings: &Settings| (short(settings), flags(settings));
        assert_eq!(
            written(&rigid(2)),
            ("rigid 2".into(), "--model rigid --substeps 2".into())
        );
        assert_eq!(
            written(&Settings::new(Model::Rate, 1)),
            ("rate".into(), "--model rate".into())
        );
        let all = Settings {
            solver_iterations: Some(30),
            precision: Precision::Double,
            reduction: Some(Reduction::Corners),
            ..rigid(1)
        };
        assert_eq!(
            written(&all),
            (
                "rigid 1 iterations 30 double no-corners".into(),
                "--model rigid --substeps 1 --solver-iterations 30 --precision double --without corners"
                    .into()
            )
        );
    }
}
