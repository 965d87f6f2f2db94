use proptest::prelude::*;
use stochc_grammar::tree::ItemKind;
use stochc_grammar::{Symbols, parse};

use stochc_ir::scene::describe::{absent, terms};
use stochc_ir::scene::{
    Agitation, Anchor, Block, Bond, BondStrength, Contact, ContactLaw, Drag, Enclosure, Faults,
    Fluid, Measure, Messages, Mount, Planar, Pump, Reach, Scene,
};

use crate::Sources;
use crate::scene::{built_in, read};

/// Returns the scene that a text declares.
fn scene(text: &str) -> Scene {
    let mut symbols = Symbols::new();
    let parsed = parse(text, &mut symbols);
    assert_eq!(parsed.errors, [], "{text}");
    let ItemKind::Scene(tree) = &parsed.tree.items[0].kind else {
        panic!("{text}");
    };
    let (file, mut diagnostics) = (Sources::default().add("s.sa", text), Vec::new());
    let scene = read(
        tree,
        built_in("hemisphere_2005"),
        file,
        &symbols,
        &mut diagnostics,
    );
    assert_eq!(diagnostics, [], "{text}");
    scene.expect("the program is valid")
}

fn texts(scene: &Scene) -> Vec<String> {
    terms(scene).into_iter().map(|term| term.text).collect()
}

fn clauses(scene: &Scene) -> Vec<String> {
    absent(scene).into_iter().map(|it| it.clause).collect()
}

#[test]
fn clauses_are_written_in_short_units() {
    let hemisphere = built_in("hemisphere_2005").unwrap();
    assert_eq!(
        texts(&hemisphere),
        [
            "tick 20 ms",
            "block cube { side 0.2 m  mass 1 kg  faces 1 }",
            "free 300 uniform",
            "enclosure hemisphere { radius 5 m  wall 25 N/m }",
            "agitation kicks { speed 0 .. 0.44 m/s }",
            "contact { restitution 0  friction 0.2 }",
            "bond attract { pull 15 N within 0.2 m  align 0.75 N within 0.1 m  anchor centres 1 mm tilt 26 deg }",
        ]
    );
    assert_eq!(
        clauses(&hemisphere),
        ["gravity", "fluid", "drag", "messages", "faults"]
    );
}

#[test]
fn lists_missing_terms_and_fields() {
    let mut bare = built_in("hemisphere_2005").unwrap();
    let Some(Bond::Attract { align, .. }) = &mut bare.bond else {
        panic!("the default scene captures");
    };
    *align = None;
    bare.messages = Some(Messages { hop: 2, loss: None });
    (bare.agitation, bare.contact) = (None, None);
    assert_eq!(
        clauses(&bare),
        [
            "gravity",
            "fluid",
            "agitation",
            "drag",
            "contact",
            "bond attract { align }",
            "messages { loss }",
            "faults"
        ]
    );
    bare.bond = None;
    bare.messages = None;
    assert_eq!(
        clauses(&bare),
        [
            "gravity",
            "fluid",
            "agitation",
            "drag",
            "contact",
            "bond",
            "messages",
            "faults"
        ],
        "fields of an absent clause are not listed"
    );
}

