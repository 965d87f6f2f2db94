use super::super::{Contact, Drag, built_in};
use super::*;

fn hemisphere() -> Scene {
    built_in("hemisphere_2005").expect("it is built in")
}

/// The values of a scene's groups, by symbol.
fn values(scene: &Scene) -> Vec<(&'static str, f64)> {
    let groups = groups(scene);
    groups.iter().map(|it| (it.symbol, it.value)).collect()
}

fn close(told: f64, by_hand: f64) -> bool {
    (told / by_hand - 1.0).abs() < 1e-4
}

#[track_caller]
fn are(told: &[(&str, f64)], by_hand: &[(&str, f64)]) {
    let right = told.len() == by_hand.len()
        && told
            .iter()
            .zip(by_hand)
            .all(|(a, b)| a.0 == b.0 && close(a.1, b.1));
    assert!(right, "{told:?} and not {by_hand:?}");
}

fn compliant(stiffness: f64, damping: f64) -> Option<Contact> {
    Some(Contact {
        law: ContactLaw::Compliant { stiffness, damping },
        friction: 0.2,
    })
}

#[test]
fn the_groups_of_the_default_scene() {
    // In sides, blocks and ticks: n = 300 / (2/3 π 25^3) = 0.0091673; a cross-section of
    // (12 + 4.5 π) / 4 = 6.5343, so that ℓ = 1 / (√2 n 6.5343) = 11.804. At v the mean speed is
    // 0.92132 v: 0.078052 v meetings a tick, each for v^2 / 3, and 0.92132 v / 4 * 3 / 50 = 0.013820 v
    // landings, each for 2 v^2 / 3: in all 0.035230 v^3, which is j^2 = 0.044^2 / 3 at v = 0.26360.
    are(
        &values(&hemisphere()),
        &[
            ("v τ / a", 0.26360),
            ("j / v", 0.096371),
            ("F τ² / (m d)", 6.0),
            ("F r / (m v² / 2)", 0.86350),
            ("k τ² / m, shell", 0.01),
            ("N a³ / V", 0.0091673),
            ("ℓ / a", 11.804),
            ("ν τ", 0.020574),
        ],
    );
    let speed = speed(&hemisphere());
    assert_eq!(speed.from, SpeedFrom::Collisions);
    assert!(close(speed.rms.unwrap(), 2.6360), "{speed:?}");
}

#[test]
fn a_compliant_contact_has_groups_of_its_own() {
    let scene = Scene {
        contact: compliant(400.0, 8.0),
        ..hemisphere()
    };
    // k τ² / m = 0.16, c τ / m = 0.16, ratio 0.2, of a pair 0.28284: 1 - ratio^2 = 0.92 and
    // acos(0.28284) = 1.28404, so that e = exp(-2 0.28284 1.28404 / √0.92) = 0.46898.
    are(
        &values(&scene)[5..9],
        &[
            ("k τ² / m, contact", 0.16),
            ("c τ / m, contact", 0.16),
            ("c / (2 √(k m)), contact", 0.2),
            ("e, two blocks", 0.46898),
        ],
    );
    let undamped = Scene {
        contact: compliant(400.0, 0.0),
        ..hemisphere()
    };
    assert_eq!(speed(&undamped).from, SpeedFrom::Nothing);
}

#[test]
fn with_drag_alone_the_speed_is_that_of_the_stationary_variance() {
    let mut scene = Scene {
        drag: Some(Drag { rate: 5.0 }),
        contact: None,
        ..hemisphere()
    };
    // γ τ = 0.1: j^2 e^-0.2 / (1 - e^-0.2) = 0.0645333 * 4.516656, in m^2/s^2.
    let told = speed(&scene);
    assert_eq!(told.from, SpeedFrom::Drag);
    assert!(close(told.rms.unwrap(), 0.53989), "{told:?}");
    are(&values(&scene)[..1], &[("v τ / a", 0.053989)]);
    are(&values(&scene)[2..3], &[("γ τ", 0.1)]);
    let symbols: Vec<_> = values(&scene).iter().map(|it| it.0).collect();
    assert!(!symbols.contains(&"ν τ"), "nothing collides: {symbols:?}");

    // Collisions take some more, the more the weaker the drag.
    scene.contact = hemisphere().contact;
    let both = speed(&scene);
    assert_eq!(both.from, SpeedFrom::Collisions);
    assert!(both.rms < told.rms && both.rms.unwrap() > 0.9 * told.rms.unwrap());
    scene.drag = Some(Drag { rate: 1e-9 });
    assert!(close(speed(&scene).rms.unwrap(), 2.6360));
}

#[test]
fn without_a_speed_nothing_is_said_that_needs_one() {
    let still = Scene {
        agitation: None,
        ..hemisphere()
    };
    let told = speed(&still);
    assert_eq!((told.rms, told.from), (Some(0.0), SpeedFrom::Rest));
    let elastic = Scene {
        contact: Some(Contact {
            law: ContactLaw::Rigid { restitution: 1.0 },
            friction: 0.0,
        }),
        ..hemisphere()
    };
    assert_eq!(speed(&elastic).rms, None);
    for scene in [still, elastic] {
        let symbols: Vec<_> = values(&scene).iter().map(|it| it.0).collect();
        assert_eq!(
            symbols,
            ["F τ² / (m d)", "k τ² / m, shell", "N a³ / V", "ℓ / a"]
        );
    }
}

