use stochc_ir::scene::dimensionless::{
    DimensionlessNumber, Settling, SpeedFrom, dimensionless_numbers, speed,
};
use stochc_ir::scene::{
    Agitation, BOLTZMANN, Bond, Contact, ContactLaw, Drag, Enclosure, Flow, Fluid, Pump, Scene,
    Stir, Strength, Substeps, Suction,
};

use crate::scene::built_in;

fn hemisphere() -> Scene {
    built_in("hemisphere_2005").expect("a built-in scene")
}

const ONE_STEP: Substeps = Substeps {
    near: 1,
    away: None,
};

fn numbers(scene: &Scene) -> Vec<DimensionlessNumber> {
    dimensionless_numbers(scene, ONE_STEP)
}

/// Returns the dimensionless numbers of a scene by symbol.
fn values(scene: &Scene) -> Vec<(&'static str, f64)> {
    let numbers = numbers(scene);
    numbers.iter().map(|it| (it.symbol, it.value)).collect()
}

fn close(computed: f64, expected: f64) -> bool {
    (computed / expected - 1.0).abs() < 1e-4
}

#[track_caller]
fn are(computed: &[(&str, f64)], expected: &[(&str, f64)]) {
    let right = computed.len() == expected.len()
        && computed
            .iter()
            .zip(expected)
            .all(|(a, b)| a.0 == b.0 && close(a.1, b.1));
    assert!(right, "{computed:?} and not {expected:?}");
}

fn compliant(stiffness: f64, damping: f64) -> Option<Contact> {
    Some(Contact {
        law: ContactLaw::Compliant { stiffness, damping },
        friction: 0.2,
    })
}

#[test]
fn dimensionless_numbers_of_the_default_scene() {
    // In block lengths, blocks and ticks: n = 300 / (2/3 π 25^3) = 0.0091673. The cross-section is
    // (12 + 4.5 π) / 4 = 6.5343, so ℓ = 1 / (√2 n 6.5343) = 11.804. The mean speed is 0.92132 v.
    // There are 0.078052 v collisions per tick, each for v^2 / 3. There are 0.92132 v / 4 * 3 / 50
    // = 0.013820 v landings, each for 2 v^2 / 3. The sum 0.035230 v^3 equals j^2 = 0.044^2 / 3 at v
    // = 0.26360.
    are(
        &values(&hemisphere()),
        &[
            ("v τ / a", 0.26360),
            ("j / v", 0.096371),
            ("F τ² / (m d)", 6.0),
            ("F r / (m v² / 2)", 0.86350),
            ("k τ² / m, wall", 0.01),
            ("N a³ / V", 0.0091673),
            ("ℓ / a", 11.804),
            ("ν τ", 0.020574),
            // v over √(25 /s²), in block lengths.
            ("v √(m/k) / a, wall", 2.6360),
        ],
    );
    let speed = speed(&hemisphere());
    assert_eq!(speed.from, SpeedFrom::Collisions);
    assert!(close(speed.rms.unwrap(), 2.6360), "{speed:?}");
}

