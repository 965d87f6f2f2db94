//! Warnings about scenes that do not work, or whose time step is too long.
use std::ops::RangeInclusive;

use super::dimensionless::{
    AdvisedRange, DRAG_SYMBOL, DimensionlessNumber, ExpectedRange, ResolutionLimit, Settling,
    carried, dimensionless_numbers, speed, turn_in_steps,
};
pub use super::warning_kind::SceneWarningKind;
use super::{Agitation, Bond, Scene, Substeps};
use stochc_text::{counted, percent};

/// Warning about a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneWarning {
    /// Kind of the warning.
    pub kind: SceneWarningKind,
    /// Symbol of the dimensionless number. Empty if no block moves.
    pub symbol: &'static str,
    /// Dimensionless number and its limit.
    pub figure: String,
    /// Effect of the problem on runs, as part of a sentence.
    pub effect: String,
    /// Remedy for the problem.
    pub remedy: String,
}

/// Time step and precision of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// Steps per tick.
    pub steps: Substeps,
    /// Smallest rotation per step that the precision resolves \[rad\].
    pub smallest_turn: f64,
}

impl Stepping {
    /// Smallest rotation per step that single precision resolves \[rad\].
    ///
    /// docs/validation/stability.md measures this limit and [`Stepping::RAPIER`].
    pub const SINGLE: f64 = 2.5e-7;
    /// Smallest rotation per step that the model `rapier` resolves \[rad\]. See
    /// [`Stepping::SINGLE`].
    pub const RAPIER: f64 = 2.5e-6;

    /// Time step of a run without options.
    pub const DEFAULT: Stepping = Stepping {
        steps: Substeps::DEFAULT,
        smallest_turn: Stepping::SINGLE,
    };
}

impl Default for Stepping {
    fn default() -> Stepping {
        Stepping::DEFAULT
    }
}

/// Smallest density of free blocks at the structure, relative to their mean density. Below it,
/// captures are rare, and a warning is reported.
///
/// The limit is based on simulations of a four-block tower among 40 cubes of 1.5 cm. Compared with
/// neutral blocks, construction took 1.5 times as long at a density of 0.08, and five times as long
/// at 0.04.
const MIN_DENSITY: f64 = 0.1;

/// Returns all warnings about a scene that is computed with these steps.
///
/// `layers` contains the lowest and the highest layer of captures. Layer 1 is on the floor.
pub fn scene_warnings(
    scene: &Scene,
    stepping: Stepping,
    layers: Option<RangeInclusive<i32>>,
) -> Vec<SceneWarning> {
    let steps = stepping.steps.in_scene(scene);
    let numbers = dimensionless_numbers(scene, steps);
    let taken = |group: &DimensionlessNumber| group.steps_of(steps);
    let exceeded = numbers
        .iter()
        .filter(|group| group.is_exceeded(taken(group)));
    let resolving = resolving(exceeded, steps);
    let mut found = Vec::new();
    found.extend(no_agitation(scene));
    found.extend(layers.and_then(|layers| buoyant(scene, &layers)));
    found.extend(numbers.iter().filter_map(|group| {
        let steps = taken(group);
        let limit = group.limit.filter(|_| group.is_exceeded(steps))?;
        Some(coarse(group, limit, steps, resolving))
    }));
    found.extend(digits(scene, stepping.smallest_turn, steps));
    let disappointing =
        |group: &DimensionlessNumber| Some(out_of_range(group, group.disappoints()?));
    found.extend(numbers.iter().filter_map(disappointing));
    found.sort_by_key(|warning| warning.kind);
    found
}

