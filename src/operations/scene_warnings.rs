//! What a scene does that settings do not resolve, and what it does not do at all.
use stochc_ir::scene::Scene;
use stochc_ir::scene::groups::{DimensionlessGroup, RangeBound, groups, turn_in_steps};
use stochc_runtime::{Model, Precision, Settings, Substeps};

/// A doubt about a scene: the figure that gives rise to it, and what comes of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneWarning {
    /// The symbol of the figure.
    pub symbol: &'static str,
    /// The figure, what it should keep to, and the way out.
    pub figure: String,
    /// What happens, as a clause.
    pub effect: &'static str,
    /// Whether it matters to structures alone that grow away from where blocks settle.
    pub is_of_height: bool,
}

/// The doubts about a scene with these settings.
pub fn scene_warnings(scene: &Scene, settings: &Settings) -> Vec<SceneWarning> {
    let steps = settings.steps_in(scene);
    let groups = groups(scene);
    let taken = |group: &DimensionlessGroup| {
        if group.of_faces {
            steps.near
        } else {
            steps.longest()
        }
    };
    let exceeded = groups
        .iter()
        .filter(|group| group.is_exceeded(taken(group)));
    let remedy = resolving(exceeded, steps);
    let found = groups
        .iter()
        .filter_map(|group| doubt(group, taken(group), remedy));
    found.chain(digits(scene, settings, steps)).collect()
}

/// The fewest steps that resolve all of these groups that any steps do, as the steps that are taken are otherwise: of blocks that are
/// near open faces no fewer, and of a whole number in each of the others.
fn resolving<'a>(
    exceeded: impl Iterator<Item = &'a DimensionlessGroup>,
    taken: Substeps,
) -> Substeps {
    let allowed = |needed: &u32| *needed <= Substeps::MOST;
    let mut steps = taken;
    for group in exceeded {
        let Some(needed) = group.substeps().filter(allowed) else {
            continue;
        };
        match &mut steps.away {
            Some(away) if !group.of_faces => *away = needed.max(*away),
            _ => steps.near = needed.max(steps.near),
        }
    }
    if let Some(away) = steps.away {
        steps.near = steps.near.next_multiple_of(away);
    }
    steps
}

/// The least turn in a step that single precision adds up, and that Rapier does \[rad\]: docs/stability.md measures both.
const LEAST_TURN: f64 = 2.5e-7;
const LEAST_TURN_OF_RAPIER: f64 = 2.5e-6;

/// Steps in which blocks turn by less than the last digit of an orientation.
fn digits(scene: &Scene, settings: &Settings, steps: Substeps) -> Option<SceneWarning> {
    let longest = steps.longest();
    let turn = turn_in_steps(scene, f64::from(longest)).filter(|turn| *turn > 0.0)?;
    let (least, remedy) = match settings.model {
        Model::Rapier => (
            LEAST_TURN_OF_RAPIER,
            "`--model rigid --precision double` has them",
        ),
        _ => (LEAST_TURN, "`--precision double` has them"),
    };
    if turn >= least || settings.precision == Precision::Double {
        return None;
    }
    Some(SceneWarning {
        symbol: "ω τ",
        figure: format!(
            "ω τ is {} in a step, fewer digits than single precision has; {remedy}",
            short(turn)
        ),
        effect: "blocks stop turning",
        is_of_height: false,
    })
}

fn doubt(group: &DimensionlessGroup, steps: u32, remedy: Substeps) -> Option<SceneWarning> {
    let (symbol, value) = (group.symbol, short(group.value));
    if let Some(limit) = group.limit.filter(|_| group.is_exceeded(steps)) {
        let remedy = match group.substeps() {
            Some(needed) if needed <= Substeps::MOST && remedy.are_sound() => {
                format!("`--substeps {remedy}` resolves it")
            }
            _ => "no number of substeps that is allowed resolves it".to_owned(),
        };
        let most = short(limit.most);
        let taken = match steps {
            1 => String::new(),
            steps => format!(", and {steps} are taken"),
        };
        return Some(SceneWarning {
            symbol,
            figure: format!(
                "{symbol} is {value} with one step a tick, more than {most}{taken}; {remedy}"
            ),
            effect: limit.beyond,
            is_of_height: false,
        });
    }
    let expected = group.disappoints()?;
    let bound = match expected.bound {
        RangeBound::AtLeast(least) => format!("less than {}", short(least)),
        RangeBound::AtMost(most) => format!("more than {}", short(most)),
    };
    Some(SceneWarning {
        symbol,
        figure: format!("{symbol} is {value}, {bound}; {}", expected.remedy),
        effect: expected.beyond,
        is_of_height: expected.is_of_height,
    })
}

/// A number to four digits.
pub fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) || !rounded.is_finite() {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}

#[cfg(test)]
mod tests {
    use stochc_compiler::check;

    use super::*;

    #[test]
    fn steps_that_turn_by_less_than_a_digit_are_told() {
        let text = include_str!("../../examples/microns.sa");
        let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
        let checked = check("a.sa", &mut reader, Default::default());
        let mut scene = checked.programs[0].scene.clone().expect("it has one");
        let single = Settings::default();
        let double = Settings {
            precision: Precision::Double,
            ..single.clone()
        };
        let mut is_told = |tick: f64, settings: &Settings| {
            scene.tick = tick;
            let all = scene_warnings(&scene, settings);
            all.iter().any(|doubt| doubt.symbol == "ω τ")
        };
        // A cube of 10 um turns by some 27 rad/s in water.
        assert!(!is_told(1e-7, &single));
        assert!(is_told(1e-9, &single));
        assert!(!is_told(1e-9, &double));
    }

    #[test]
    fn what_is_advised_resolves_all_and_keeps_the_steps_near_faces() {
        let text = "scene s from hemisphere { tick 60 ms }
            assembly a in s { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }";
        let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
        let checked = check("a.sa", &mut reader, Default::default());
        let scene = checked.programs[0].scene.clone().expect("it has one");
        for taken in ["2/8", "2/2", "1", "1/8"] {
            let taken: Substeps = taken.parse().expect("they are steps");
            let all = scene_warnings(&scene, &Settings::default().with_steps(taken));
            assert!(!all.is_empty(), "{taken}");
            let advised = |doubt: &SceneWarning| {
                let (_, behind) = doubt
                    .figure
                    .split_once("`--substeps ")
                    .expect("there is advice");
                behind.split_once('`').expect("it ends").0.to_owned()
            };
            let steps: Substeps = advised(&all[0]).parse().expect("they are allowed");
            assert!(
                all.iter().all(|doubt| advised(doubt) == steps.to_string()),
                "{all:?}"
            );
            assert!(steps.near >= taken.near && steps.away.is_some() == taken.away.is_some());
            assert_eq!(
                scene_warnings(&scene, &Settings::default().with_steps(steps)),
                []
            );
        }
    }

    #[test]
    fn numbers_have_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0 / 3.0, "0.3333"),
            (5.999_999_999, "6"),
            (10_000_000.0, "1e7"),
            (123_456.0, "123500"),
            (0.000_012_345_6, "1.235e-5"),
            (-2.0, "-2"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
