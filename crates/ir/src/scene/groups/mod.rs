//! Numbers without a dimension that say how a scene behaves, the same at every scale.
//!
//! Some also say whether a step a tick is short enough for what happens in it: these have a limit.
//! docs/concepts/physical-model.md derives them.
mod block_units;
mod gas;
mod settling;
mod softness;
mod speed;

use serde::Serialize;

pub use block_units::BlockUnits;
pub use gas::Gas;
pub use settling::Settling;
pub(super) use speed::rms_of_range;
pub use speed::{Speed, SpeedFrom, carried, kick, speed, turn_in_steps};

use super::warnings::SceneWarningKind;
use super::{Agitation, BOLTZMANN, Bond, ContactLaw, Enclosure, Fluid, Scene, Substeps};

/// A number without a dimension.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DimensionlessGroup {
    /// How it is made, in the symbols of the terms.
    pub symbol: &'static str,
    /// What it says.
    pub meaning: &'static str,
    /// Its value with one step a tick.
    pub value: f64,
    /// What it has to keep to, if it is one that steps have to resolve.
    pub limit: Option<ResolutionLimit>,
    /// What it should keep to whatever the steps are.
    pub expected: Option<ExpectedRange>,
    /// Whether it is about blocks that an open face attracts, which may take shorter steps than all others.
    pub of_faces: bool,
}

/// The largest value of a group at which what it stands for is resolved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ResolutionLimit {
    /// The value with one step a tick, about.
    pub most: f64,
    /// The fewest substeps a tick with which the group keeps to it; `None`: no number of them does.
    pub substeps: Option<u32>,
    /// What happens beyond it, as a clause.
    pub beyond: &'static str,
}

/// The largest value of a group that a scene works with, at any steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ExpectedRange {
    /// The largest value, about.
    pub most: f64,
    /// The consequence beyond it, as a clause.
    pub beyond: &'static str,
    /// The change that helps.
    pub remedy: &'static str,
    /// The kind of the warning about it.
    #[serde(skip)]
    pub kind: SceneWarningKind,
}

impl DimensionlessGroup {
    /// Whether so many steps a tick are too long.
    pub fn is_exceeded(&self, substeps: u32) -> bool {
        let needed = |limit: ResolutionLimit| limit.substeps;
        (self.limit).is_some_and(|limit| needed(limit).is_none_or(|needed| substeps < needed))
    }

    /// The steps a tick that the blocks take which the group is about.
    pub fn steps_of(&self, steps: Substeps) -> u32 {
        if self.of_faces {
            steps.near
        } else {
            steps.longest()
        }
    }

    /// The fewest substeps a tick that keep to the limit; `None` if there is none, or no number of them does.
    pub fn substeps(&self) -> Option<u32> {
        self.limit?.substeps
    }

    /// Returns the range that the group leaves, whatever the steps are.
    pub fn disappoints(&self) -> Option<ExpectedRange> {
        self.expected.filter(|expected| self.value > expected.most)
    }
}

/// The least number from 1 on for which a question that stays answered is; `None`: for none that fits.
fn fewest(is_enough: impl Fn(u32) -> bool) -> Option<u32> {
    const MAX: u32 = u32::MAX / 2;
    let mut enough = 1;
    while !is_enough(enough) {
        enough = enough.checked_mul(2).filter(|&n| n <= MAX)?;
    }
    let mut few = enough / 2;
    while enough - few > 1 {
        let middle = few + (enough - few) / 2;
        if is_enough(middle) {
            enough = middle
        } else {
            few = middle
        }
    }
    Some(enough)
}