#[test]
fn a_compliant_contact_has_its_own_numbers() {
    let scene = Scene {
        contact: compliant(400.0, 8.0),
        ..hemisphere()
    };
    // k τ² / m = 0.16, c τ / m = 0.16, ratio 0.2, for a pair 0.28284. With 1 - ratio^2 = 0.92 and
    // acos(0.28284) = 1.28404, e = exp(-2 0.28284 1.28404 / √0.92) = 0.46898.
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

/// Checks that a terminal speed subtracts half of the drag of one step.
#[test]
fn strong_drag_needs_short_steps() {
    let needed = |rate: f64| {
        let scene = Scene {
            drag: Some(Drag { rate }),
            ..hemisphere()
        };
        let all = numbers(&scene).into_iter();
        let mut of_drag = all.filter(|number| number.symbol == "γ τ");
        of_drag.next().unwrap().limit.unwrap().substeps
    };
    let tick = hemisphere().tick;
    let needed = [0.026, 0.2, 0.3, 20.0].map(|taken| needed(taken / tick));
    assert_eq!(needed, [Some(1), Some(1), Some(2), Some(100)]);
}

#[test]
fn with_drag_alone_the_speed_follows_from_the_stationary_variance() {
    let mut scene = Scene {
        drag: Some(Drag { rate: 5.0 }),
        contact: None,
        ..hemisphere()
    };
    // γ τ = 0.1: j^2 e^-0.2 / (1 - e^-0.2) = 0.0645333 * 4.516656, in m^2/s^2.
    let computed = speed(&scene);
    assert_eq!(computed.from, SpeedFrom::Drag);
    assert!(close(computed.rms.unwrap(), 0.53989), "{computed:?}");
    are(&values(&scene)[..1], &[("v τ / a", 0.053989)]);
    are(&values(&scene)[2..3], &[("γ τ", 0.1)]);
    let symbols: Vec<_> = values(&scene).iter().map(|it| it.0).collect();
    assert!(!symbols.contains(&"ν τ"), "nothing collides: {symbols:?}");

    // Collisions take additional energy, more if the drag is weaker.
    scene.contact = hemisphere().contact;
    let both = speed(&scene);
    assert_eq!(both.from, SpeedFrom::Collisions);
    assert!(both.rms < computed.rms && both.rms.unwrap() > 0.9 * computed.rms.unwrap());
    scene.drag = Some(Drag { rate: 1e-9 });
    assert!(close(speed(&scene).rms.unwrap(), 2.6360));
}

#[test]
fn without_a_speed_dependent_numbers_are_absent() {
    let still = Scene {
        agitation: None,
        ..hemisphere()
    };
    let computed = speed(&still);
    assert_eq!((computed.rms, computed.from), (Some(0.0), SpeedFrom::Rest));
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
            ["F τ² / (m d)", "k τ² / m, wall", "N a³ / V", "ℓ / a"]
        );
    }
}

