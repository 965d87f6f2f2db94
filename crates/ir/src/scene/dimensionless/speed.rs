//! Long-term speed of free blocks.
use serde::Serialize;

use super::super::{Agitation, BOLTZMANN, Contact, ContactLaw, Flow, Fluid, Scene};
use super::{BlockUnits, Gas, settling};

/// Expected long-term speed of a free block, away from magnets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Speed {
    /// Root mean square \[m/s\]. `None` if it grows without limit.
    pub rms: Option<f64>,
    /// Origin of the speed.
    pub from: SpeedFrom,
}

/// Origin of an expected speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SpeedFrom {
    /// The scene has no agitation, and blocks start at rest.
    Rest,
    /// Exact speed by random impulses and drag. In a viscous fluid, it is the mean velocity of a
    /// tick.
    Drag,
    /// Estimated speed by random impulses and inelastic collisions, possibly with drag.
    Collisions,
    /// Estimated speed by random impulses, wake drag and other losses.
    Wakes,
    /// Estimated speed by random impulses, friction with the table of a planar world, and other
    /// losses.
    Table,
    /// Random impulses without dissipation.
    Nothing,
    /// Speed of the eddies that carry the blocks. It is an upper limit for heavy blocks.
    Eddies,
    /// Exact speed by Brownian motion in a viscous fluid: the mean velocity of a tick.
    Heat,
}

/// Returns the expected speed in a scene, without mean flow.
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
    // Drag of a fluid is included in the impulse. The clause `drag` acts after it.
    let gain = kick * kick * left_by_drag(scene);
    let left = left_by_drag(scene) * (-2.0 * viscous(scene)).exp();
    let (collisions, wakes, table) = (collisions(scene), wakes(scene), table(scene));
    let from = if wakes > 0.0 {
        SpeedFrom::Wakes
    } else if table > 0.0 {
        SpeedFrom::Table
    } else if collisions > 0.0 {
        SpeedFrom::Collisions
    } else if left < 1.0 {
        return of_rms((gain / (1.0 - left)).sqrt(), SpeedFrom::Drag);
    } else {
        return Speed {
            rms: None,
            from: SpeedFrom::Nothing,
        };
    };
    of_rms(balance(gain, left, table, collisions + wakes), from)
}

/// Returns the number of translations of a block.
fn directions(scene: &Scene) -> f64 {
    if scene.planar.is_some() { 2.0 } else { 3.0 }
}

/// Returns the loss of squared speed by friction with the table per tick, divided by the speed
/// \[block lengths / tick\]. 0 without friction.
///
/// Friction with the deceleration f takes 2 f v from v². The speed v is Maxwell's mean in a plane.
fn table(scene: &Scene) -> f64 {
    let Some(friction) = scene.table_friction() else {
        return 0.0;
    };
    let deceleration = friction * settling::weight(scene).max(0.0);
    let mean = std::f64::consts::PI.sqrt() / 2.0;
    2.0 * mean * BlockUnits::from_scene(scene).acceleration(deceleration)
}

/// Returns the fraction of the squared speed that the clause `drag` leaves per tick.
pub(super) fn left_by_drag(scene: &Scene) -> f64 {
    let rate = scene.drag.as_ref().map_or(0.0, |drag| drag.rate);
    (-2.0 * BlockUnits::from_scene(scene).rate(rate)).exp()
}

/// Returns φ, the fraction of a velocity that viscous drag leaves, averaged over a step. `taken` is
/// the drag rate times the step.
pub(super) fn mean_left(taken: f64) -> f64 {
    if taken < 1e-8 {
        1.0
    } else {
        -f64::exp_m1(-taken) / taken
    }
}

/// Returns the largest speed of blocks carried by the mean flow \[m/s\]. Returns 0 without mean
/// flow.
pub fn carried(scene: &Scene) -> f64 {
    match &scene.flow {
        Some(Flow::Stir(stir)) => stir.follow * stir.speed(),
        Some(Flow::Jets(jets)) => jets.speed(),
        None => 0.0,
    }
}

/// Returns the speed of blocks that hit contacts or wall, including mean flow \[m/s\].
///
/// `away` is the distance from the mouth of a jet \[m\]. Returns `None` if the speed grows without
/// limit.
pub(super) fn impact(scene: &Scene, away: f64) -> Option<f64> {
    Some(energetic(scene)?.hypot(flow_at(scene, away)))
}