/// The groups of a scene, of those terms that it has.
pub fn groups(scene: &Scene) -> Vec<DimensionlessGroup> {
    let units = BlockUnits::from_scene(scene);
    let v = speed(scene).rms.map(|rms| units.speed(rms));
    let v = v.filter(|&v| v > 0.0);
    let energetic = speed::energetic(scene).map(|rms| units.speed(rms));
    let energetic = energetic.filter(|&v| v > 0.0);
    let push = Push::from_scene(scene);
    let mut out = Vec::new();
    if let Some(v) = v {
        out.push(
            DimensionlessGroup::new("v τ / a", "sides that a block moves in a tick", v).limited(
                |steps| match scene.agitation {
                    Some(Agitation::Brownian { .. }) => 0.2 - 0.1 * push.left(steps),
                    _ => 0.1,
                },
                |steps| units.speed(speed::in_steps(scene, steps).unwrap_or(0.0)) / steps,
                "blocks overlap deeply before a contact parts them, and slip through narrow gaps",
            ),
        );
        let kick = speed::kick(scene);
        if kick > 0.0 {
            out.push(DimensionlessGroup::new(
                "j / v",
                "a kick against the speed",
                kick / v,
            ));
        }
    }
    let carried = units.speed(speed::carried(scene));
    if carried > 0.0 {
        out.push(
            DimensionlessGroup::new(
                "u τ / a",
                "sides that the mean flow takes a block in a tick, at most",
                carried,
            )
            .limited(
                |_| 0.1,
                |steps| carried / steps,
                "blocks run deeply into what stands before a contact turns them away",
            ),
        );
    }
    if let Some(drag) = &scene.drag {
        let rate = units.rate(drag.rate);
        out.push(
            DimensionlessGroup::new(DRAG_SYMBOL, "what drag takes from a speed in a tick", rate)
                .limited(
                    |_| DRAG,
                    |steps| rate / steps,
                    "blocks that a steady force moves fall short of their terminal speed",
                ),
        );
    }
    fluid(scene, v, &mut out);
    if let Some(Bond::Reject {
        magnets, anchor, ..
    }) = &scene.bond
    {
        let (hold, depth) = (units.force(magnets.hold), units.length(magnets.depth));
        out.push(push.anchoring(hold, units.length(anchor.within)));
        if let Some(v) = energetic {
            out.push(DimensionlessGroup::new(
                "F δ / (3 m v² / 2)",
                "energy of a bond against that of two blocks' motion to each other",
                hold * depth / 3.0 / (v * v / 2.0),
            ));
        }
    }
    if let Some(Bond::Attract { pull, anchor, .. }) = &scene.bond {
        let (force, reach) = (units.force(pull.force), units.length(pull.within));
        out.push(push.anchoring(force, units.length(anchor.within)));
        if let Some(v) = energetic {
            out.push(DimensionlessGroup::new(
                "F r / (m v² / 2)",
                "work of the pull within its reach against the energy of motion",
                force * reach / (v * v / 2.0),
            ));
        }
    }
    if let Some(Enclosure::Hemisphere { wall, .. } | Enclosure::Sphere { wall, .. }) =
        &scene.enclosure
    {
        let symbols = ["k τ² / m, shell", "φ k τ² / m, shell"];
        let beyond = "the shell throws blocks back with another energy";
        out.push(push.spring(
            symbols,
            "stiffness of the shell",
            units.stiffness(*wall),
            beyond,
        ));
    }
    contact(scene, push, &mut out);
    gas(scene, v, &mut out);
    settling(scene, &mut out);
    softness::softness(scene, &mut out);
    out
}

/// What a force does in a step.
#[derive(Clone, Copy)]
struct Push {
    /// What a viscous drag takes from a velocity in a tick.
    drag: f64,
}

impl Push {
    fn from_scene(scene: &Scene) -> Push {
        Push {
            drag: speed::viscous(scene),
        }
    }

    /// How far a force of one block's weight, side and tick moves a block at rest in one of so many steps of a
    /// tick \[side\]: by φ / steps², as the worlds compute it, with the mean φ that the drag leaves of it.
    fn displacement(self, steps: f64) -> f64 {
        self.left(steps) / (steps * steps)
    }

    /// φ, the mean that the drag leaves of a force in one of so many steps of a tick: 1 without drag.
    fn left(self, steps: f64) -> f64 {
        speed::mean_left(self.drag / steps)
    }

