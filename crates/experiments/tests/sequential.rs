//! Checks the error bounds of sequential tests by simulation.
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use stochc_experiments::statistics::{MeanTest, ShareTest, Side};

const ALPHA: f64 = 0.05;

/// Largest number of runs of a test.
const MAX_RUNS: u64 = 2000;

/// Results of repeated tests.
#[derive(Clone, Copy, Debug)]
struct Study {
    /// Shares of tests that decide for each side.
    above: f64,
    below: f64,
    /// Mean number of runs.
    runs: f64,
    /// Standard error of a share of `ALPHA`.
    error: f64,
}

/// Repeats a test. `add` makes a run, and returns the decision.
fn study<T>(
    repetitions: u32,
    start: impl Fn() -> T,
    add: impl Fn(&mut T, &mut ChaCha8Rng) -> Option<Side>,
) -> Study {
    let [mut above, mut below, mut runs] = [0.0; 3];
    for repetition in 0..repetitions {
        let mut random = ChaCha8Rng::seed_from_u64(repetition.into());
        let mut test = start();
        for _ in 0..MAX_RUNS {
            runs += 1.0;
            match add(&mut test, &mut random) {
                None => continue,
                Some(Side::Above) => above += 1.0,
                Some(Side::Below) => below += 1.0,
            }
            break;
        }
    }
    let number = f64::from(repetitions);
    Study {
        above: above / number,
        below: below / number,
        runs: runs / number,
        error: (ALPHA * (1.0 - ALPHA) / number).sqrt(),
    }
}

fn share(repetitions: u32, [bound, margin, truth]: [f64; 3]) -> Study {
    study(
        repetitions,
        || ShareTest::new(bound, margin, ALPHA),
        |test, random| test.add(Some(random.random::<f64>() < truth)),
    )
}

/// Returns Wald's mean number of runs of a sequential probability ratio test with errors `ALPHA`,
/// at the lower or the upper end of the margin.
fn wald([bound, margin, truth]: [f64; 3]) -> f64 {
    let [low, high] = [bound - margin, bound + margin];
    let information = truth * (high / low).ln() + (1.0 - truth) * ((1.0 - high) / (1.0 - low)).ln();
    (1.0 - 2.0 * ALPHA) * ((1.0 - ALPHA) / ALPHA).ln() / information.abs()
}

/// Checks all cases with this number of repetitions, and prints a table.
fn check_shares(repetitions: u32) {
    println!("| bound | margin | probability | above | below | runs | runs / Wald |");
    for [bound, margin] in [
        [0.95, 0.0],
        [0.8, 0.0],
        [0.95, 0.02],
        [0.9, 0.05],
        [0.5, 0.05],
    ] {
        let beside = if margin > 0.0 { margin } else { 0.02 };
        for truth in [bound - beside, bound, bound + beside] {
            let case = [bound, margin, truth];
            let found = share(repetitions, case);
            let is_end = margin > 0.0 && truth != bound;
            let ratio = if is_end {
                found.runs / wald(case)
            } else {
                f64::NAN
            };
            let Study {
                above,
                below,
                runs,
                error,
            } = found;
            println!(
                "| {bound} | {margin} | {truth:.2} | {above:.4} | {below:.4} | {runs:.0} | {ratio:.2} |"
            );
            let most = ALPHA + 3.0 * error;
            let is_within = truth == bound && margin > 0.0;
            assert!(
                is_within || truth > bound || above <= most,
                "{case:?}: {found:?}"
            );
            assert!(
                is_within || truth < bound || below <= most,
                "{case:?}: {found:?}"
            );
            assert!(!is_end || ratio <= 1.3, "{case:?}: {found:?}");
        }
    }
}

/// Distributions with the mean 1, by the number of exponential stages.
const STAGES: [u32; 3] = [1, 4, 16];

fn mean(repetitions: u32, stages: u32, bound: f64) -> Study {
    study(
        repetitions,
        || MeanTest::new(bound, ALPHA),
        |test, random| {
            let logarithms = (0..stages).map(|_| -(1.0 - random.random::<f64>()).ln());
            let value = logarithms.sum::<f64>() / f64::from(stages);
            test.add(value, value)
        },
    )
}

/// Checks means of waiting times with these numbers of stages.
fn check_means(repetitions: u32) {
    println!("| stages | bound / mean | above | below | runs |");
    for stages in STAGES {
        for bound in [0.9, 1.0, 1.1] {
            let found = mean(repetitions, stages, bound);
            let Study {
                above,
                below,
                runs,
                error,
            } = found;
            println!("| {stages} | {bound} | {above:.4} | {below:.4} | {runs:.0} |");
            // The error bound is asymptotic. The distribution with one stage is the most skewed.
            let bias = if stages == 1 { 1.3 } else { 1.0 };
            let most = bias * ALPHA + 3.0 * error;
            assert!(bound < 1.0 || above <= most, "{stages} {bound}: {found:?}");
            assert!(bound > 1.0 || below <= most, "{stages} {bound}: {found:?}");
        }
    }
}

#[test]
fn tests_of_probabilities_keep_their_error_bound() {
    check_shares(200);
}

#[test]
fn tests_of_means_keep_their_error_bound() {
    check_means(200);
}

#[test]
#[ignore = "takes minutes without optimization"]
fn ten_thousand_tests_keep_their_error_bound() {
    check_shares(10_000);
    check_means(10_000);
}
