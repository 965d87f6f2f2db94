//! Numbers without a dimension that say how a scene behaves, the same at every scale.
//!
//! Some also say whether a step a tick is short enough for what happens in it: these have a limit.
//! docs/model.md derives them.
mod block_units;
mod gas;
mod speed;

use serde::Serialize;

pub use block_units::BlockUnits;
pub use gas::Gas;
pub(super) use speed::rms_of_range;
pub use speed::{Speed, SpeedFrom, speed};

use super::{Agitation, BOLTZMANN, Bond, ContactLaw, Enclosure, Fluid, Scene};

/// A number without a dimension.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Group {
    /// How it is made, in the symbols of the terms.
    pub symbol: &'static str,
    /// What it says.
    pub meaning: &'static str,
    /// Its value with one step a tick.
    pub value: f64,
    /// What it has to keep to, if it is one that steps have to resolve.
    pub limit: Option<Limit>,
}

/// The largest value of a group at which what it stands for is resolved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limit {
    /// The value, about.
    pub most: f64,
    /// K substeps a tick make the group smaller by K to this power.
    pub power: u8,
    /// What happens beyond it, as a clause.
    pub beyond: &'static str,
}

impl Group {
    /// Whether one step a tick is too long.
    pub fn is_exceeded(&self) -> bool {
        self.limit.is_some_and(|limit| self.value > limit.most)
    }

    /// The fewest substeps a tick that keep to the limit; `None` if there is none, or no number of them does.
    pub fn substeps(&self) -> Option<u32> {
        let limit = self.limit?;
        let within = |substeps: u32| self.value <= limit.most * power(substeps, limit.power);
        let guess = (self.value / limit.most).powf(1.0 / f64::from(limit.power));
        if guess.is_nan() || guess > f64::from(u32::MAX / 2) {
            return None;
        }
        // The root may be off by a rounding to either side.
        let least = (guess as u32).saturating_sub(1).max(1);
        (least..=least + 3).find(|&substeps| within(substeps))
    }
}

fn power(substeps: u32, power: u8) -> f64 {
    f64::from(substeps).powi(i32::from(power))
}

/// The groups of a scene, of those terms that it has.
pub fn groups(scene: &Scene) -> Vec<Group> {
    let units = BlockUnits::of(scene);
    let v = speed(scene).rms.map(|rms| units.speed(rms));
    let v = v.filter(|&v| v > 0.0);
    let mut out = Vec::new();
    if let Some(v) = v {
        out.push(
            Group::new("v τ / a", "sides that a block moves in a tick", v).limited(
                0.1,
                1,
                "blocks overlap deeply before a contact parts them, and slip through narrow gaps",
            ),
        );
        let kick = speed::kick(scene);
        if kick > 0.0 {
            out.push(Group::new("j / v", "a kick against the speed", kick / v));
        }
    }
    if let Some(drag) = &scene.drag {
        let meaning = "what drag takes from a speed in a tick";
        out.push(Group::new("γ τ", meaning, units.rate(drag.rate)));
    }
    fluid(scene, v, &mut out);
    if let Some(Bond::Reject {
        magnets, anchor, ..
    }) = &scene.bond
    {
        let (hold, depth) = (units.force(magnets.hold), units.length(magnets.depth));
        out.push(
            Group::new(
                "F τ² / (m d)",
                "anchoring distances that the magnets move a block in a tick",
                hold / units.length(anchor.within),
            )
            .limited(
                1.0,
                2,
                "a pulled block jumps over the place where it would be anchored",
            ),
        );
        if let Some(v) = v {
            out.push(Group::new(
                "F δ / (3 m v² / 2)",
                "energy of a bond against that of two blocks' motion to each other",
                hold * depth / 3.0 / (v * v / 2.0),
            ));
        }
    }
    if let Some(Bond::Attract { pull, anchor, .. }) = &scene.bond {
        let (force, reach) = (units.force(pull.force), units.length(pull.within));
        out.push(
            Group::new(
                "F τ² / (m d)",
                "anchoring distances that the pull moves a block in its first tick",
                force / units.length(anchor.within),
            )
            .limited(
                1.0,
                2,
                "a pulled block jumps over the place where it would be anchored",
            ),
        );
        if let Some(v) = v {
            out.push(Group::new(
                "F r / (m v² / 2)",
                "work of the pull within its reach against the energy of motion",
                force * reach / (v * v / 2.0),
            ));
        }
    }
    if let Some(Enclosure::Hemisphere { wall, .. } | Enclosure::Sphere { wall, .. }) =
        &scene.enclosure
    {
        out.push(
            Group::new(
                "k τ² / m, shell",
                "stiffness of the shell",
                units.stiffness(*wall),
            )
            .limited(
                SPRING,
                2,
                "the shell throws blocks back with another energy",
            ),
        );
    }
    contact(scene, &mut out);
    gas(scene, v, &mut out);
    out
}

