//! Checks that scene parameters are written, read and changed consistently.
use stochc_grammar::tree::{ItemKind, SceneDeclaration, Term};
use stochc_grammar::{Symbols, parse};

use stochc_ir::scene::describe::terms;
use stochc_ir::scene::scalars::{ScalarChange, ScalarError, changed, find, scalars};
use stochc_ir::scene::schema::{CLAUSES, numbers};
use stochc_ir::scene::units::WrittenQuantity;
use stochc_ir::scene::{Agitation, Scene};

use crate::diagnostic::Code;
use crate::expand::units::to_si;
use crate::scene::{BUILT_IN, built_in, read};
use crate::{FileId, Sources};

/// Scenes that together use every term of the model. New terms must be added here.
const FULL: [&str; 8] = [
    "scene soft {
        tick 20ms
        block cube { side 20cm  mass 1kg  faces 2 }
        free 300 uniform
        enclosure hemisphere { radius 5m  wall 25 N/m }
        agitation kicks { speed 0.1 .. 0.4 m/s }
        drag { rate 0.5 s^-1 }
        contact { stiffness 250 N/m  damping 6 N s/m  friction 1 }
        bond attract {
            pull 7.5 N within 20cm
            align 0.375 N within 10cm
            anchor centres 1mm tilt 26 deg
        }
        messages { hop 3 ticks  loss 0.1 }
        faults { dead 1%  latch 2% }
    }",
    "scene hard {
        tick 20ms
        block cube { side 20cm  mass 1kg  faces 1 }
        free 300 uniform
        enclosure hemisphere { radius 5m  wall 25 N/m }
        agitation kicks { speed 0.2 m/s }
        contact { restitution 0.5  friction 1 }
        bond attract { pull 7.5 N within 20cm  anchor gap 1mm }
    }",
    "scene eddies {
        tick 20ms
        block cube { side 10cm  mass 1kg  faces 1 }
        free 2 ring 20cm
        enclosure sphere { radius 33cm  wall 200 N/m }
        fluid { density 920 kg/m^3  viscosity 60 mPa s  added_mass 0.64 }
        agitation turbulence { speed 4 cm/s  length 8cm  time 2 s  vertical 0.5 }
        bond reject { hold 2 N  depth 2cm  within 15cm  impulse 0.1 N s  anchor centres 5mm }
    }",
    "scene warm {
        tick 1 s
        block cube { side 10um  mass 1ug  faces 1 }
        free 50 uniform
        enclosure hemisphere { radius 200um  wall 1 nN/m }
        fluid { viscosity 1 mPa s }
        agitation brownian { temperature 293 K }
    }",
    "scene square {
        tick 1 s
        block cube { side 1cm  mass 1g  faces 1 }
        free 50 uniform
        enclosure box { length 40cm  width 30cm  height 20cm  wall 1 N/m }
    }",
    "scene round {
        tick 1 s
        block cube { side 1cm  mass 1g  faces 1 }
        free 50 uniform
        enclosure cylinder { radius 15cm  height 20cm  wall 1 N/m }
    }",
    "scene valves {
        tick 1 s
        block cube { side 1cm  mass 1g  faces 1 }
        free 50 uniform
        enclosure cylinder { radius 15cm  height 20cm  wall 1 N/m }
        gravity 9.81 m/s^2
        fluid { density 1000 kg/m^3  viscosity 1 mPa s }
        bond suction {
            head 200 Pa  opening 5mm  supply 1 kPa s/L  valve 4 kPa s/L  passage 1 kPa s/L
            seal 3mm  anchor gap 1mm  strength { force 2 mN  torque 10 uN m }
        }
    }",
    "scene flat {
        tick 1 s
        block cube { side 1cm  mass 1g  faces 1 }
        free 50 uniform
        world planar friction 0.01
        enclosure rectangle { length 40cm  width 30cm  wall 1 N/m }
        gravity 9.81 m/s^2
    }",
];

/// Syntax tree of a scene's source.
struct Text {
    tree: SceneDeclaration,
    symbols: Symbols,
    file: FileId,
}

impl Text {
    fn new(text: &str) -> Text {
        let mut symbols = Symbols::new();
        let parsed = parse(text, &mut symbols);
        assert_eq!(parsed.errors, [], "{text}");
        let mut items = parsed.tree.items.into_iter();
        let tree = items.find_map(|item| match item.kind {
            ItemKind::Scene(scene) => Some(scene),
            _ => None,
        });
        Text {
            tree: *tree.unwrap(),
            symbols,
            file: Sources::default().add("s.sa", text),
        }
    }

    /// Reads the scene.
    fn scene(&self) -> Option<Scene> {
        let base = self.tree.base.map(|base| self.symbols.word(base.symbol));
        let base = base.map(|name| built_in(name).unwrap());
        read(&self.tree, base, self.file, &self.symbols, &mut Vec::new())
    }

