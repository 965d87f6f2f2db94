//! All dimensionless numbers of a scene.
use super::block_units::BlockUnits;
use super::gas::Gas;
use super::number::{AdvisedRange, DimensionlessNumber, ExpectedRange};
use super::settling::Settling;
use super::softness;
use super::speed::{self, speed};
use super::suction::suction;
use crate::scene::warning_kind::SceneWarningKind;
use crate::scene::{Agitation, BOLTZMANN, Bond, ContactLaw, Enclosure, Fluid, Scene, Substeps};

/// Returns the dimensionless numbers of a scene's terms, with limits for these steps.
pub fn dimensionless_numbers(scene: &Scene, steps: Substeps) -> Vec<DimensionlessNumber> {
    let units = BlockUnits::from_scene(scene);
    let v = speed(scene).rms.map(|rms| units.speed(rms));
    let v = v.filter(|&v| v > 0.0);
    let energetic = speed::energetic(scene).map(|rms| units.speed(rms));
    let energetic = energetic.filter(|&v| v > 0.0);
    let push = Push::from_scene(scene, steps);
    let mut out = Vec::new();
    if let Some(v) = v {
        out.push(
            DimensionlessNumber::new("v τ / a", "block lengths that a block moves in a tick", v).limited(
                steps,
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
            out.push(DimensionlessNumber::new(
                "j / v",
                "a kick against the speed",
                kick / v,
            ));
        }
    }
    let carried = units.speed(speed::carried(scene));
    if carried > 0.0 {
        out.push(
            DimensionlessNumber::new(
                "u τ / a",
                "block lengths that the mean flow carries a block in a tick, at most",
                carried,
            )
            .limited(
                steps,
                |_| 0.1,
                |steps| carried / steps,
                "blocks overlap deeply before a contact repels them",
            ),
        );
    }
    if let Some(drag) = &scene.drag {
        let rate = units.rate(drag.rate);
        out.push(
            DimensionlessNumber::new(DRAG_SYMBOL, "what drag takes from a speed in a tick", rate)
                .limited(
                    steps,
                    |_| DRAG,
                    |steps| rate / steps,
                    "blocks that a steady force moves fall short of their terminal speed",
                ),
        );
    }
    fluid(scene, v, &mut out);
    bond(scene, push, energetic, &mut out);
    suction(scene, push, &mut out);
    if let Some(wall) = scene.enclosure.as_ref().map(Enclosure::wall) {
        let symbols = ["k τ² / m, wall", "φ k τ² / m, wall"];
        let beyond = "the wall throws blocks back with another energy";
        out.push(push.spring(
            symbols,
            "stiffness of the wall",
            units.stiffness(wall),
            beyond,
        ));
    }
    contact(scene, push, &mut out);
    gas(scene, v, &mut out);
    settling(scene, &mut out);
    softness::softness(scene, &mut out);
    out
}

/// Adds the numbers of the bond. `speed` is the energetic speed of a block \[block lengths / tick\].
fn bond(scene: &Scene, push: Push, speed: Option<f64>, out: &mut Vec<DimensionlessNumber>) {
    let units = BlockUnits::from_scene(scene);
    if let Some(Bond::Reject {
        magnets, anchor, ..
    }) = &scene.bond
    {
        let (hold, depth) = (units.force(magnets.hold), units.length(magnets.depth));
        out.push(push.anchoring(hold, units.length(anchor.within)));
        if let Some(v) = speed {
            out.push(
                DimensionlessNumber::new(
                    "F δ / (3 m v² / 2)",
                    "energy of a bond against that of two blocks' motion to each other",
                    hold * depth / 3.0 / (v * v / 2.0),
                )
                .advised(AdvisedRange::Least(1.0)),
            );
        }
    }
    if let Some(Bond::Attract { pull, anchor, .. }) = &scene.bond {
        let (force, reach) = (units.force(pull.force), units.length(pull.within));
        out.push(push.anchoring(force, units.length(anchor.within)));
        if let Some(v) = speed {
            out.push(
                DimensionlessNumber::new(
                    "F r / (m v² / 2)",
                    "work of the pull within its reach against the energy of motion",
                    force * reach / (v * v / 2.0),
                )
                .advised(AdvisedRange::Least(MIN_WORK)),
            );
        }
    }
}

/// Smallest ratio of a pull's work to the kinetic energy of a block. The smallest ratio in a
/// built-in scene is 0.64 (`hemisphere_soft`).
const MIN_WORK: f64 = 0.6;

/// Largest ratio of the sinking speed to the vertical speed of the eddies. Above it, eddies lift
/// fewer than a tenth of the blocks: erfc(1.6 / √2) = 0.11.
const MAX_SINKING: f64 = 1.6;

/// Converter from a force to the displacement of a block in one step.
#[derive(Clone, Copy)]
pub(super) struct Push {
    steps: Substeps,
    /// Fraction of a velocity that viscous drag removes per tick.
    pub(super) drag: f64,
}

impl Push {
    fn from_scene(scene: &Scene, steps: Substeps) -> Push {
        Push {
            steps,
            drag: speed::viscous(scene),
        }
    }

    /// Returns how far a unit force moves a block from rest in one step \[block lengths\]. The
    /// distance is φ / steps², with the φ that `left` returns.
    fn displacement(self, steps: f64) -> f64 {
        self.left(steps) / (steps * steps)
    }

    /// Returns φ, the fraction of a velocity that drag leaves, averaged over one step. 1 without
    /// drag.
    fn left(self, steps: f64) -> f64 {
        speed::mean_left(self.drag / steps)
    }

    /// Returns one of two symbols: `free` without drag, `slowed` with drag.
    fn symbol(self, [free, slowed]: [&'static str; 2]) -> &'static str {
        if self.drag > 0.0 { slowed } else { free }
    }

    /// Returns how far a pull moves a block from rest in one tick, divided by the capture distance.
    ///
    /// `force` is the pull \[block lengths / tick^2\], and `within` is the capture distance \[block
    /// lengths\].
    pub(super) fn anchoring(self, force: f64, within: f64) -> DimensionlessNumber {
        let value = force / within;
        DimensionlessNumber::new(
            self.symbol(["F τ² / (m d)", "φ F τ² / (m d)"]),
            "anchoring distances that the pull moves a block at rest in its first tick",
            value * self.displacement(1.0),
        )
        .of_faces()
        .limited(
            self.steps,
            // Without drag the motion is faster in the next step. With strong drag the window is
            // two distances wide.
            |steps| 2.0 - self.left(steps),
            |steps| value * self.displacement(steps),
            "a pulled block jumps over the place where it would be anchored",
        )
    }

    /// Returns the dimensionless number of a spring. `stiffness` is in block units \[1 / tick^2\].
    fn spring(
        self,
        symbols: [&'static str; 2],
        meaning: &'static str,
        stiffness: f64,
        beyond: &'static str,
    ) -> DimensionlessNumber {
        let value = |steps| stiffness * self.displacement(steps);
        DimensionlessNumber::new(self.symbol(symbols), meaning, value(1.0)).limited(
            self.steps,
            |steps| 1.0 - (1.0 - SPRING) * self.left(steps),
            value,
            beyond,
        )
    }
}

fn fluid(scene: &Scene, v: Option<f64>, out: &mut Vec<DimensionlessNumber>) {
    let Some(fluid) = &scene.fluid else {
        return;
    };
    let (units, side) = (BlockUnits::from_scene(scene), scene.block.side);
    let Some(viscosity) = fluid.viscosity else {
        return;
    };
    let friction = Fluid::friction(viscosity, side);
    out.push(DimensionlessNumber::new(
        "6 π η 0.675 a τ / m",
        "what viscous drag takes from a speed in a tick; exact for any step",
        units.damping(friction),
    ));
    let is_carried = matches!(scene.agitation, Some(Agitation::Turbulence(_)));
    match (fluid.density, v) {
        (Some(density), Some(v)) => out.push(DimensionlessNumber::new(
            "ρ v a / η",
            "Reynolds number of a block at the speed v",
            units.density(density) * v / units.viscosity(viscosity),
        )),
        (None, Some(v)) if !is_carried => out.push(
            DimensionlessNumber::new(
                "m v / (a² η)",
                "Reynolds number of a block at the speed v in a fluid as dense as the block",
                v / units.viscosity(viscosity),
            )
            .expected(STOKES),
        ),
        _ => {}
    }
    if let Some(Agitation::Brownian { temperature }) = scene.agitation {
        out.push(DimensionlessNumber::new(
            "D τ / a²",
            match scene.drag {
                Some(_) => "diffusion in a tick, `drag` apart, which makes it less",
                None => "diffusion in a tick",
            },
            units.diffusion(BOLTZMANN * temperature / friction),
        ));
    }
}

/// Largest Reynolds number for Stokes' drag alone. At a Reynolds number of 10, the drag of a cube
/// is twice Stokes' drag.
///
/// # Source
///
/// A. Haider and O. Levenspiel, Powder Technology 58, 63 (1989).
const STOKES: ExpectedRange = ExpectedRange {
    most: 10.0,
    beyond: "Stokes' drag alone slows blocks too little",
    remedy: "give the `fluid` its `density`, which adds the drag of wakes",
    kind: SceneWarningKind::StokesDrag,
};

/// Symbol of the fraction of a speed that `drag` removes per tick.
pub(crate) const DRAG_SYMBOL: &str = "γ τ";

/// Largest fraction of a speed that drag may remove per step. Forces act before drag, so terminal
/// speeds are too small by half of this fraction.
const DRAG: f64 = 0.2;

/// Limit of the dimensionless number of a spring without drag. The phase √(k/m) τ per step is then
/// half a radian. With stronger drag, the limit rises to 1. Up to 1, a step does not overshoot.
const SPRING: f64 = 0.25;

fn contact(scene: &Scene, push: Push, out: &mut Vec<DimensionlessNumber>) {
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
            DimensionlessNumber::new(push.symbol(symbols), "damping of a contact", value(1.0))
                .limited(
                    push.steps,
                    |_| 0.5,
                    value,
                    "damping turns a motion round instead of braking it",
                ),
        );
    }
    out.push(DimensionlessNumber::new(
        "c / (2 √(k m)), contact",
        "damping ratio of a block against something fixed",
        speed::damping_ratio(stiffness, damping),
    ));
    out.push(DimensionlessNumber::new(
        "e, two blocks",
        "restitution that this amounts to, head-on",
        speed::restitution(scene, contact, true),
    ));
}

fn gas(scene: &Scene, v: Option<f64>, out: &mut Vec<DimensionlessNumber>) {
    let Some(gas) = Gas::from_scene(scene) else {
        return;
    };
    let symbol = match scene.planar {
        Some(_) => "N a² / A",
        None => "N a³ / V",
    };
    out.push(DimensionlessNumber::new(
        symbol,
        "part of the enclosure that free blocks fill",
        gas.density,
    ));
    if scene.contact.is_none() {
        return;
    }
    out.push(DimensionlessNumber::new(
        "ℓ / a",
        "mean free path between other blocks",
        gas.free_path(),
    ));
    if let Some(v) = v {
        out.push(DimensionlessNumber::new(
            "ν τ",
            "collisions of a block with others in a tick",
            gas.meetings(v),
        ));
    }
}

fn settling(scene: &Scene, out: &mut Vec<DimensionlessNumber>) {
    let Some(settling) = Settling::from_scene(scene) else {
        return;
    };
    let units = BlockUnits::from_scene(scene);
    if let Some(speeds) = settling.speeds {
        let meaning = "speed of sinking against the vertical speed of the eddies";
        out.push(
            DimensionlessNumber::new("w / α σ", meaning, speeds)
                .advised(AdvisedRange::Most(MAX_SINKING)),
        );
    }
    let meaning = "height over which sinking thins the lifted blocks to 1/e, in block lengths";
    out.push(DimensionlessNumber::new(
        "h / a",
        meaning,
        units.length(settling.height),
    ));
    if let Some(enclosure) = &scene.enclosure {
        let (symbol, meaning, length) = match *enclosure {
            Enclosure::Disc { .. } | Enclosure::Rectangle { .. } => return,
            Enclosure::Hemisphere { radius, .. } | Enclosure::Sphere { radius, .. } => {
                ("h / R", "the same over the enclosure's radius", radius)
            }
            Enclosure::Box { height, .. } | Enclosure::Cylinder { height, .. } => {
                ("h / H", "the same over the enclosure's height", height)
            }
        };
        out.push(DimensionlessNumber::new(
            symbol,
            meaning,
            settling.height / length,
        ));
    }
    let meaning = "mean height of all blocks above their resting place, in block lengths";
    out.push(DimensionlessNumber::new(
        "⟨z⟩ / a",
        meaning,
        units.length(settling.mean()),
    ));
    out.push(DimensionlessNumber::new(
        "n(a) / n",
        "share of blocks a block length or more above their resting place",
        settling.above(scene.block.side),
    ));
}
