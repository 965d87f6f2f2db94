//! Compares the distributions of `rigid` and `rapier`. `lab/bench/src/bin/agreement` contains the
//! full study.

use std::ops::ControlFlow;

use crate::statistics::{gap, kolmogorov_smirnov, mann_whitney, mean};
use crate::tables::chain;
use stochc_compiler::scene::built_in;
use stochc_ir::Face;
use stochc_ir::record::Outcome;
use stochc_ir::scene::Enclosure;
use stochc_ir::table::PhaseId;
use stochc_runtime::{Model, Settings, run};

/// Returns the ticks until a face of the plate has captured one of 40 blocks. The shell has a
/// radius of 8 block lengths. The results of both models no longer depend on the number of
/// substeps.
fn waits(model: Model, runs: u64) -> Vec<f64> {
    let mut scene = built_in("hemisphere_2005").expect("a built-in scene");
    scene.free.count = 40;
    if let Some(Enclosure::Hemisphere { radius, .. }) = &mut scene.enclosure {
        *radius = 8.0 * scene.block.side;
    }
    let settings = Settings {
        model,
        substeps: 8,
        ..Settings::new(Model::Rapier, 1)
    };
    let (tables, _) = chain(&[Face::Up]);
    let seed = model as u64;
    let wait = |number| {
        let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
        let record =
            run(&tables, &scene, &settings, seed, number, &mut watch).expect("a valid scene");
        assert_eq!(record.outcome, Outcome::Completed);
        record.ticks as f64
    };
    (0..runs).map(wait).collect()
}

/// Chance exceeds each of these limits in one of 1,000 cases.
#[test]
fn models_agree_on_the_wait_of_a_plate_face() {
    let [rigid, rapier] = [Model::Rigid, Model::Rapier].map(|model| waits(model, 200));
    let (a, b) = (mean(&rigid), mean(&rapier));
    let p = kolmogorov_smirnov(&rigid, &rapier);
    assert!(p > 0.001, "p = {p}: {a:?} and {b:?}");
    let p = mann_whitney(&rigid, &rapier);
    assert!(p > 0.001, "p = {p}: {a:?} and {b:?}");
}

#[test]
fn statistics_agree_with_published_values() {
    let numbers = |from: i32, to: i32| (from..to).map(f64::from).collect::<Vec<f64>>();
    let (a, b) = (numbers(0, 100), numbers(20, 120));
    assert!((gap(&a, &b) - 0.2).abs() < 1e-12);
    // Q(x) = 2 sum (-1)^(k-1) exp(-2 k^2 x^2) at x = 0.2 (sqrt(50) + 0.12 + 0.11 / sqrt(50)) = 1.4413.
    assert!((kolmogorov_smirnov(&a, &b) - 0.031_377).abs() < 1e-6);
    assert_eq!(kolmogorov_smirnov(&a, &a), 1.0);
    assert!((mann_whitney(&a, &a) - 1.0).abs() < 1e-12);
    // There are no ties: 1, 2, 3 against 4, 5, 6, 7 gives z = 6 / sqrt(3 * 4 * 8 / 12).
    let z = 6.0 / 8f64.sqrt();
    let p = libm::erfc(z / std::f64::consts::SQRT_2);
    assert!((mann_whitney(&numbers(1, 4), &numbers(4, 8)) - p).abs() < 1e-12);
    let (middle, half) = mean(&[1.0, 2.0, 3.0]);
    assert!((middle - 2.0).abs() < 1e-12 && (half - 1.96 / 3f64.sqrt()).abs() < 1e-12);
}