    /// Replaces the value of a parameter, in the SI unit of the existing value. Returns `None` if
    /// the source does not give the parameter.
    fn write(&mut self, name: &str, value: f64) -> Option<()> {
        let words: Vec<&str> = name.split('.').collect();
        put(&mut self.tree.terms, &words, value, &self.symbols)
    }
}

/// Follows words through terms: into braces after a word, or to a later word of the same group.
fn put(terms: &mut [Term], words: &[&str], value: f64, symbols: &Symbols) -> Option<()> {
    let (word, rest) = words.split_first()?;
    let is = |term: &Term| matches!(term, Term::Word(name) if symbols.word(name.symbol) == *word);
    let place = terms.iter().position(is)?;
    let behind = &mut terms[place + 1..];
    let next = behind
        .iter_mut()
        .position(|term| !matches!(term, Term::Word(_)))?;
    let quantity = match (&mut behind[next], rest) {
        (Term::Block(inner, _), [_, ..]) => return put(inner, rest, value, symbols),
        (Term::Quantity(_), [_, ..]) => return put(behind, rest, value, symbols),
        (Term::Quantity(quantity), []) => quantity,
        (Term::Range(_, high), []) => high,
        (Term::Range(low, _), ["low"]) => low,
        _ => return None,
    };
    quantity.value = 1.0;
    let (unit, _) = to_si(quantity);
    quantity.value = value / unit;
    Some(())
}

fn texts() -> impl Iterator<Item = Text> {
    let built_in = BUILT_IN.into_iter().map(|(_, text)| text);
    built_in.chain(FULL).map(Text::new)
}

/// Checks that any scene is equal after it is written and read again.
#[test]
fn every_scene_is_written_as_it_is_read() {
    for scene in texts().map(|text| text.scene().unwrap()) {
        let clauses: Vec<String> = terms(&scene).into_iter().map(|term| term.text).collect();
        let written = format!("scene {} {{\n{}\n}}", scene.name, clauses.join("\n"));
        let read = Text::new(&written).scene();
        assert_eq!(read.as_ref(), Some(&scene), "{written}");
    }
}

#[test]
fn the_tested_scenes_have_every_parameter() {
    let scenes: Vec<_> = texts().map(|text| text.scene().unwrap()).collect();
    for number in CLAUSES.iter().flat_map(numbers) {
        assert!(
            scenes.iter().any(|scene| number.get(scene).is_some()),
            "no scene of this test has `{}`: add it to FULL",
            number.name()
        );
    }
}

/// Checks that a value gives the same scene if it is written in the source or set by the table.
/// Both reject the same values.
#[test]
fn names_and_ranges_match_the_language() {
    const DEFAULTS: [&str; 9] = [
        "bond.anchor.tilt",
        "agitation.speed.low",
        "agitation.time",
        "agitation.vertical",
        "bond.opening",
        "flow.force",
        "messages.loss",
        "faults.dead",
        "faults.latch",
    ];
    const PROBES: [f64; 14] = [
        -1.0,
        0.0,
        1e-7,
        0.05,
        0.5,
        1.0,
        1.5,
        2.0,
        5.0,
        6.0,
        1e6,
        1_000_001.0,
        1e7,
        10_000_001.0,
    ];
    for (number, mut text) in texts().enumerate() {
        let scene = text.scene().unwrap();
        for scalar in scalars(&scene) {
            let name = scalar.name();
            let original = text.tree.clone();
            for value in PROBES {
                if text.write(name, value).is_none() {
                    // Only parameters with a default may be missing in the source.
                    assert!(
                        DEFAULTS.contains(&name),
                        "`{name}` leads nowhere in text {number}"
                    );
                    continue;
                }
                let read = text.scene();
                let mut set = scene.clone();
                let taken = scalar.set(&mut set, value);
                match read {
                    None if name == "agitation.speed" => {
                        // The reader keeps the lower end, the table its share of the upper end.
                        assert!(value < 0.1, "{value}");
                    }
                    None => assert!(taken.is_err(), "{name} = {value} is refused in a scene"),
                    Some(read) => {
                        assert_eq!(taken, Ok(()), "{name} = {value} is taken in a scene");
                        let si = scalar.get(&read).unwrap();
                        assert!((si - value).abs() <= 1e-12 * value.abs(), "{name}: {si}");
                        assert_eq!(scalar.get(&set), Some(value), "{name}");
                    }
                }
                text.tree = original.clone();
            }
        }
    }
}

fn scene(number: usize) -> Scene {
    Text::new(FULL[number]).scene().unwrap()
}

fn with(scene: Scene, changes: &[(&str, f64)]) -> Result<Scene, ScalarError> {
    let changes: Vec<ScalarChange> = (changes.iter())
        .map(|&(of, value)| ScalarChange {
            name: of.to_owned(),
            value,
        })
        .collect();
    changed(scene, &changes)
}

