use stochc_ir::scene::{Agitation, Flow, Scene};

use super::sample;
use crate::diagnostic::Code;

/// Returns a scene from `hemisphere` with these clauses, and its diagnostics.
fn scene(clauses: &str) -> (Option<Scene>, Vec<(Code, String)>) {
    let (scene, diagnostics) = sample::scene(clauses);
    let diagnostics = diagnostics.into_iter();
    (scene, diagnostics.map(|it| (it.code, it.title)).collect())
}

#[test]
fn a_stirred_tank_is_read_in_units_of_the_laboratory() {
    let (scene, found) = scene(
        "gravity 9.81 m/s^2  fluid { density 0.92 g/cm^3  viscosity 60 mPa s  added_mass 64% }
         flow stir { radius 8.5cm  rate 0.455 rev/s  force 0.795 N  follow 20% }
         agitation turbulence { intensity 3%  length 16cm  vertical 50% }",
    );
    assert_eq!(found, []);
    let scene = scene.unwrap();
    let (fluid, flow) = (scene.fluid.unwrap(), scene.flow.unwrap());
    assert!((fluid.density.unwrap() - 920.0).abs() < 1e-9);
    assert_eq!(
        (fluid.viscosity, fluid.added_mass),
        (Some(0.06), Some(0.64))
    );
    let Flow::Stir(stir) = &flow else {
        panic!("it is stirred");
    };
    // The paper's power at its lowest stirring rate.
    assert!((stir.power().unwrap() - 0.193).abs() < 5e-4);
    let Some(Agitation::Turbulence(turbulence)) = &scene.agitation else {
        panic!("it is turbulent");
    };
    assert!((turbulence.speed(Some(&flow)) - 0.03 * stir.speed()).abs() < 1e-12);
    assert_eq!((turbulence.time, turbulence.vertical), (None, 0.5));
}

#[test]
fn a_tick_clause_after_another_term_is_not_its_unit() {
    for between in [" ", "\n"] {
        for other in ["gravity 9.81 m/s^2", "free 250 uniform"] {
            for tick in ["15ms", "15 ms", "\n15 ms"] {
                let (scene, found) = scene(&format!("{other}{between}tick {tick}"));
                assert_eq!(found, [], "{other}{between}tick {tick}");
                assert_eq!(scene.unwrap().tick, 0.015);
            }
        }
    }
    // After a number, `tick` is still a unit.
    let (_, found) = scene("agitation kicks { speed 0.1 m/tick }");
    assert_eq!(found.len(), 1, "{found:?}");
}

#[test]
fn jets_have_the_speed_of_their_flow() {
    let (scene, found) =
        scene("fluid { density 920 kg/m^3 }  flow jets { count 5  flow 94.5 L/min  nozzle 2cm }");
    assert_eq!(found, []);
    let speed = scene.unwrap().flow.unwrap().speed();
    let exact = 94.5e-3 / 60.0 / 5.0 / (std::f64::consts::PI * 1e-4);
    assert!((speed / exact - 1.0).abs() < 1e-12);
}

#[test]
fn reports_a_scene_without_motion_once() {
    let missing = |clauses: &str, title: &str| {
        let (scene, found) = scene(clauses);
        assert_eq!(scene, None, "{clauses}");
        assert_eq!(found, [(Code::MissingTerm, title.to_owned())], "{clauses}");
    };
    missing(
        "agitation brownian { temperature 3 K }",
        "Brownian motion needs a viscous fluid",
    );
    missing(
        "fluid { density 1 kg/m^3 }  agitation brownian { temperature 3 K }",
        "Brownian motion needs a viscous fluid",
    );
    missing(
        "fluid { viscosity 1 Pa s  added_mass 0.64 }",
        "an added mass needs a density",
    );
    missing(
        "bond suction { head 200 Pa }",
        "suction without `valve` needs a fluid",
    );
    missing("fluid { }", "`fluid` lacks `viscosity`");
    missing(
        "flow jets { count 1  flow 1 L/min  nozzle 1cm }",
        "a flow needs a fluid",
    );
    missing(
        "agitation turbulence { speed 1 m/s  length 1 m }",
        "turbulence needs a fluid",
    );
    missing(
        "fluid { viscosity 1 Pa s }  agitation turbulence { intensity 10%  length 1 m }",
        "an intensity of turbulence needs a flow",
    );
    missing(
        "fluid { viscosity 1 Pa s }  agitation turbulence { length 1 m }",
        "`agitation` lacks `speed`",
    );
}

#[test]
fn reports_an_unknown_kind_once_with_the_known_ones() {
    for (clause, title) in [
        (
            "bond sucktion { head 1 Pa }",
            "expected a bond, found `sucktion`",
        ),
        (
            "flow river { speed 1 m/s }",
            "expected a flow, found `river`",
        ),
        (
            "agitation quakes { }",
            "expected an agitation, found `quakes`",
        ),
    ] {
        let (scene, found) = scene(clause);
        assert_eq!(scene, None);
        assert_eq!(found, [(Code::UnknownTerm, title.to_owned())]);
    }
}

#[test]
fn a_missing_arrangement_is_one_error() {
    for clauses in [
        "free 60",
        "free 60 enclosure hemisphere { radius 3 m  wall 250 N/m }",
    ] {
        let (_, diagnostics) = sample::scene(clauses);
        let titles: Vec<_> = diagnostics.iter().map(|it| it.title.as_str()).collect();
        assert_eq!(
            titles,
            ["expected an arrangement, found nothing"],
            "{clauses}"
        );
        let fix = diagnostics[0].fix.as_ref().expect("a fix");
        assert_eq!(fix.edits[0].text, " uniform");
    }
}
