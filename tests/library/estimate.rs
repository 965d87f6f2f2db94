//! Tests that the times of `check --cost` agree with runs of the rate model. Both use the same
//! rates, but different code reads the program.
use stochc_estimate::{Interaction, Rates};
use stochc_ir::record::Outcome;
use stochc_runtime::{Model, Settings};

const RUNS: u64 = 400;

/// Checks that the means of an estimate and of runs differ by at most the stated error, except for
/// chance.
fn agree(names: &[&str], interaction: Interaction) {
    for name in names {
        let checked = stochc::check(name);
        assert!(!checked.has_errors(), "{name}");
        let program = &checked.programs[0];
        let rates = Rates::built_in(program.scene.as_ref().unwrap());
        let cost = program.estimate(rates).unwrap();
        assert_eq!(cost.interaction, interaction, "{name}");
        let expected = cost.total.unwrap();
        let executable = stochc::compile(checked).unwrap().remove(0);
        let settings = Settings::new(Model::Rate, 1);
        let ticks: Vec<f64> = (0..RUNS)
            .map(|run| {
                let record = stochc::simulate(&executable, &settings, 11, run).unwrap();
                assert_eq!(record.outcome, Outcome::Completed, "{name}");
                record.ticks as f64
            })
            .collect();
        let count = RUNS as f64;
        let mean = ticks.iter().sum::<f64>() / count;
        let squares: f64 = ticks.iter().map(|ticks| (ticks - mean).powi(2)).sum();
        let error = (squares / (count - 1.0) / count).sqrt() / mean;
        let error = error.hypot(expected.half_width.unwrap() / 1.96 / mean);
        let expected = expected.mean.unwrap();
        let off = expected / mean - 1.0;
        assert!(
            off.abs() < interaction.error() + 3.5 * error,
            "{name}: {expected:.0} instead of {mean:.0}, off by {off:.3}, standard error {error:.3}"
        );
    }
}

#[test]
fn distant_faces_agree_with_independent_waits() {
    agree(
        &[
            "examples/line.sa",
            "examples/closed_platform.sa",
            "examples/five_tower.sa",
            "lab/rates/gallows.sa",
            "lab/rates/cross.sa",
            "lab/rates/twins.sa",
            "lab/rates/nine_feet.sa",
        ],
        Interaction::Apart,
    );
}

#[test]
fn released_blocks_have_a_head_start() {
    agree(
        &[
            "examples/five_tower_reconfigured.sa",
            "lab/rates/hand_over.sa",
            "lab/rates/releases/turned.sa",
            "lab/rates/releases/written_last.sa",
            "lab/rates/scarce/let_one_go.sa",
        ],
        Interaction::Releases,
    );
}

/// A face that is switched on later than the agitation catches a block sooner.
#[test]
fn faces_that_open_after_a_time_agree() {
    agree(&["tests/fixtures/times/late_phase.sa"], Interaction::Apart);
    agree(
        &["tests/fixtures/times/late_face.sa"],
        Interaction::Releases,
    );
}

#[test]
fn messages_take_time() {
    agree(&["tests/fixtures/messages/apart.sa"], Interaction::Apart);
    agree(
        &[
            "tests/fixtures/messages/releases.sa",
            "tests/fixtures/messages/lossy.sa",
        ],
        Interaction::Releases,
    );
}

/// Checks a released block that several faces could capture. Only one of them captures it.
#[test]
fn a_released_block_docks_once() {
    let checked = stochc::check("lab/rates/releases/turned.sa");
    assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
    let program = &checked.programs[0];
    let rates = Rates::built_in(program.scene.as_ref().unwrap());
    let cost = program.estimate(rates).unwrap();
    let expected = cost.phases[1].times.unwrap().p10.unwrap();
    let executable = stochc::compile(checked).unwrap().remove(0);
    let settings = Settings::new(Model::Rate, 1);
    let mut ticks: Vec<u64> = (0..4000)
        .map(|run| {
            let record = stochc::simulate(&executable, &settings, 5, run).unwrap();
            record.phase_ticks[1]
        })
        .collect();
    ticks.sort_unstable();
    // Each value has a standard error of about 3 %.
    let off = expected / ticks[400] as f64 - 1.0;
    assert!(
        off.abs() < 0.12,
        "{expected:.0} and {}: {off:.3}",
        ticks[400]
    );
}

#[test]
fn adjacent_faces_are_approximated() {
    agree(
        &["lab/rates/races/overtaken.sa", "lab/rates/races/stair.sa"],
        Interaction::Racing,
    );
}

#[test]
fn long_chains_deplete_free_blocks() {
    agree(
        &[
            "lab/rates/sixteen.sa",
            "lab/rates/scarce/nine_of_8.sa",
            "lab/rates/scarce/nine_of_16.sa",
            "lab/rates/scarce/sixteen_of_10.sa",
            "lab/rates/scarce/twenty_five_of_8.sa",
            "lab/rates/scarce/thirty_six_of_8.sa",
        ],
        Interaction::Apart,
    );
}