/// Returns the fluid's drag on a held block in mean flow and eddies \[N\].
///
/// `away` is the distance from the mouth of a jet \[m\].
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

/// Returns the largest speed of the mean flow \[m/s\]. For jets, `away` is the distance from their
/// mouths \[m\].
fn flow_at(scene: &Scene, away: f64) -> f64 {
    let slowed = match &scene.flow {
        Some(Flow::Jets(jets)) => (JET * jets.nozzle / away).min(1.0),
        _ => 1.0,
    };
    carried(scene) * slowed
}

/// Decay constant of a round jet. The speed on the axis, relative to the mouth, is this constant
/// divided by the distance in diameters.
///
/// # Source
///
/// S. B. Pope, Turbulent Flows (2000), section 5.1.
const JET: f64 = 6.2;

/// Returns the rms speed that corresponds to the kinetic energy \[m/s\]. Velocities averaged over a
/// tick are smaller. Returns `None` if the speed grows without limit.
pub(super) fn energetic(scene: &Scene) -> Option<f64> {
    match scene.agitation {
        Some(Agitation::Brownian { temperature }) => {
            Some((directions(scene) * BOLTZMANN * temperature / scene.inertial_mass()).sqrt())
        }
        _ => speed(scene).rms,
    }
}

/// Returns the viscous drag rate per tick. 0 without drag.
pub(super) fn viscous(scene: &Scene) -> f64 {
    let viscosity = scene.fluid.as_ref().and_then(|fluid| fluid.viscosity);
    viscosity.map_or(0.0, |viscosity| {
        BlockUnits::from_scene(scene).damping(Fluid::friction(viscosity, scene.block.side))
    })
}

/// Returns the rms speed in the first step of a tick with this number of steps \[m/s\]. Returns
/// `None` if the speed grows without limit.
///
/// The speed depends on the step only in a viscous fluid, where velocities are step averages. Under
/// strong drag, Brownian motion moves a block by √(6 D dt) per step.
pub(super) fn in_steps(scene: &Scene, steps: f64) -> Option<f64> {
    speed_in(scene, steps).rms
}

/// Returns the rms rotation of a free block per step \[rad\], or `None` if it grows without limit.
///
/// Assumes equipartition, as collisions and heat establish it: m a² ω² / 6 = m v². In a plane, half
/// of this energy turns a block.
pub fn turn_in_steps(scene: &Scene, steps: f64) -> Option<f64> {
    let distance = BlockUnits::from_scene(scene).speed(in_steps(scene, steps)?) / steps;
    let share = if scene.planar.is_some() { 3.0 } else { 6.0_f64 };
    Some(share.sqrt() * distance)
}

/// Returns the random speed of blocks in a fluid, for this number of steps per tick. Returns `None`
/// if no fluid moves the blocks at random.
fn of_fluid(scene: &Scene, steps: f64) -> Option<Speed> {
    let fluid = scene.fluid.as_ref()?;
    match scene.agitation.as_ref()? {
        Agitation::Kicks { .. } => None,
        Agitation::Turbulence(turbulence) => {
            let level = turbulence.speed(scene.flow.as_ref());
            let vertical = match scene.planar {
                Some(_) => 0.0,
                None => turbulence.vertical,
            };
            let all = level * (2.0 + vertical * vertical).sqrt();
            Some(Speed {
                rms: Some(all),
                from: SpeedFrom::Eddies,
            })
        }
        Agitation::Brownian { temperature } => {
            let (mass, tick) = (scene.inertial_mass(), scene.tick);
            let friction = Fluid::friction(fluid.viscosity?, scene.block.side);
            // Mean over a step: k T / m times tanh(x) / x, with x = rate step / 2.
            let half = friction / mass * tick / steps / 2.0;
            let part = if half < 1e-6 { 1.0 } else { half.tanh() / half };
            Some(Speed {
                rms: Some((directions(scene) * BOLTZMANN * temperature / mass * part).sqrt()),
                from: SpeedFrom::Heat,
            })
        }
    }
}

/// Returns the rms velocity change by random impulses per tick \[block lengths / tick\]. Returns 0
/// if the scene has no random impulses.
pub fn kick(scene: &Scene) -> f64 {
    let Some(Agitation::Kicks { speed: (low, high) }) = scene.agitation else {
        return 0.0;
    };
    let units = BlockUnits::from_scene(scene);
    rms_of_range(units.speed(low), units.speed(high))
}