    /// The symbol that says whether drag is in it.
    fn symbol(self, [free, slowed]: [&'static str; 2]) -> &'static str {
        if self.drag > 0.0 { slowed } else { free }
    }

    /// A group of a force \[side/tick^2\] and of the anchoring distance \[side\].
    fn anchoring(self, force: f64, within: f64) -> DimensionlessGroup {
        let value = force / within;
        DimensionlessGroup::new(
            self.symbol(["F τ² / (m d)", "φ F τ² / (m d)"]),
            "anchoring distances that the pull moves a block at rest in its first tick",
            value * self.displacement(1.0),
        )
        .limited(
            // Without drag it goes on faster in the next step; with much of it, the place is two distances wide.
            |steps| 2.0 - self.left(steps),
            |steps| value * self.displacement(steps),
            "a pulled block jumps over the place where it would be anchored",
        )
        .of_faces()
    }

    /// A group of a spring \[1/tick^2\].
    fn spring(
        self,
        symbols: [&'static str; 2],
        meaning: &'static str,
        stiffness: f64,
        beyond: &'static str,
    ) -> DimensionlessGroup {
        let value = |steps| stiffness * self.displacement(steps);
        DimensionlessGroup::new(self.symbol(symbols), meaning, value(1.0)).limited(
            |steps| 1.0 - (1.0 - SPRING) * self.left(steps),
            value,
            beyond,
        )
    }
}

fn fluid(scene: &Scene, v: Option<f64>, out: &mut Vec<DimensionlessGroup>) {
    let Some(fluid) = &scene.fluid else {
        return;
    };
    let (units, side) = (BlockUnits::from_scene(scene), scene.block.side);
    let Some(viscosity) = fluid.viscosity else {
        return;
    };
    let friction = Fluid::friction(viscosity, side);
    out.push(DimensionlessGroup::new(
        "6 π η 0.6607 a τ / m",
        "what viscous drag takes from a speed in a tick; exact for any step",
        units.damping(friction),
    ));
    let is_carried = matches!(scene.agitation, Some(Agitation::Turbulence(_)));
    match (fluid.density, v) {
        (Some(density), Some(v)) => out.push(DimensionlessGroup::new(
            "ρ v a / η",
            "Reynolds number of a block at the speed v",
            units.density(density) * v / units.viscosity(viscosity),
        )),
        (None, Some(v)) if !is_carried => out.push(
            DimensionlessGroup::new(
                "m v / (a² η)",
                "Reynolds number of a block at the speed v in a fluid as dense as the block",
                v / units.viscosity(viscosity),
            )
            .expected(STOKES),
        ),
        _ => {}
    }
    if let Some(Agitation::Brownian { temperature }) = scene.agitation {
        out.push(DimensionlessGroup::new(
            "D τ / a²",
            match scene.drag {
                Some(_) => "diffusion in a tick, `drag` apart, which makes it less",
                None => "diffusion in a tick",
            },
            units.diffusion(BOLTZMANN * temperature / friction),
        ));
    }
}

/// The range of Stokes' drag alone.
///
/// # Source
/// A. Haider, O. Levenspiel, Powder Technology 58, 63, 1989: at 10 a cube's drag is twice Stokes'.
const STOKES: ExpectedRange = ExpectedRange {
    most: 10.0,
    beyond: "Stokes' drag alone slows blocks too little",
    remedy: "give the `fluid` its `density`, which adds the drag of wakes",
    kind: SceneWarningKind::StokesDrag,
};

/// The symbol of the part of a speed that `drag` takes in a tick.
pub(super) const DRAG_SYMBOL: &str = "γ τ";

/// What drag may take in a step. A force acts before it, so that a terminal speed lacks half of that.
const DRAG: f64 = 0.2;

/// A spring is resolved when its angle in a step, √(k/m) τ, is less than half a radian; or, where drag
/// rules, when a step does not go beyond its end, so that the group is less than 1.
const SPRING: f64 = 0.25;

fn contact(scene: &Scene, push: Push, out: &mut Vec<DimensionlessGroup>) {
    let Some(contact) = &scene.contact else {
        return;
    };
    let ContactLaw::Compliant { stiffness, damping } = contact.law else {
        return;
    };
    let units = BlockUnits::from_scene(scene);
    let (stiffness, damping) = (units.stiffness(stiffness), units.damping(damping));
    out.push(push.spring(
        ["k τ² / m, contact", "φ k τ² / m, contact"],
        "stiffness of a contact",
        stiffness,
        "a collision is over within a step or two",
    ));
    if damping > 0.0 {
        let value = |steps: f64| damping * steps * push.displacement(steps);
        let symbols = ["c τ / m, contact", "φ c τ / m, contact"];
        out.push(
            DimensionlessGroup::new(push.symbol(symbols), "damping of a contact", value(1.0))
                .limited(
                    |_| 0.5,
                    value,
                    "damping turns a motion round instead of braking it",
                ),
        );
    }
    out.push(DimensionlessGroup::new(
        "c / (2 √(k m)), contact",
        "damping ratio of a block against something fixed",
        speed::damping_ratio(stiffness, damping),
    ));
    out.push(DimensionlessGroup::new(
        "e, two blocks",
        "restitution that this amounts to, head-on",
        speed::restitution(scene, contact, true),
    ));
}

fn gas(scene: &Scene, v: Option<f64>, out: &mut Vec<DimensionlessGroup>) {
    let Some(gas) = Gas::from_scene(scene) else {
        return;
    };
    out.push(DimensionlessGroup::new(
        "N a³ / V",
        "part of the enclosure that free blocks fill",
        gas.density,
    ));
    if scene.contact.is_none() {
        return;
    }
    out.push(DimensionlessGroup::new(
        "ℓ / a",
        "mean free path between other blocks",
        gas.free_path(),
    ));
    if let Some(v) = v {
        out.push(DimensionlessGroup::new(
            "ν τ",
            "collisions of a block with others in a tick",
            gas.meetings(v),
        ));
    }
}

fn settling(scene: &Scene, out: &mut Vec<DimensionlessGroup>) {
    let Some(settling) = Settling::from_scene(scene) else {
        return;
    };
    let units = BlockUnits::from_scene(scene);
    if let Some(speeds) = settling.speeds {
        let meaning = "speed of sinking against the vertical speed of the eddies";
        out.push(DimensionlessGroup::new("w / α σ", meaning, speeds));
    }
    let meaning = "height over which sinking thins the blocks that are lifted to 1/e, in sides";
    out.push(DimensionlessGroup::new(
        "h / a",
        meaning,
        units.length(settling.height),
    ));
    if let Some(Enclosure::Hemisphere { radius, .. } | Enclosure::Sphere { radius, .. }) =
        &scene.enclosure
    {
        let meaning = "the same over the enclosure's radius";
        out.push(DimensionlessGroup::new(
            "h / R",
            meaning,
            settling.height / radius,
        ));
    }
    let meaning = "mean height of all blocks above where they settle, in sides";
    out.push(DimensionlessGroup::new(
        "⟨z⟩ / a",
        meaning,
        units.length(settling.mean()),
    ));
    out.push(DimensionlessGroup::new(
        "n(a) / n",
        "part of the blocks that is kept a side or more from where they settle",
        settling.above(scene.block.side),
    ));
}

impl DimensionlessGroup {
    const fn new(symbol: &'static str, meaning: &'static str, value: f64) -> DimensionlessGroup {
        DimensionlessGroup {
            symbol,
            meaning,
            value,
            limit: None,
            expected: None,
            of_faces: false,
        }
    }

    const fn of_faces(mut self) -> DimensionlessGroup {
        self.of_faces = true;
        self
    }

    /// `at` is its value with so many steps a tick, and `most` what it may be then.
    fn limited(
        mut self,
        most: impl Fn(f64) -> f64,
        at: impl Fn(f64) -> f64,
        beyond: &'static str,
    ) -> DimensionlessGroup {
        self.limit = Some(ResolutionLimit {
            most: most(1.0),
            substeps: fewest(|steps| at(steps.into()) <= most(steps.into())),
            beyond,
        });
        self
    }

    const fn expected(mut self, expected: ExpectedRange) -> DimensionlessGroup {
        self.expected = Some(expected);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_steps_that_resolve_a_group_are_told() {
        for (value, most, power, substeps) in [
            (0.05, 0.1, 1, Some(1)),
            (0.1, 0.1, 1, Some(1)),
            (0.2636, 0.1, 1, Some(3)),
            (6.0, 1.0, 2, Some(3)),
            (4.0, 1.0, 2, Some(2)),
            (4.0001, 1.0, 2, Some(3)),
            (1e12, 1.0, 1, None),
            (f64::INFINITY, 1.0, 2, None),
        ] {
            let at = |steps: f64| value / steps.powi(power);
            let group = DimensionlessGroup::new("", "", value).limited(|_| most, at, "");
            assert_eq!(group.substeps(), substeps, "{value}");
            assert_eq!(group.is_exceeded(1), substeps != Some(1), "{value}");
            if let Some(substeps) = substeps {
                assert!(!group.is_exceeded(substeps) && !group.is_exceeded(substeps + 1));
                assert!(substeps == 1 || group.is_exceeded(substeps - 1), "{value}");
            }
        }
        assert_eq!(DimensionlessGroup::new("", "", 1e9).substeps(), None);
    }
}