fn fluid(scene: &Scene, v: Option<f64>, out: &mut Vec<Group>) {
    let Some(fluid) = &scene.fluid else {
        return;
    };
    let (units, side) = (BlockUnits::of(scene), scene.block.side);
    let Some(viscosity) = fluid.viscosity else {
        return;
    };
    let friction = Fluid::friction(viscosity, side);
    out.push(Group::new(
        "6 π η 0.6607 a τ / m",
        "what viscous drag takes from a speed in a tick; exact for any step",
        units.damping(friction),
    ));
    if let Some((density, v)) = fluid.density.zip(v) {
        out.push(Group::new(
            "ρ v a / η",
            "Reynolds number of a block at the speed v",
            units.density(density) * v / units.viscosity(viscosity),
        ));
    }
    if let Some(Agitation::Brownian { temperature }) = scene.agitation {
        out.push(Group::new(
            "D τ / a²",
            "diffusion in a tick",
            units.diffusion(BOLTZMANN * temperature / friction),
        ));
    }
}

/// A spring is resolved when its angle in a step, √(k/m) τ, is less than half a radian.
const SPRING: f64 = 0.25;

fn contact(scene: &Scene, out: &mut Vec<Group>) {
    let Some(contact) = &scene.contact else {
        return;
    };
    let ContactLaw::Compliant { stiffness, damping } = contact.law else {
        return;
    };
    let units = BlockUnits::of(scene);
    let (stiffness, damping) = (units.stiffness(stiffness), units.damping(damping));
    out.push(
        Group::new("k τ² / m, contact", "stiffness of a contact", stiffness).limited(
            SPRING,
            2,
            "a collision is over within a step or two",
        ),
    );
    if damping > 0.0 {
        out.push(
            Group::new("c τ / m, contact", "damping of a contact", damping).limited(
                0.5,
                1,
                "damping turns a motion round instead of braking it",
            ),
        );
    }
    out.push(Group::new(
        "c / (2 √(k m)), contact",
        "damping ratio of a block against something fixed",
        speed::damping_ratio(stiffness, damping),
    ));
    out.push(Group::new(
        "e, two blocks",
        "restitution that this amounts to, head-on",
        speed::restitution(scene, contact, true),
    ));
}

fn gas(scene: &Scene, v: Option<f64>, out: &mut Vec<Group>) {
    let Some(gas) = Gas::of(scene) else {
        return;
    };
    out.push(Group::new(
        "N a³ / V",
        "part of the enclosure that free blocks fill",
        gas.density,
    ));
    if scene.contact.is_none() {
        return;
    }
    out.push(Group::new(
        "ℓ / a",
        "mean free path between other blocks",
        gas.free_path(),
    ));
    if let Some(v) = v {
        out.push(Group::new(
            "ν τ",
            "collisions of a block with others in a tick",
            gas.meetings(v),
        ));
    }
}

impl Group {
    const fn new(symbol: &'static str, meaning: &'static str, value: f64) -> Group {
        Group {
            symbol,
            meaning,
            value,
            limit: None,
        }
    }

    const fn limited(mut self, most: f64, power: u8, beyond: &'static str) -> Group {
        self.limit = Some(Limit {
            most,
            power,
            beyond,
        });
        self
    }
}

#[cfg(test)]
mod tests;
