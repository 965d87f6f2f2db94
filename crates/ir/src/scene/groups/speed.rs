//! How fast free blocks are in the long run.
use serde::Serialize;

use super::super::{Agitation, BOLTZMANN, Contact, ContactLaw, Flow, Fluid, Scene};
use super::{BlockUnits, Gas};

/// The speed that a free block is expected to have in the long run, away from magnets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Speed {
    /// The root of the mean square \[m/s\]; `None`: it never stops growing.
    pub rms: Option<f64>,
    /// What it follows from.
    pub from: SpeedFrom,
}

/// What an expected speed follows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SpeedFrom {
    /// Nothing kicks the blocks, and they begin at rest.
    Rest,
    /// Kicks and drag alone: exact. In a viscous fluid, the mean velocity of a tick.
    Drag,
    /// Kicks against what inelastic collisions, and drag if there is any, take away: an estimate.
    Collisions,
    /// Kicks against the drag of wakes, and what else slows blocks: an estimate.
    Wakes,
    /// Kicks, and nothing to take their energy away again.
    Nothing,
    /// Eddies that take the blocks along: that of the fluid, which heavy blocks do not quite reach.
    Eddies,
    /// The heat of a viscous fluid: the mean velocity of a tick, exact.
    Heat,
}

/// The speed that the terms of a scene lead to, a mean flow apart.
pub fn speed(scene: &Scene) -> Speed {
    speed_in(scene, 1.0)
}

fn speed_in(scene: &Scene, steps: f64) -> Speed {
    let units = BlockUnits::from_scene(scene);
    if let Some(speed) = of_fluid(scene, steps) {
        return speed;
    }
    let kick = kick(scene) * mean_left(viscous(scene) / steps);
    let of_rms = |rms: f64, from| Speed {
        rms: Some(units.speed_si(rms)),
        from,
    };
    if kick == 0.0 {
        return of_rms(0.0, SpeedFrom::Rest);
    }
    // The drag of a fluid is in the kick already; any other acts on what the kick has made.
    let gain = kick * kick * left_by_drag(scene);
    let left = left_by_drag(scene) * (-2.0 * viscous(scene)).exp();
    let (collisions, wakes) = (collisions(scene), wakes(scene));
    if wakes > 0.0 {
        of_rms(balance(gain, left, collisions + wakes), SpeedFrom::Wakes)
    } else if collisions > 0.0 {
        of_rms(balance(gain, left, collisions), SpeedFrom::Collisions)
    } else if left < 1.0 {
        of_rms((gain / (1.0 - left)).sqrt(), SpeedFrom::Drag)
    } else {
        Speed {
            rms: None,
            from: SpeedFrom::Nothing,
        }
    }
}

/// The part of the square of a speed that `drag` leaves of it in a tick.
pub(super) fn left_by_drag(scene: &Scene) -> f64 {
    let rate = scene.drag.as_ref().map_or(0.0, |drag| drag.rate);
    (-2.0 * BlockUnits::from_scene(scene).rate(rate)).exp()
}

/// φ: the mean over a step of what a viscous drag leaves of a velocity, of which it takes so much in it.
pub(super) fn mean_left(taken: f64) -> f64 {
    if taken < 1e-8 {
        1.0
    } else {
        -f64::exp_m1(-taken) / taken
    }
}

/// The speed at which the mean flow takes blocks along, at most \[m/s\]; 0 without one.
pub fn carried(scene: &Scene) -> f64 {
    match &scene.flow {
        Some(Flow::Stir(stir)) => stir.follow * stir.speed(),
        Some(Flow::Jets(jets)) => jets.speed(),
        None => 0.0,
    }
}

/// Returns the speed of blocks that meet contacts or shell \[m/s\], mean flow included.
///
/// `away`: the distance from the mouth of a jet \[m\]. `None` if the speed never stops growing.
pub(super) fn impact(scene: &Scene, away: f64) -> Option<f64> {
    Some(energetic(scene)?.hypot(flow_at(scene, away)))
}

