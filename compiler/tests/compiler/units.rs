//! Tests laboratory units, units on the wrong line, and zeros in scenes.
use stochc_ir::scene::Scene;

use crate::checked;

fn text(base: &str, clauses: &str) -> String {
    let program = "{ seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }";
    format!("scene s from {base} {{ {clauses} }}\nassembly a in s {program}\n")
}

fn scene(clauses: &str) -> Scene {
    let mut checked = checked(&text("hemisphere", clauses));
    let scene = checked.programs.remove(0).scene;
    scene.unwrap_or_else(|| panic!("{clauses}: {:?}", checked.diagnostics))
}

/// Applies the change of each diagnostic to a scene with these clauses.
fn fixed(base: &str, clauses: &str) -> String {
    let mut text = text(base, clauses);
    let checked = checked(&text);
    let mut edits: Vec<_> = (checked.diagnostics.iter())
        .flat_map(|found| found.fix.iter().flat_map(|fix| &fix.edits))
        .collect();
    edits.sort_by_key(|edit| edit.location.span.start);
    for edit in edits.into_iter().rev() {
        let span = edit.location.span;
        text.replace_range(span.start as usize..span.end as usize, &edit.text);
    }
    let start = text.find("{ ").unwrap() + 2;
    let end = text.find(" }\nassembly").unwrap();
    text[start..end].to_owned()
}

#[test]
fn units_of_the_laboratory_are_read() {
    assert_eq!(scene("tick 1 ph").tick, 3.6e-9);
    for (unit, value) in [("60 cP", 0.06), ("2 P", 0.2), ("1 mbar ms", 0.1)] {
        let scene = scene(&format!("fluid {{ density 1 g/cm^3  viscosity {unit} }}"));
        assert_eq!(scene.fluid.unwrap().viscosity, Some(value), "{unit}");
    }
    let flow = |rate: &str| {
        let clause = format!(
            "flow stir {{ radius 8.5cm  rate {rate}  force 0.8 N  follow 20% }}  fluid {{ density 1 g/cm^3 }}"
        );
        scene(&clause).flow
    };
    assert_eq!(flow("30 rpm"), flow("30 rev/min"));
}

#[test]
fn other_units_are_converted() {
    for (written, suggestion) in [("2 mmHg", "266.64477483 Pa"), ("2 atm", "202650 Pa")] {
        let bond = |head: &str| {
            format!(
                "bond suction {{ head {head}  supply 0  valve 5 kPa s/L  passage 1 kPa s/L  seal 1cm  anchor centres 5mm }}"
            )
        };
        assert_eq!(fixed("suction_tank", &bond(written)), bond(suggestion));
    }
    for (written, suggestion) in [
        (
            "agitation brownian { temperature 20 degC }",
            "agitation brownian { temperature 293.15 K }",
        ),
        (
            "block cube { side 2 inch  mass 5 mcg }",
            "block cube { side 5.08 cm  mass 5 ug }",
        ),
        (
            "fluid { density 1 g/cm^3  viscosity 60 mPas }",
            "fluid { density 1 g/cm^3  viscosity 60 mPa s }",
        ),
        // Another dimension is never suggested.
        (
            "block cube { side 2 mbr  mass 1 kg }",
            "block cube { side 2 mbr  mass 1 kg }",
        ),
        (
            "block cube { side 2 atm  mass 1 kg }",
            "block cube { side 2 atm  mass 1 kg }",
        ),
    ] {
        assert_eq!(fixed("magnet_tank", written), suggestion);
    }
}

#[test]
fn a_unit_on_the_next_line_is_moved_to_its_number() {
    for (written, suggestion) in [
        ("tick 20\nms", "tick 20 ms\n"),
        ("tick 20 // a comment\n  ms", "tick 20 ms // a comment\n  "),
        (
            "agitation kicks { speed 0 .. 1\nm }",
            "agitation kicks { speed 0 .. 1 m\n }",
        ),
        (
            "bond attract { pull 4\nN  within 1cm  anchor centres 1mm }",
            "bond attract { pull 4 N\n  within 1cm  anchor centres 1mm }",
        ),
    ] {
        assert_eq!(fixed("hemisphere", written), suggestion);
    }
}

#[test]
fn zero_needs_no_unit() {
    for clauses in [
        "agitation kicks { speed 0 }",
        "agitation kicks { speed 0 .. 0 }",
        "contact { stiffness 250 N/m  damping 0  friction 1 }",
    ] {
        scene(clauses);
    }
    let wrong = checked(&text("hemisphere", "agitation kicks { speed 0 kg }"));
    assert_eq!(wrong.diagnostics.len(), 1, "{:?}", wrong.diagnostics);
}
