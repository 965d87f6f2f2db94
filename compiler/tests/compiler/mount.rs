//! Scenes with a plate on a wall or on the roof.
use stochc_compiler::diagnostic::Code;

use crate::{checked, with_code};

const GRAVITY: &str = "gravity 9.81 m/s^2";

/// Checks the terms that a plate on a wall or on the roof needs, and those that it rejects.
#[test]
fn scenes_with_a_mounted_plate_are_consistent() {
    let errors = |clauses: &str| {
        let found = checked(&format!("scene s from hemisphere {{ {clauses} }}"));
        let errors = found.diagnostics.iter().filter(|it| it.is_error());
        errors.map(|it| it.title.clone()).collect::<Vec<_>>()
    };
    let stirred = format!(
        "{GRAVITY} fluid {{ density 1000 kg/m^3 }}
        flow stir {{ radius 1m  rate 60 rpm  follow 0.5 }}"
    );
    let planar =
        format!("world planar {GRAVITY} enclosure disc {{ radius 5m wall 25 N/m }} mount wall");
    for (clauses, expected) in [
        (format!("mount roof {GRAVITY}"), None),
        (format!("mount wall {GRAVITY}"), None),
        ("mount floor".to_owned(), None),
        (format!("mount roof {stirred}"), None),
        (
            format!("mount wall {stirred}"),
            Some("a plate on a wall is not supported with a flow"),
        ),
        (
            "mount roof".to_owned(),
            Some("the position of the plate needs gravity"),
        ),
        (
            planar,
            Some("a planar world has no walls and no roof for a plate"),
        ),
    ] {
        let expected: Vec<&str> = expected.into_iter().collect();
        assert_eq!(errors(&clauses), expected, "{clauses}");
    }
}

/// Checks the warnings of heavy blocks under a structure on the roof. A derived scene moves the
/// plate back to the floor.
#[test]
fn heavy_blocks_sink_away_from_a_plate_on_the_roof() {
    let effects = |mount: &str| {
        let found = checked(&format!(
            "scene roof from hemisphere {{ mount roof {GRAVITY}
                agitation kicks {{ speed 0 .. 0.1 m/s }} drag {{ rate 1 s^-1 }} }}
            scene s from roof {{ {mount} }}
            assembly a in s {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up ->> T[1..5] }} }}"
        ));
        let warnings = with_code(&found, Code::BuoyantBlocks);
        let warnings = warnings.into_iter().map(|it| format!("{it:?}"));
        warnings.collect::<Vec<_>>()
    };
    for (mount, expected) in [
        (
            "mount roof",
            "most blocks sink away from the plate, and layer 1 has",
        ),
        (
            "mount floor",
            "most blocks lie on the floor, and layer 5 has",
        ),
    ] {
        let warnings = effects(mount);
        assert_eq!(warnings.len(), 1, "{mount}");
        assert!(warnings[0].contains(expected), "{mount}: {warnings:?}");
    }
    assert_eq!(effects("mount wall").len(), 0);
}