/// Returns the drag of the fluid on a block that something holds \[N\], in mean flow and eddies.
///
/// `away`: the distance from the mouth of a jet \[m\].
pub(super) fn flow_force(scene: &Scene, away: f64) -> f64 {
    let (Some(fluid), side) = (&scene.fluid, scene.block.side) else {
        return 0.0;
    };
    let eddies = match &scene.agitation {
        Some(Agitation::Turbulence(_)) => speed(scene).rms.unwrap_or(0.0),
        _ => 0.0,
    };
    let speed = eddies.hypot(flow_at(scene, away));
    let linear = fluid.viscosity.map_or(0.0, |it| Fluid::friction(it, side));
    let square = fluid.density.map_or(0.0, |it| Fluid::wake(it, side));
    linear * speed + square * speed * speed
}

/// Returns the largest speed of the mean flow, of jets at a distance from their mouths \[m/s\].
fn flow_at(scene: &Scene, away: f64) -> f64 {
    let slowed = match &scene.flow {
        Some(Flow::Jets(jets)) => (JET * jets.nozzle / away).min(1.0),
        _ => 1.0,
    };
    carried(scene) * slowed
}

/// Speed on the axis of a round jet, over that at its mouth, at one diameter.
///
/// # Source
/// S. B. Pope, Turbulent Flows, 2000, 5.1.
const JET: f64 = 6.2;

/// The rms speed by which free blocks have their energy of motion \[m/s\], where velocities that are means over a tick have less.
pub(super) fn energetic(scene: &Scene) -> Option<f64> {
    match scene.agitation {
        Some(Agitation::Brownian { temperature }) => {
            Some((3.0 * BOLTZMANN * temperature / scene.inertial_mass()).sqrt())
        }
        _ => speed(scene).rms,
    }
}

/// What a viscous drag takes from a velocity in a tick; 0 without one.
pub(super) fn viscous(scene: &Scene) -> f64 {
    let viscosity = scene.fluid.as_ref().and_then(|fluid| fluid.viscosity);
    viscosity.map_or(0.0, |viscosity| {
        BlockUnits::from_scene(scene).damping(Fluid::friction(viscosity, scene.block.side))
    })
}

/// The rms speed within one of so many steps of a tick, the first of those \[m/s\]; `None`: it never stops growing.
///
/// It depends on the step in a viscous fluid alone, where velocities are means over one. Where its drag rules, the heat moves a block
/// by √(6 D dt) in a step.
pub(super) fn in_steps(scene: &Scene, steps: f64) -> Option<f64> {
    speed_in(scene, steps).rms
}

/// How far a free block turns in one of so many steps of a tick, root mean square \[rad\]; `None`: it never stops growing.
///
/// Where turning has as much energy as moving has, as collisions and heat make it: m side² ω² / 6 = m v².
pub fn turn_in_steps(scene: &Scene, steps: f64) -> Option<f64> {
    let way = BlockUnits::from_scene(scene).speed(in_steps(scene, steps)?) / steps;
    Some(6.0_f64.sqrt() * way)
}

/// The speed that a fluid gives its blocks by chance, with so many steps a tick.
fn of_fluid(scene: &Scene, steps: f64) -> Option<Speed> {
    let fluid = scene.fluid.as_ref()?;
    match scene.agitation.as_ref()? {
        Agitation::Kicks { .. } => None,
        Agitation::Turbulence(turbulence) => {
            let level = turbulence.speed(scene.flow.as_ref());
            let all = level * (2.0 + turbulence.vertical * turbulence.vertical).sqrt();
            Some(Speed {
                rms: Some(all),
                from: SpeedFrom::Eddies,
            })
        }
        Agitation::Brownian { temperature } => {
            let (mass, tick) = (scene.inertial_mass(), scene.tick);
            let friction = Fluid::friction(fluid.viscosity?, scene.block.side);
            // Of the mean of a step: k T / m times tanh(x) / x, x = rate step / 2.
            let half = friction / mass * tick / steps / 2.0;
            let part = if half < 1e-6 { 1.0 } else { half.tanh() / half };
            Some(Speed {
                rms: Some((3.0 * BOLTZMANN * temperature / mass * part).sqrt()),
                from: SpeedFrom::Heat,
            })
        }
    }
}

/// The rms change of speed by the kicks of a tick \[side/tick\]; 0 without kicks.
pub fn kick(scene: &Scene) -> f64 {
    let Some(Agitation::Kicks { speed: (low, high) }) = scene.agitation else {
        return 0.0;
    };
    let units = BlockUnits::from_scene(scene);
    rms_of_range(units.speed(low), units.speed(high))
}

/// The rms of what is uniform between two values.
pub(in crate::scene) fn rms_of_range(low: f64, high: f64) -> f64 {
    ((low * low + low * high + high * high) / 3.0).sqrt()
}