#[test]
fn values_are_given_in_both_units() {
    let text = "scene s from hemisphere {
        drag { rate 0.5 s^-1 }
        contact { stiffness 400 N/m  damping 8 N s/m  friction 0.3 }
    }";
    let terms = terms(&scene(text));
    let computed: Vec<_> = terms
        .iter()
        .flat_map(|term| &term.laws)
        .flat_map(|law| &law.values)
        .map(|value| (value.symbol, value.si, value.block))
        .collect();
    let inertia = 0.04 / 6.0;
    // In block units a force of 15 N is 15 * 0.02^2 / (1 * 0.2), a speed 0.44 * 0.02 / 0.2.
    let expected = [
        ("τ", 0.02, 1.0),
        ("a", 0.2, 1.0),
        ("m", 1.0, 1.0),
        ("I", inertia, 1.0 / 6.0),
        ("", 1.0, 1.0),
        ("N", 300.0, 300.0),
        ("R", 5.0, 25.0),
        ("k", 25.0, 0.01),
        ("u", 0.0, 0.0),
        ("w", 0.44, 0.044),
        ("j", 0.254034, 0.0254034),
        ("γ", 0.5, 0.01),
        ("k", 400.0, 0.16),
        ("c", 8.0, 0.16),
        ("μ", 0.3, 0.3),
        ("F", 15.0, 0.03),
        ("r", 0.2, 1.0),
        ("f", 0.75, 0.0015),
        ("q", 0.1, 0.5),
        ("d", 0.001, 0.005),
        ("α", 0.453786, 0.453786),
    ];
    assert_eq!(computed.len(), expected.len(), "{computed:?}");
    for (computed, expected) in computed.iter().zip(expected) {
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-5 * b.abs();
        assert!(
            computed.0 == expected.0
                && close(computed.1, expected.1)
                && close(computed.2, expected.2),
            "{computed:?} and not {expected:?}"
        );
    }
}

/// Generates positive values of any magnitude.
fn size() -> impl Strategy<Value = f64> {
    prop_oneof![
        (1e-12f64.ln()..1e12f64.ln()).prop_map(f64::exp),
        (1u32..2000, -6i32..4).prop_map(|(digits, power)| f64::from(digits) * 10f64.powi(power)),
        Just(1e-50),
        Just(1e50),
    ]
}

fn bond() -> impl Strategy<Value = Bond> {
    let reach = || (size(), size()).prop_map(|(force, within)| Reach { force, within });
    let tilt = prop_oneof![
        0.01..1.57,
        Just(26f64.to_radians()),
        Just(45f64.to_radians())
    ];
    let measure = prop_oneof![
        Just(Measure::Centres),
        Just(Measure::Gap),
        Just(Measure::Corners)
    ];
    let anchor =
        (measure, size(), tilt, any::<bool>()).prop_map(|(measure, within, tilt, sampled)| {
            Anchor {
                measure,
                within,
                tilt,
                sampled,
            }
        });
    (reach(), prop::option::of(reach()), anchor).prop_map(|(pull, align, anchor)| Bond::Attract {
        pull,
        align,
        anchor,
        strength: None,
    })
}

fn strength() -> impl Strategy<Value = BondStrength> {
    let either = prop_oneof![Just((true, false)), Just((false, true)), Just((true, true))];
    (size(), size(), either).prop_map(|(force, torque, (has_force, has_torque))| BondStrength {
        force: has_force.then_some(force),
        torque: has_torque.then_some(torque),
    })
}

/// Generates suction with defaults for any of its parameters.
fn suction() -> impl Strategy<Value = Bond> {
    let maybe = || prop::option::of(size());
    let anchor = prop::option::of(
        (size(), any::<bool>()).prop_map(|(within, sampled)| Anchor {
            measure: Measure::Gap,
            within,
            tilt: 45f64.to_radians(),
            sampled,
        }),
    );
    let numbers = (size(), maybe(), maybe(), maybe(), maybe(), maybe(), anchor);
    numbers.prop_map(|(head, opening, supply, valve, passage, seal, anchor)| {
        let pump = Pump {
            head,
            opening,
            supply,
            valve,
            passage,
        };
        Bond::Suction {
            pump,
            seal,
            anchor,
            strength: None,
        }
    })
}

fn contact() -> impl Strategy<Value = Contact> {
    let law = prop_oneof![
        (0.0..=1.0).prop_map(|restitution| ContactLaw::Rigid { restitution }),
        (size(), prop_oneof![Just(0.0), size()])
            .prop_map(|(stiffness, damping)| ContactLaw::Compliant { stiffness, damping }),
    ];
    (law, size()).prop_map(|(law, friction)| Contact { law, friction })
}