#[test]
fn a_scaled_scene_has_the_same_numbers() {
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
    if let Some(Agitation::Kicks { speed }) = &mut scaled.agitation {
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
fn substeps_satisfy_each_limit() {
    let exceeded: Vec<_> = (numbers(&hemisphere()).iter())
        .filter(|number| number.is_exceeded(1))
        .map(|number| (number.symbol, number.substeps()))
        .collect();
    assert_eq!(exceeded, [("v τ / a", Some(3)), ("F τ² / (m d)", Some(3))]);
}

/// Displacements fall with the number of substeps, and what a force does falls with its square.
#[test]
fn limits_grow_with_the_substeps_that_are_taken() {
    let limit = |steps: &str, symbol: &str| {
        let all = dimensionless_numbers(&hemisphere(), steps.parse().expect("steps"));
        let found = all.iter().find(|number| number.symbol == symbol);
        found.and_then(|number| number.limit).expect("a limit").most
    };
    for (steps, motion, pull) in [("1", 0.1, 1.0), ("4", 0.4, 16.0), ("2/8", 0.2, 64.0)] {
        assert!(close(limit(steps, "v τ / a"), motion), "{steps}");
        assert!(close(limit(steps, "F τ² / (m d)"), pull), "{steps}");
    }
}

/// Returns the scene of `examples/microns.sa`.
fn microns() -> Scene {
    let mut scene = hemisphere();
    (scene.tick, scene.block.side, scene.block.mass) = (10.0, 10e-6, 1.05e-12);
    scene.enclosure = Some(Enclosure::Hemisphere {
        radius: 80e-6,
        wall: 10e-9,
    });
    scene.fluid = Some(Fluid {
        density: None,
        viscosity: Some(1e-3),
        added_mass: None,
    });
    scene.agitation = Some(Agitation::Brownian { temperature: 293.0 });
    let Some(Bond::Attract {
        pull,
        align,
        anchor,
        ..
    }) = &mut scene.bond
    else {
        panic!("it attracts");
    };
    (pull.force, pull.within) = (20e-15, 10e-6);
    *align = None;
    anchor.within = 1e-6;
    scene
}

#[test]
fn if_drag_dominates_a_step_is_as_long_as_its_motion() {
    let scene = microns();
    let found = |symbol: &str| {
        let mut numbers = numbers(&scene).into_iter();
        numbers
            .find(|it| it.symbol == symbol)
            .unwrap_or_else(|| panic!("{symbol}"))
    };
    // A velocity decays in m / f = 8 us, with f = 6 π 1e-3 0.675 1e-5 = 1.27235e-7 N s/m. In 10
    // s the pull of 20 fN moves a block by F τ / f = 1.572 um at its terminal speed. The wall
    // closes k τ / f = 0.786 of a distance. Heat moves a block by √(6 D τ), with D = k T / f =
    // 3.1794e-14 m²/s.
    let values = [
        ("φ F τ² / (m d)", 1.571901, 2.0),
        ("φ k τ² / m, wall", 0.785950, 1.0),
        ("v τ / a", 0.138117, 0.2),
    ];
    for (symbol, value, most) in values {
        let number = found(symbol);
        assert!(close(number.value, value), "{number:?}");
        assert!((number.limit.unwrap().most / most - 1.0).abs() < 1e-4);
    }
    // 663, 615 and 695 ticks at 1, 4 and 16 steps per tick.
    assert!(numbers(&scene).iter().all(|number| !number.is_exceeded(1)));
    // In simulations, twice the tick takes twice as long: at its terminal speed a block moves twice
    // as far. At four times the tick heat alone moves it too far, by √4.
    let mut long = microns();
    long.tick = 20.0;
    let needed = |scene: &Scene, symbol: &str| {
        let numbers = numbers(scene);
        numbers
            .iter()
            .find(|it| it.symbol == symbol)
            .unwrap()
            .substeps()
    };
    assert_eq!(needed(&long, "φ F τ² / (m d)"), Some(2));
    assert_eq!(needed(&long, "v τ / a"), Some(1));
    long.tick = 40.0;
    assert_eq!(needed(&long, "v τ / a"), Some(2));
    // Without drag the pull would accelerate the block by F τ² / m = 1.9 m, which needs K² steps.
    let mut free = microns();
    free.fluid = None;
    free.agitation = None;
    let flung = numbers(&free);
    let flung = flung.iter().find(|it| it.symbol == "F τ² / (m d)").unwrap();
    assert!(close(flung.value, 1.904762e6), "{flung:?}");
    assert_eq!(flung.substeps(), Some(1381));
}

#[test]
fn slow_drag_does_not_shorten_steps() {
    let mut scene = microns();
    scene.tick = 1e-7;
    let found = numbers(&scene);
    let pull = found
        .iter()
        .find(|it| it.symbol == "φ F τ² / (m d)")
        .unwrap();
    // m / f is 84 ticks: the first terms of φ are 1 - x / 2.
    let x = 1.272345e-7 / 1.05e-12 * 1e-7;
    let free = 20e-15 * 1e-14 / (1.05e-12 * 1e-6);
    assert!(
        (pull.value / (free * (1.0 - x / 2.0)) - 1.0).abs() < x * x,
        "{pull:?}"
    );
}

#[test]
fn added_mass_slows_motion_but_not_the_balance_of_forces() {
    let mut scene = microns();
    scene.gravity = Some(9.81);
    scene.fluid = Some(Fluid {
        density: Some(1000.0),
        viscosity: Some(1e-3),
        added_mass: None,
    });
    let without = values(&scene);
    scene.fluid.as_mut().unwrap().added_mass = Some(0.64);
    let with = values(&scene);
    let ratio = |symbol: &str| {
        let of = |values: &[(&str, f64)]| values.iter().find(|it| it.0 == symbol).unwrap().1;
        of(&with) / of(&without)
    };
    // (m + C ρ a³) / m with ρ a³ = 1 ng.
    let inertia = 1.69 / 1.05;
    assert!(close(ratio("6 π η 0.675 a τ / m"), 1.0 / inertia));
    for balance in ["h / a", "D τ / a²", "F r / (m v² / 2)"] {
        assert!(close(ratio(balance), 1.0), "{balance}");
    }
}

#[test]
fn sinking_is_compared_with_stirring() {
    let mut scene = microns();
    assert_eq!(Settling::from_scene(&scene), None, "without gravity");
    scene.gravity = Some(9.81);
    scene.fluid = Some(Fluid {
        density: Some(1000.0),
        viscosity: Some(1e-3),
        added_mass: None,
    });
    // k T / (m' g) with m' = 0.05 ng.
    let settling = Settling::from_scene(&scene).unwrap();
    assert!(
        close(settling.height, 4.045302e-21 / (5e-14 * 9.81)),
        "{settling:?}"
    );
    assert!(!settling.is_floating);
    let values = values(&scene);
    let value = |symbol: &str| values.iter().find(|it| it.0 == symbol).unwrap().1;
    assert!(close(value("h / a"), settling.height / 10e-6));
    assert!(close(value("h / R"), settling.height / 80e-6));
    assert!(
        close(value("⟨z⟩ / a"), settling.height / 10e-6),
        "heat lifts all"
    );
    scene.block.mass = 0.95e-12;
    assert!(Settling::from_scene(&scene).unwrap().is_floating);
    scene.block.mass = 1e-12;
    assert!(
        Settling::from_scene(&scene).is_none_or(|it| it.height > 1.0),
        "as heavy as the fluid"
    );

    // Kicks against drag: with elastic contacts k T is m v² / 3, and j² e^-0.2 / (1 - e^-0.2) = v².
    let mut kicked = hemisphere();
    (kicked.gravity, kicked.drag) = (Some(2.0), Some(Drag { rate: 5.0 }));
    let bounce = |restitution| {
        Some(Contact {
            law: ContactLaw::Rigid { restitution },
            friction: 0.0,
        })
    };
    kicked.contact = bounce(1.0);
    let height = 0.53989_f64.powi(2) / 3.0 / 2.0;
    assert!(close(Settling::from_scene(&kicked).unwrap().height, height));
    // Inelastic landings take most of the energy: 0.221403 v² + 0.797885 * 0.004 v = 0.044² / 9, in
    // block lengths per tick.
    kicked.contact = bounce(0.0);
    let vertical: f64 = 0.0247851;
    let height = (vertical * 10.0).powi(2) / 2.0;
    let computed = Settling::from_scene(&kicked).unwrap();
    assert!(
        (computed.height / height - 1.0).abs() < 1e-3,
        "{computed:?} {height}"
    );
    kicked.contact = None;
    assert_eq!(Settling::from_scene(&kicked), None, "there is no floor");

    // Eddies compared with the terminal speed of 10 g in a wake: ρ a² w² / 2 = m' g.
    let mut tank = built_in("suction_tank").unwrap();
    tank.fluid = Some(Fluid {
        density: Some(1000.0),
        viscosity: None,
        added_mass: None,
    });
    let Some(Agitation::Turbulence(turbulence)) = &mut tank.agitation else {
        panic!("eddies stir it");
    };
    turbulence.strength = Strength::Speed(0.1);
    assert!(matches!(tank.flow, Some(Flow::Jets(_))));
    let settling = Settling::from_scene(&tank).unwrap();
    let sinking = (0.01 * 9.81 / 5.0_f64).sqrt();
    assert!(close(settling.speeds.unwrap(), sinking / 0.1));
    // An eddy of 16 cm lasts 1.6 s. A block leaves it after 0.16 m / √(0.1² + 0.14007²) m/s.
    let through = 0.16 / 0.1_f64.hypot(sinking);
    let expected = 0.01 / (1.0 / 1.6 + 1.0 / through) / sinking;
    assert!(close(settling.height, expected), "{settling:?} {expected}");
    // In a normal distribution 16.1 % exceed the mean by more than 1.40071 standard deviations.
    assert!((settling.lifted - 0.1613).abs() < 1e-4, "{settling:?}");
    assert!(close(
        settling.above(expected),
        settling.lifted / 1f64.exp()
    ));
    assert!(
        close(settling.mean(), settling.lifted * expected),
        "the others lie on the floor"
    );
    // Without vertical eddies, the liquid does not lift the blocks.
    let Some(Agitation::Turbulence(turbulence)) = &mut tank.agitation else {
        panic!("eddies stir it");
    };
    turbulence.vertical = 0.0;
    assert_eq!(Settling::from_scene(&tank).unwrap().above(0.0), 0.0);
}

#[test]
fn suction_is_compared_with_the_flow() {
    let mut tank = built_in("suction_tank").unwrap();
    let Some(Bond::Suction {
        pump, seal, anchor, ..
    }) = &mut tank.bond
    else {
        panic!("the tank has suction");
    };
    *pump = Pump {
        head: 200.0,
        opening: None,
        supply: None,
        valve: None,
        passage: None,
    };
    (*seal, *anchor) = (None, None);
    // An opening of 5 cm. The pressure drop is 3 η Q / r³ + ρ Q² / (2 (0.6 π r²)²).
    let suction = Suction::from_scene(&tank).unwrap();
    let (flow, radius) = (suction.flow().unwrap(), 0.025_f64);
    let area = std::f64::consts::PI * radius * radius;
    let drop = 3e-3 * flow / radius.powi(3) + 500.0 * (flow / (0.6 * area)).powi(2);
    assert!(close(drop, 200.0), "{suction:?}");
    let speed = flow / area;
    assert_eq!((suction.seal, suction.anchor.within), (0.0125, 0.00625));
    assert_eq!((suction.supply, suction.passage), (0.0, suction.valve));
    let values = values(&tank);
    let value = |symbol| values.iter().find(|it| it.0 == symbol).unwrap().1;
    assert!(close(value("ρ U D / η"), 1000.0 * speed * 0.05 / 1e-3));
    // The jets are U 6.2 D / R = 1.1741 m/s in the middle. The eddies add √3 * 0.31250 m/s.
    let jet = 1e-3 * 30.0 / 60.0 / 4.0 / (std::f64::consts::FRAC_PI_4 * 1e-4);
    let around = (jet * 0.05 * 3f64.sqrt()).hypot(jet * 6.2 * 0.01 / 0.33);
    let distance = (flow / (2.0 * std::f64::consts::PI * around)).sqrt();
    assert!(close(value("√(Q / (2 π v)) / a"), distance / 0.1));
    let drag = Fluid::friction(1e-3, 0.1) * around + Fluid::wake(1000.0, 0.1) * around * around;
    assert!(close(value("Δp a² / F, suction"), 200.0 * 0.01 / drag));
    // A block of 1.01 kg moves by F τ² / m = 2 N (20 ms)² / (1.01 kg), with little drag.
    let first = 2.0 * 4e-4 / 1.01 / 0.00625;
    assert!((value("φ F τ² / (m d)") / first - 1.0).abs() < 0.01);
}

/// Checks that collisions in a sphere take energy too. The blocks have twice the space of a
/// hemisphere.
#[test]
fn a_sphere_is_a_gas_as_a_hemisphere_is() {
    let in_ball = Scene {
        enclosure: Some(Enclosure::Sphere {
            radius: 5.1,
            wall: 250.0,
        }),
        ..hemisphere()
    };
    let computed = speed(&in_ball);
    assert_eq!(computed.from, SpeedFrom::Collisions);
    // Half of the density and no floor give j^2 = 0.078052 / 2 / 3 v^3.
    let exact = (0.044_f64.powi(2) / 3.0 / (0.078052 / 6.0)).cbrt();
    assert!(
        (computed.rms.unwrap() / (exact * 10.0) - 1.0).abs() < 1e-3,
        "{computed:?}"
    );
}

#[test]
fn the_mean_flow_carries_blocks() {
    let tank = built_in("magnet_tank").unwrap();
    let carried = |scene: &Scene| {
        let number = numbers(scene)
            .into_iter()
            .find(|number| number.symbol == "u τ / a");
        number.map(|number| (number.value, number.limit.unwrap().substeps))
    };
    let Some(Flow::Stir(stir)) = &tank.flow else {
        panic!("it is stirred");
    };
    let exact = stir.follow * stir.radius * stir.rate * tank.tick / tank.block.side;
    let (value, substeps) = carried(&tank).unwrap();
    assert!((value / exact - 1.0).abs() < 1e-9 && substeps == Some(1));
    let fast = Scene {
        flow: Some(Flow::Stir(Stir {
            rate: 0.25 / exact * stir.rate,
            ..stir.clone()
        })),
        ..tank.clone()
    };
    assert_eq!(carried(&fast).unwrap().1, Some(3));
    assert_eq!(carried(&Scene { flow: None, ..tank }), None);
}

/// Compares two scenes that are equal except for the length of the tick.
#[test]
fn thermal_energies_do_not_depend_on_the_tick() {
    let work = |tick: f64| {
        let scene = Scene {
            tick,
            fluid: Some(Fluid {
                density: None,
                viscosity: Some(1.0),
                added_mass: None,
            }),
            agitation: Some(Agitation::Brownian { temperature: 300.0 }),
            ..hemisphere()
        };
        let all = numbers(&scene).into_iter();
        let mut works = all.filter(|number| number.symbol == "F r / (m v² / 2)");
        works.next().unwrap().value
    };
    let (short, long) = (work(1e-6), work(10.0));
    assert!((short / long - 1.0).abs() < 1e-9, "{short} {long}");
    let scene = hemisphere();
    let Some(Bond::Attract { pull, .. }) = &scene.bond else {
        panic!("faces pull");
    };
    let exact = pull.force * pull.within / (1.5 * BOLTZMANN * 300.0);
    assert!((short / exact - 1.0).abs() < 1e-9, "{short} {exact}");
}

#[test]
fn heat_and_eddies_set_the_speed_of_blocks() {
    let mut tank = built_in("magnet_tank").unwrap();
    let computed = speed(&tank);
    assert_eq!(computed.from, SpeedFrom::Eddies);
    // 3 % of the speed of a ring of 8.5 cm at 0.455 turns per second, in three directions.
    let exact = 0.03 * 0.085 * 0.455 * std::f64::consts::TAU * 3f64.sqrt();
    assert!((computed.rms.unwrap() / exact - 1.0).abs() < 1e-12);
    let Some(Agitation::Turbulence(turbulence)) = &mut tank.agitation else {
        panic!("no turbulence");
    };
    (turbulence.strength, turbulence.vertical) = (Strength::Speed(0.1), 2.0);
    assert!((speed(&tank).rms.unwrap() - 0.1 * 6f64.sqrt()).abs() < 1e-12);
    assert!(matches!(tank.flow, Some(Flow::Stir(_))));

    let value = |scene: &Scene, symbol| {
        let number = numbers(scene)
            .into_iter()
            .find(|number| number.symbol == symbol);
        number.unwrap().value
    };
    tank.agitation = Some(Agitation::Brownian { temperature: 300.0 });
    let friction = Fluid::friction(0.06, 0.1);
    let short = BOLTZMANN * 300.0 / friction * tank.tick / 0.01;
    assert!((value(&tank, "D τ / a²") / short - 1.0).abs() < 1e-12);
    // If the tick is far shorter than the decay time, the speed is thermal. If it is far longer,
    // diffusion determines the speed.
    assert_eq!(speed(&tank).from, SpeedFrom::Heat);
    let thermal = 3.0 * BOLTZMANN * 300.0 / tank.block.mass;
    assert!((speed(&tank).rms.unwrap().powi(2) / thermal - 1.0).abs() < 1e-3);
    tank.tick = 1e6;
    let diffusion = BOLTZMANN * 300.0 / friction;
    let slow = 6.0 * diffusion / tank.tick;
    assert!((speed(&tank).rms.unwrap().powi(2) / slow - 1.0).abs() < 1e-3);
}