/// What collisions take from the square of a speed in a tick, over the speed's third power
/// \[1/side\].
///
/// A meeting at the temperature T = m v^2 / 3 takes (1 - e^2) T on average, whatever the shapes: the
/// approaching speed of what meets has the mean square 2 T / (effective mass). Two blocks share the
/// loss, at the floor one bears it. Without friction.
fn collisions(scene: &Scene) -> f64 {
    let (Some(gas), Some(contact)) = (Gas::from_scene(scene), &scene.contact) else {
        return 0.0;
    };
    let lost = |pair| 1.0 - restitution(scene, contact, pair).powi(2);
    gas.meetings(1.0) * lost(true) / 3.0 + gas.landings(1.0) * lost(false) * 2.0 / 3.0
}

/// What wakes take from the square of a speed in a tick, over the speed's third power \[1/side\].
///
/// A wake slows a block by w v^2, and v^2 by 2 w v^3; the mean third power of Maxwell's speeds is (8 / 3) sqrt(2 / (3 pi))
/// times that of their root mean square.
fn wakes(scene: &Scene) -> f64 {
    let density = scene.fluid.as_ref().and_then(|fluid| fluid.density);
    density.map_or(0.0, |density| {
        let side = scene.block.side;
        let wake = Fluid::wake(density, side) * side / scene.inertial_mass();
        2.0 * wake * (8.0 / 3.0) * (2.0 / (3.0 * std::f64::consts::PI)).sqrt()
    })
}

/// The speed after a head-on collision over that before, of two blocks or one and something fixed.
pub(super) fn restitution(scene: &Scene, contact: &Contact, pair: bool) -> f64 {
    match contact.law {
        ContactLaw::Rigid { restitution } => restitution,
        ContactLaw::Compliant { stiffness, damping } => {
            let units = BlockUnits::from_scene(scene);
            let ratio = damping_ratio(units.stiffness(stiffness), units.damping(damping));
            // Two blocks meet like one of half the mass and something fixed.
            rebound(if pair { ratio * 2f64.sqrt() } else { ratio })
        }
    }
}

/// Of a block against something fixed, in block units.
pub(super) fn damping_ratio(stiffness: f64, damping: f64) -> f64 {
    damping / (2.0 * stiffness.sqrt())
}

/// The restitution of a spring with a damping ratio that is let go when it would begin to pull
/// (Schwager and Pöschel 2007).
fn rebound(ratio: f64) -> f64 {
    let off = (1.0 - ratio * ratio).abs().sqrt();
    let angle = if off < 1e-6 {
        1.0
    } else if ratio < 1.0 {
        ratio.acos() / off
    } else {
        ratio.acosh() / off
    };
    (-2.0 * ratio * angle).exp()
}

/// The v at which v^2 = v^2 left + gain - loss v^3.
fn balance(gain: f64, left: f64, loss: f64) -> f64 {
    let grows = |v: f64| v * v * left + gain - v * v - loss * v.powi(3);
    // With neither drag nor loss of the other kind, v would be at most this.
    let (mut low, mut high) = (0.0, (gain / loss).cbrt());
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if grows(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spring_throws_back_what_its_damping_leaves() {
        // Solved step by step, until the force would become an attraction.
        let solved = |ratio: f64| {
            let dt = 1e-5;
            let (mut depth, mut speed) = (0.0, 1.0);
            loop {
                let force = depth + 2.0 * ratio * speed;
                if force < 0.0 {
                    return -speed;
                }
                speed -= force * dt;
                depth += speed * dt;
            }
        };
        assert_eq!(rebound(0.0), 1.0);
        for ratio in [0.01, 0.2, 0.7, 0.999, 1.0, 1.001, 3.0] {
            let (told, solved) = (rebound(ratio), solved(ratio));
            assert!((told - solved).abs() < 1e-4, "{ratio}: {told}, {solved}");
        }
    }

    #[test]
    fn the_balance_holds() {
        for (gain, left, loss) in [(1e-2, 1.0, 0.03), (1e-2, 0.9, 0.03), (1e-18, 0.999, 7.0)] {
            let v = balance(gain, left, loss);
            let after = v * v * left + gain - loss * v.powi(3);
            assert!((after / (v * v) - 1.0).abs() < 1e-9, "{gain} {left} {loss}");
        }
    }
}