#[test]
fn a_scene_at_another_scale_has_the_same_groups() {
    let scene = Scene {
        drag: Some(Drag { rate: 0.5 }),
        contact: compliant(400.0, 8.0),
        ..hemisphere()
    };
    let mut scaled = scene.clone();
    let (side, mass, tick) = (1.0 / 1024.0, 8.0, 0.25);
    scaled.tick *= tick;
    scaled.block.side *= side;
    scaled.block.mass *= mass;
    let force = mass * side / (tick * tick);
    if let Some(Enclosure::Hemisphere { radius, wall }) = &mut scaled.enclosure {
        *radius *= side;
        *wall *= force / side;
    }
    if let Some(super::super::Agitation::Kicks { speed }) = &mut scaled.agitation {
        *speed = (speed.0 * side / tick, speed.1 * side / tick);
    }
    scaled.drag = Some(Drag { rate: 0.5 / tick });
    scaled.contact = compliant(400.0 * force / side, 8.0 * mass / tick);
    if let Some(Bond::Attract { pull, anchor, .. }) = &mut scaled.bond {
        pull.force *= force;
        pull.within *= side;
        anchor.within *= side;
    }
    assert_eq!(
        values(&scaled),
        values(&scene),
        "powers of two round nothing"
    );
}

#[test]
fn substeps_are_as_many_as_a_limit_needs() {
    let group = |value, most, power| Group::new("", "", value).limited(most, power, "");
    for (value, most, power, exceeded, substeps) in [
        (0.05, 0.1, 1, false, Some(1)),
        (0.1, 0.1, 1, false, Some(1)),
        (0.2636, 0.1, 1, true, Some(3)),
        (6.0, 1.0, 2, true, Some(3)),
        (4.0, 1.0, 2, true, Some(2)),
        (4.0001, 1.0, 2, true, Some(3)),
        (1e12, 1.0, 1, true, None),
        (f64::INFINITY, 1.0, 2, true, None),
    ] {
        let group = group(value, most, power);
        assert_eq!(
            (group.is_exceeded(), group.substeps()),
            (exceeded, substeps),
            "{value}"
        );
    }
    assert_eq!(Group::new("", "", 1e9).substeps(), None);
    let exceeded: Vec<_> = (groups(&hemisphere()).iter())
        .filter(|group| group.is_exceeded())
        .map(|group| (group.symbol, group.substeps()))
        .collect();
    assert_eq!(exceeded, [("v τ / a", Some(3)), ("F τ² / (m d)", Some(3))]);
}

#[test]
fn heat_and_eddies_give_blocks_their_speed() {
    use super::super::{Agitation, Flow, Fluid, Strength};
    let mut tank = built_in("magnet_tank").unwrap();
    let told = speed(&tank);
    assert_eq!(told.from, SpeedFrom::Eddies);
    // 3 % of a ring's 8.5 cm at 0.455 turns a second, in three directions.
    let exact = 0.03 * 0.085 * 0.455 * std::f64::consts::TAU * 3f64.sqrt();
    assert!((told.rms.unwrap() / exact - 1.0).abs() < 1e-12);
    let Some(Agitation::Turbulence(turbulence)) = &mut tank.agitation else {
        panic!("no turbulence");
    };
    (turbulence.strength, turbulence.vertical) = (Strength::Speed(0.1), 2.0);
    assert!((speed(&tank).rms.unwrap() - 0.1 * 6f64.sqrt()).abs() < 1e-12);
    assert!(matches!(tank.flow, Some(Flow::Stir(_))));

    let value = |scene: &Scene, symbol| {
        let group = groups(scene)
            .into_iter()
            .find(|group| group.symbol == symbol);
        group.unwrap().value
    };
    tank.agitation = Some(Agitation::Brownian { temperature: 300.0 });
    let friction = Fluid::friction(0.06, 0.1);
    let short = BOLTZMANN * 300.0 / friction * tank.tick / 0.01;
    assert!((value(&tank, "D τ / a²") / short - 1.0).abs() < 1e-12);
    // A tick far shorter than the drag needs: all of the heat; one far longer: what diffusion makes of it.
    assert_eq!(speed(&tank).from, SpeedFrom::Heat);
    let thermal = 3.0 * BOLTZMANN * 300.0 / tank.block.mass;
    assert!((speed(&tank).rms.unwrap().powi(2) / thermal - 1.0).abs() < 1e-3);
    tank.tick = 1e6;
    let diffusion = BOLTZMANN * 300.0 / friction;
    let slow = 6.0 * diffusion / tank.tick;
    assert!((speed(&tank).rms.unwrap().powi(2) / slow - 1.0).abs() < 1e-3);
}