#[test]
fn a_range_is_varied_by_its_upper_end() {
    let speed = |changes: &[(&str, f64)], number| {
        let Some(Agitation::Kicks { speed }) = with(scene(number), changes).unwrap().agitation
        else {
            panic!("no kicks");
        };
        speed
    };
    assert_eq!(speed(&[("agitation.speed", 0.8)], 0), (0.2, 0.8));
    assert_eq!(speed(&[("agitation", 0.3)], 1), (0.3, 0.3), "one value");
    // The order of the changes does not matter.
    let both = [("agitation.speed.low", 0.6), ("agitation.speed", 0.8)];
    assert_eq!(speed(&both, 0), (0.6, 0.8));
    let error = with(scene(0), &[("agitation.speed.low", 0.5)]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "`agitation.speed.low` must be at most the upper end, 0.4 m/s, and is 0.5 m/s"
    );
}

#[test]
fn an_unknown_parameter_is_reported_with_the_known_ones() {
    let error = |number, name| {
        let error = find(&scene(number), name).unwrap_err();
        assert!(error.has().contains(&"bond.pull"), "{error:?}");
        error.to_string()
    };
    assert_eq!(
        error(0, "bond.pul"),
        "the scene `soft` has no number `bond.pul`; did you mean `bond.pull`?"
    );
    assert_eq!(
        error(0, "friction"),
        "the scene `soft` has no number `friction`; did you mean `contact.friction`?"
    );
    assert_eq!(error(0, "zeal"), "the scene `soft` has no number `zeal`");
    assert_eq!(
        error(1, "drag"),
        "the scene `hard` declares no `drag`, so that there is no `drag.rate` to change"
    );
    assert_eq!(
        error(1, "contact.damping"),
        "the scene `hard` does not say `contact.damping`"
    );
}

#[test]
fn a_wrong_dimension_is_reported_with_the_right_one() {
    let of = |name, text| {
        let scalar = find(&scene(0), name).unwrap();
        scalar.accept(WrittenQuantity::parse(text).unwrap().to_si())
    };
    assert_eq!(of("block.side", "20cm"), Ok(0.2));
    let error = |name, text| of(name, text).unwrap_err().to_string();
    assert_eq!(
        error("bond.pull", "3 m"),
        "`bond.pull` is a force, such as `15 N`, not a length"
    );
    assert_eq!(
        error("tick", "3"),
        "`tick` is a time, such as `20ms`, not a number without a unit"
    );
    assert_eq!(
        error("free", "2.5"),
        "`free` must be a whole number from 0 to 10000000, and is 2.5"
    );
}

/// Checks that timeouts in seconds follow the tick, and inventories the number of free blocks.
#[test]
fn a_changed_scene_compiles_like_a_written_one() {
    let text = "assembly a {
        seed plate 3 x 3 { M at (1, 1) }
        phase p timeout 10 s { M.up ->> T[1..3] }
    }";
    let checked = |changes: &[(&str, f64)]| {
        let changes: Vec<_> = (changes.iter())
            .map(|&(of, value)| crate::ParameterChange {
                name: of.to_owned(),
                integer: None,
                scene: vec![ScalarChange {
                    name: of.to_owned(),
                    value,
                }],
            })
            .collect();
        let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
        let limits = crate::Limits::default();
        let levels = crate::LintLevels::default();
        let changes = crate::Changes::in_assembly("a", &changes);
        crate::check_changed("a.sa", &mut reader, limits, &levels, changes)
    };
    let timeout = |changes: &[(&str, f64)]| {
        let checked = checked(changes);
        // Such steps and timeouts cause warnings.
        assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
        checked.programs[0].tables.as_ref().unwrap().phases[0].timeout
    };
    assert_eq!(timeout(&[]), Some(500));
    assert_eq!(timeout(&[("tick", 0.1)]), Some(100));
    assert_eq!(timeout(&[("tick", 1e-40)]), Some(9_000_000_000_000_000));
    let codes = |changes: &[(&str, f64)]| {
        let checked = checked(changes);
        assert!(checked.programs[0].tables.is_none(), "{changes:?}");
        let codes = checked.diagnostics.iter().map(|diagnostic| diagnostic.code);
        codes.collect::<Vec<_>>()
    };
    assert_eq!(codes(&[("free", 2.0)]), [Code::TooFewBlocks]);
    assert_eq!(
        codes(&[("enclosure.radius", 0.5)]),
        [Code::OutsideEnclosure, Code::TooManyBlocks]
    );
    assert_eq!(codes(&[("free", 2.5)]), [Code::WrongValue]);
    assert_eq!(codes(&[("fre", 2.0)]), [Code::UnknownTerm]);
    assert_eq!(codes(&[("gravity", 2.0)]), [Code::MissingTerm]);
}
