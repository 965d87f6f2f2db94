//! Tests that claims decided without runs agree with runs of the rate model.
use std::sync::atomic::AtomicBool;

use stochc_estimate::Rates;
use stochc_experiments::{ClaimTesting, ModelError, decide_claims, test_claims};
use stochc_ir::claim::Claim;
use stochc_ir::scene::{Bond, BondStrength, Scene};
use stochc_results::{EnsembleProgram, Finished, Records};
use stochc_runtime::{Model, Settings};

const RUNS: u64 = 3_000;

/// The captures of both phases happen one after the other. Some cells are at corners of the
/// structure, so that waiting times differ.
const TEXT: &str = "assembly hook {
    seed plate 1 x 1 { M at (0, 0) }
    phase foot { M.up ->> T[1..3] }
    phase arm { T[3].east -> E1  E1.east -> E2  E2.down -> D }
    expect complete within 3500 ticks with probability >= 0.5
    expect complete within 75.01 s with probability >= 0.5
    expect phase foot within 1500 ticks with probability >= 0.5
    expect phase arm within 30 s with probability <= 0.5
    expect captured E1 by T[3] within 2500 ticks with probability >= 0.5
    expect mean completion <= 4000 ticks
}";

#[test]
fn probabilities_and_means_agree_with_runs() {
    let mut reader = |_: &str| Ok(TEXT.as_bytes().to_vec());
    let checked = stochc_compiler::check("hook.sa", &mut reader, Default::default());
    let claims = checked.programs[0].claims.clone();
    assert_eq!(claims.len(), 6, "{:#?}", checked.diagnostics);
    let executable = stochc::compile(checked).unwrap().remove(0);
    let settings = Settings::new(Model::Rate, 1);
    let runs = (0..RUNS).map(|run| Finished {
        program: 0,
        record: stochc::simulate(&executable, &settings, 3, run).unwrap(),
        cpu: None,
    });
    let runs: Records = runs.collect::<Vec<_>>().into();
    let rates = Rates::built_in(&executable.scene).unwrap();
    let program = EnsembleProgram::new("hook", Vec::new(), executable);
    let computed = decide_claims(
        &claims,
        std::slice::from_ref(&program),
        &[rates],
        ModelError::NONE,
        &AtomicBool::new(false),
    );
    let stopped = decide_claims(
        &claims,
        std::slice::from_ref(&program),
        &[rates],
        ModelError::NONE,
        &AtomicBool::new(true),
    );
    assert!(stopped[0].is_none());
    // No test decides at this error probability, so all runs count.
    let testing = ClaimTesting {
        alpha: 1e-300,
        margin: 0.0,
        error: ModelError::NONE,
    };
    let tested = test_claims(&claims, &[program], &runs, testing).unwrap();
    for ((claim, computed), tested) in claims.iter().zip(computed).zip(tested) {
        let [computed, estimate] =
            [computed.unwrap().estimate, tested.estimate].map(Option::unwrap);
        assert_eq!(tested.runs, RUNS);
        let deviation = match claim {
            Claim::Probability { .. } => {
                assert!((0.2..0.8).contains(&computed), "{claim:?}: {computed}");
                (computed * (1.0 - computed)).sqrt()
            }
            // The standard deviation of six similar waits is at most that of their sum.
            _ => computed / 2.0,
        };
        let error = deviation / (RUNS as f64).sqrt();
        assert!(
            (computed - estimate).abs() < 4.0 * error,
            "{claim:?}: {computed} and {estimate}"
        );
    }
}

/// A phase with `wait` lasts longer than its captures, so its claims need runs.
#[test]
fn phases_with_a_wait_need_runs() {
    let text = TEXT.replace("E2.down -> D }", "E2.down -> D  wait 500 s }");
    assert_ne!(text, TEXT);
    assert_needs_runs(&text, |_| ());
}

/// A structure whose bonds break never completes.
#[test]
fn bonds_that_break_need_runs() {
    assert_needs_runs(TEXT, |scene| {
        let strength = scene.bond.as_mut().and_then(Bond::strength_mut);
        *strength.unwrap() = Some(BondStrength {
            force: Some(1e-9),
            torque: None,
        });
    });
}

/// Checks that no claim is decided without runs, in a changed scene.
fn assert_needs_runs(text: &str, change: impl Fn(&mut Scene)) {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let checked = stochc_compiler::check("hook.sa", &mut reader, Default::default());
    let claims = checked.programs[0].claims.clone();
    let mut executable = stochc::compile(checked).unwrap().remove(0);
    change(&mut executable.scene);
    let rates = Rates::built_in(&executable.scene).unwrap();
    let program = EnsembleProgram::new("hook", Vec::new(), executable);
    let decided = decide_claims(
        &claims,
        &[program],
        &[rates],
        ModelError::NONE,
        &AtomicBool::new(false),
    );
    assert!(decided.iter().all(Option::is_none), "{decided:#?}");
}