/// Increases the steps per tick `taken` until the numbers in `exceeded` are within their limits,
/// and returns the result. Ignores numbers that exceed their limits with every allowed time step.
///
/// A long step contains an integer number of the short steps near open faces.
fn resolving<'a>(
    exceeded: impl Iterator<Item = &'a DimensionlessNumber>,
    taken: Substeps,
) -> Substeps {
    let allowed = |needed: &u32| *needed <= Substeps::MAX;
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

/// Warns of a scene without any motion of free blocks. Returns `None` for a scene with motion.
///
/// The pump of `bond suction` draws blocks from any distance.
fn no_agitation(scene: &Scene) -> Option<SceneWarning> {
    let is_drawn = matches!(scene.bond, Some(Bond::Suction { .. }));
    let is_still = speed(scene).rms == Some(0.0) && carried(scene) == 0.0;
    (is_still && !is_drawn && scene.free.count > 0).then(|| SceneWarning {
        kind: SceneWarningKind::NoAgitation,
        symbol: "",
        figure: match scene.agitation {
            None => "it has no `agitation` and no `flow`",
            Some(Agitation::Kicks { .. }) => "the speed of its `kicks` is 0",
            Some(_) => "its `agitation` has the strength 0",
        }
        .to_owned(),
        effect: "nothing moves the free blocks".to_owned(),
        remedy: "add agitation such as `agitation kicks { speed 0 .. 0.8 m/s }`".to_owned(),
    })
}

/// Returns the density of free blocks at the structure as a dimensionless number. `None` if neither
/// weight nor lift moves them.
pub fn structure_group(scene: &Scene, layers: &RangeInclusive<i32>) -> Option<DimensionlessNumber> {
    let (_, density) = density_at_structure(scene, layers)?;
    let meaning = "density of free blocks in the emptiest layer of captures, over the mean";
    let group = DimensionlessNumber::new("n(z) / n", meaning, density);
    Some(group.advised(AdvisedRange::Least(MIN_DENSITY)))
}

/// Returns the layer of captures with the fewest free blocks because of weight or lift, and their
/// density there, relative to the mean.
fn density_at_structure(scene: &Scene, layers: &RangeInclusive<i32>) -> Option<(i32, f64)> {
    let settling = Settling::from_scene(scene)?;
    let layer = if settling.is_floating {
        *layers.start()
    } else {
        *layers.end()
    };
    Some((layer, settling.density_in(scene, layer)?))
}

/// Warns of a structure at heights with few free blocks because of weight or lift.
fn buoyant(scene: &Scene, layers: &RangeInclusive<i32>) -> Option<SceneWarning> {
    let (layer, density) = density_at_structure(scene, layers)?;
    let is_away = Settling::from_scene(scene)?.is_floating;
    let where_they_are = match (scene.mount, is_away) {
        (None, true) => "most blocks float at the top",
        (None, false) => "most blocks lie on the floor",
        (Some(_), true) => "most blocks sink away from the plate",
        (Some(_), false) => "most blocks float at the plate",
    };
    (density < MIN_DENSITY).then(|| SceneWarning {
        kind: SceneWarningKind::BuoyantBlocks,
        symbol: "n(z) / n",
        figure: format!(
            "n(z) / n is {} in layer {layer}, less than {MIN_DENSITY}",
            short(density)
        ),
        effect: format!(
            "{where_they_are}, and layer {layer} has {} of their mean density, less than {}",
            percent(density),
            percent(MIN_DENSITY)
        ),
        remedy: "bring the density of blocks and fluid closer together, or stir more".to_owned(),
    })
}

/// Warns of a motion that the time step does not resolve.
fn coarse(
    group: &DimensionlessNumber,
    limit: ResolutionLimit,
    steps: u32,
    resolving: Substeps,
) -> SceneWarning {
    let (symbol, value) = (group.symbol, short(group.value));
    let most = short(limit.most);
    let remedy = match group.substeps() {
        Some(needed) if needed <= Substeps::MAX && resolving.are_valid() => {
            format!("run with `--substeps {resolving}`, or shorten the `tick`")
        }
        _ => "shorten the `tick`: no allowed number of substeps is enough".to_owned(),
    };
    let taken = counted(steps as usize, "substep");
    SceneWarning {
        kind: SceneWarningKind::CoarseStep,
        symbol,
        figure: format!("{symbol} is {value}, more than {most} with {taken} per tick"),
        effect: if symbol == DRAG_SYMBOL {
            slowed(group.value / f64::from(steps))
        } else {
            limit.beyond.to_owned()
        },
        remedy,
    }
}

/// Describes the error of displacements if `taken` is the drag rate times the step.
///
/// Drag acts before a block moves, so its displacement is x e^-x / (1 - e^-x) of the correct one.
fn slowed(taken: f64) -> String {
    let times = taken.exp_m1() / taken;
    format!("displacements are {} times too small", two_digits(times))
}

/// Warns of rotations per step below the precision of an orientation. Returns `None` if the
/// precision is sufficient.
fn digits(scene: &Scene, smallest_turn: f64, steps: Substeps) -> Option<SceneWarning> {
    let turn = turn_in_steps(scene, f64::from(steps.longest()))?;
    (turn > 0.0 && turn < smallest_turn).then(|| SceneWarning {
        kind: SceneWarningKind::CoarseStep,
        symbol: "ω τ",
        figure: format!(
            "ω τ is {} in a step, less than the precision {} of an orientation",
            short(turn),
            short(smallest_turn)
        ),
        effect: "blocks stop turning".to_owned(),
        remedy: "run with `--model rigid --precision double`".to_owned(),
    })
}

/// Warns of a dimensionless number out of range at any time step.
fn out_of_range(group: &DimensionlessNumber, expected: ExpectedRange) -> SceneWarning {
    let (symbol, value) = (group.symbol, short(group.value));
    SceneWarning {
        kind: expected.kind,
        symbol,
        figure: format!("{symbol} is {value}, more than {}", short(expected.most)),
        effect: expected.beyond.to_owned(),
        remedy: expected.remedy.to_owned(),
    }
}

fn two_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    short(rounded)
}

/// Formats a number with four digits.
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
    use super::*;

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

    /// Checks the displacement in two steps at γ τ = 13: (e^-6.5 + e^-13) / 2. The correct
    /// displacement is 1 / 13.
    #[test]
    fn a_coarse_drag_warning_states_its_error() {
        let displacement = ((-6.5_f64).exp() + (-13.0_f64).exp()) / 2.0;
        let times = 1.0 / 13.0 / displacement;
        assert!(
            (6.5_f64.exp_m1() / 6.5 / times - 1.0).abs() < 0.01,
            "{times}"
        );
        assert_eq!(slowed(6.5), "displacements are 100 times too small");
    }
}