/// Returns the rms of a uniform distribution from `low` to `high`.
pub(in crate::scene) fn rms_of_range(low: f64, high: f64) -> f64 {
    ((low * low + low * high + high * high) / 3.0).sqrt()
}

/// Returns the loss of squared speed by collisions per tick, divided by the cubed speed \[1 / block
/// length\].
///
/// A collision at temperature T = m v^2 / 3, or m v^2 / 2 in a plane, removes (1 - e^2) T on average, for any shapes. The
/// approach speed has the mean square 2 T / (effective mass). Two blocks share the loss. At the
/// floor, one block bears it. Neglects friction.
fn collisions(scene: &Scene) -> f64 {
    let (Some(gas), Some(contact)) = (Gas::from_scene(scene), &scene.contact) else {
        return 0.0;
    };
    let lost = |pair| 1.0 - restitution(scene, contact, pair).powi(2);
    let directions = directions(scene);
    gas.meetings(1.0) * lost(true) / directions + gas.landings(1.0) * lost(false) * 2.0 / directions
}

/// Returns the loss of squared speed by wakes per tick, divided by the cubed speed \[1 / block
/// length\].
///
/// A wake slows a block by w v^2, and v^2 by 2 w v^3. The mean cube of Maxwell's speeds is (8 / 3)
/// sqrt(2 / (3 pi)) times the cubed rms speed.
fn wakes(scene: &Scene) -> f64 {
    let density = scene.fluid.as_ref().and_then(|fluid| fluid.density);
    density.map_or(0.0, |density| {
        let side = scene.block.side;
        let wake = Fluid::wake(density, side) * side / scene.inertial_mass();
        2.0 * wake * (8.0 / 3.0) * (2.0 / (3.0 * std::f64::consts::PI)).sqrt()
    })
}

/// Returns the coefficient of restitution of a head-on collision. If `pair` is true, two blocks
/// collide. Otherwise, a block hits a fixed body.
pub(super) fn restitution(scene: &Scene, contact: &Contact, pair: bool) -> f64 {
    match contact.law {
        ContactLaw::Rigid { restitution } => restitution,
        ContactLaw::Compliant { stiffness, damping } => {
            let units = BlockUnits::from_scene(scene);
            let ratio = damping_ratio(units.stiffness(stiffness), units.damping(damping));
            // Two blocks collide like one of half the mass with a fixed body.
            rebound(if pair { ratio * 2f64.sqrt() } else { ratio })
        }
    }
}

/// Returns the damping ratio of a block against a fixed body, in block units.
pub(super) fn damping_ratio(stiffness: f64, damping: f64) -> f64 {
    damping / (2.0 * stiffness.sqrt())
}

/// Returns the restitution of a damped spring that is released when it would begin to pull.
///
/// # Source
///
/// T. Schwager and T. Pöschel (2007).
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

/// Returns the speed v that solves v^2 = v^2 `left` + `gain` - `steady` v - `loss` v^3.
fn balance(gain: f64, left: f64, steady: f64, loss: f64) -> f64 {
    let grows = |v: f64| v * v * left + gain - v * v - steady * v - loss * v.powi(3);
    // Upper bounds, attained without drag.
    let (mut low, mut high) = (0.0, (gain / loss).cbrt().min(gain / steady));
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
    fn rebound_of_a_spring_agrees_with_its_equation() {
        // Integrates step by step until the force would become attractive.
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
            let (estimated, solved) = (rebound(ratio), solved(ratio));
            assert!(
                (estimated - solved).abs() < 1e-4,
                "{ratio}: {estimated}, {solved}"
            );
        }
    }

    #[test]
    fn power_is_balanced() {
        for (gain, left, steady, loss) in [
            (1e-2, 1.0, 0.0, 0.03),
            (1e-2, 0.9, 0.0, 0.03),
            (1e-18, 0.999, 0.0, 7.0),
            (1e-2, 1.0, 0.5, 0.0),
            (1e-2, 0.9, 0.02, 0.03),
            (1e-18, 0.999, 1e-8, 7.0),
        ] {
            let v = balance(gain, left, steady, loss);
            let after = v * v * left + gain - steady * v - loss * v.powi(3);
            let error = after / (v * v) - 1.0;
            assert!(error.abs() < 1e-9, "{gain} {left} {steady} {loss}");
        }
    }
}
