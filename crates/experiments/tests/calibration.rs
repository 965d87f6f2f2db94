//! Checks that a calibration recovers the known rates of simulated runs.
use std::ops::ControlFlow;

use stochc_compiler::scene::built_in;
use stochc_compiler::{Limits, check};
use stochc_experiments::calibration::{Calibration, PROGRAMS, TooFew, profile, programs};
use stochc_ir::scene::Scene;
use stochc_ir::table::Tables;
use stochc_runtime::rates::{Parameters, Rates};
use stochc_runtime::{Model, Settings, run};

fn tables(text: &str) -> Tables {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let checked = check("program.sa", &mut reader, Limits::default());
    let program = checked
        .programs
        .into_iter()
        .next()
        .expect("it has a program");
    program
        .into_executable()
        .expect("the program is valid")
        .tables
}

/// Returns the calibrated rates of simulated runs. The runs use rates that differ from the default
/// rates.
fn found(scene: &Scene, truth: &Rates, runs: u64) -> Rates {
    let settings = Settings {
        rates: vec![truth.clone()],
        max_ticks: Some(60_000),
        ..Settings::new(Model::Rate, 1)
    };
    let mut calibration = Calibration::new(scene, truth.profile.clone());
    let mut watch = |_, _| ControlFlow::Continue(());
    for (place, (_, text)) in PROGRAMS.into_iter().enumerate() {
        let tables = tables(text);
        for number in 0..runs {
            let record = run(&tables, scene, &settings, place as u64, number, &mut watch);
            calibration.observe(place, &record.expect("the command starts"));
        }
    }
    calibration
        .rates(&settings, 0)
        .expect("there are many captures")
}

#[test]
fn recovers_the_parameters_of_the_rate_model() {
    let scene = built_in("hemisphere").expect("a built-in scene");
    let mut truth = Rates::built_in(&scene)
        .expect("the files are shipped")
        .clone();
    // The true parameters differ from the centre of the prior.
    let off = [
        0.7, 0.2, 0.0, -0.2, 0.2, 0.2, -0.2, 0.4, -0.3, -0.9, 0.2, -0.4, 1.2, 0.1, 0.2, 0.2, -0.3,
    ];
    for (parameter, off) in truth.parameters.0.iter_mut().zip(off) {
        *parameter += off;
    }
    let rates = found(&scene, &truth, 60);
    for (i, parameter) in Parameters::ALL.iter().enumerate() {
        let error = rates.covariance[i * (Parameters::COUNT + 1)].sqrt();
        let (value, expected) = (rates.parameters.0[i], truth.parameters.0[i]);
        assert!(error < 0.3, "{}: ± {error}", parameter.name);
        // Times are whole ticks, which shifts the estimate by a few thousandths of a docking time.
        let allowed = 4.0 * error + 0.02;
        assert!(
            (value - expected).abs() < allowed,
            "{}: {value} ± {error}, not {expected}",
            parameter.name
        );
    }
    // The data determine waiting times more precisely than single parameters.
    let (x, y) = (rates.parameters.0[0], truth.parameters.0[0]);
    assert!((x - y).abs() < 0.25, "{x} {y}");
    let same = rates
        .head_starts
        .iter()
        .find(|it| it.squared_distance == 0)
        .expect("programs contain such a statement");
    assert!(same.probability > 0.9, "{same:?}");
}

#[test]
fn rejects_too_few_captures() {
    let scene = built_in("hemisphere").expect("a built-in scene");
    let calibration = Calibration::new(&scene, vec![1.0]);
    let error = calibration.rates(&Settings::default(), 0).unwrap_err();
    assert_eq!(error, TooFew::NoCaptures { runs: 0 });
}

#[test]
fn every_program_compiles_and_captures() {
    for (scene, is_planar) in [("suction_tank", false), ("hemisphere", false), ("", true)] {
        let mut scene = built_in(scene).unwrap_or(built_in("hemisphere").expect("a scene"));
        scene.planar = is_planar.then_some(stochc_ir::scene::Planar { friction: None });
        for (name, text) in programs(&scene) {
            assert!(tables(text).captures() > 0, "{name}");
        }
    }
}

#[test]
fn an_interrupt_stops_the_observation_of_the_gas() {
    let scene = built_in("hemisphere").expect("a built-in scene");
    let mut last = 0.0;
    let mut interrupt = |share| {
        assert!((last..1.0).contains(&share));
        last = share;
        if share > 1e-3 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let observed = profile(&scene, &Settings::default(), 1, &mut interrupt);
    assert_eq!(observed, Ok(None));
    assert!(last < 2e-3, "{last}");
}