fn any_scene() -> impl Strategy<Value = Scene> {
    let block =
        (size(), size(), 1u8..=5).prop_map(|(side, mass, faces)| Block { side, mass, faces });
    let enclosure =
        (size(), size(), size(), size(), 0..6).prop_map(|(length, width, height, wall, kind)| {
            let radius = length;
            match kind {
                0 => Enclosure::Hemisphere { radius, wall },
                1 => Enclosure::Sphere { radius, wall },
                2 => Enclosure::Box {
                    length,
                    width,
                    height,
                    wall,
                },
                3 => Enclosure::Cylinder {
                    radius,
                    height,
                    wall,
                },
                4 => Enclosure::Disc { radius, wall },
                _ => Enclosure::Rectangle {
                    length,
                    width,
                    wall,
                },
            }
        });
    let kicks = (prop_oneof![Just(0.0), size()], size()).prop_map(|(a, b)| Agitation::Kicks {
        speed: (a.min(b), a.max(b)),
    });
    let messages = (0u32..=1_000_000, prop::option::of(0.0..=0.99))
        .prop_map(|(hop, loss)| Messages { hop, loss });
    let faults = (0.0..=1.0, prop::option::of(0.0..=0.99)).prop_map(|(dead, latch)| Faults {
        dead: Some(dead),
        latch,
    });
    let drag = size().prop_map(|rate| Drag { rate });
    let table = (prop::option::of(size()), size());
    (
        table,
        size(),
        block,
        enclosure,
        kicks,
        drag,
        contact(),
        (
            bond(),
            suction(),
            any::<bool>(),
            prop::option::of(strength()),
        ),
        (messages, prop::option::of(faults)),
    )
        .prop_map(
            |(table, tick, block, enclosure, kicks, drag, contact, bonds, failures)| Scene {
                name: "s".to_owned(),
                tick,
                gravity: table.0.map(|_| table.1),
                mount: (table.0.filter(|_| !enclosure.is_flat())).and(
                    [None, Some(Mount::Wall), Some(Mount::Roof)][usize::from(block.faces) % 3],
                ),
                planar: enclosure.is_flat().then_some(Planar { friction: table.0 }),
                block,
                agitation: Some(kicks),
                drag: Some(drag),
                contact: Some(contact),
                // Suction without the resistance of its valves needs a fluid.
                fluid: bonds.2.then_some(Fluid {
                    density: table.0,
                    viscosity: Some(table.1),
                    added_mass: None,
                }),
                bond: Some({
                    let is_flat = enclosure.is_flat();
                    let mut bond = if bonds.2 && !is_flat {
                        bonds.1
                    } else {
                        bonds.0
                    };
                    // Only in space and with gravity, bonds can break.
                    if let Some(strength) = bond.strength_mut() {
                        *strength = (bonds.3).filter(|_| table.0.is_some() && !is_flat);
                    }
                    bond
                }),
                enclosure: Some(enclosure),
                messages: Some(failures.0),
                faults: failures.1,
                ..built_in("hemisphere_2005").expect("a built-in scene")
            },
        )
}

/// Returns whether two scenes are equal except for rounding in unit conversions.
fn is_same(a: &serde_json::Value, b: &serde_json::Value) -> bool {
    use serde_json::Value;
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len()
                && (a.iter()).all(|(name, a)| b.get(name).is_some_and(|b| is_same(a, b)))
        }
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_same(a, b))
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            (a - b).abs() <= 1e-15 * a.abs()
        }
        _ => a == b,
    }
}

proptest! {
    #[test]
    fn a_written_scene_reads_as_the_same_scene(declared in any_scene()) {
        let text = format!("scene s {{\n{}\n}}\n", texts(&declared).join("\n"));
        let read = scene(&text);
        let [a, b] = [&read, &declared].map(|it| serde_json::to_value(it).unwrap());
        prop_assert!(is_same(&a, &b), "{}\n{:?}", text, declared);
        // A second round trip is exact to the bit.
        let again = format!("scene s {{\n{}\n}}\n", texts(&read).join("\n"));
        prop_assert_eq!(&again, &text);
        prop_assert_eq!(scene(&again), read);
    }
}
