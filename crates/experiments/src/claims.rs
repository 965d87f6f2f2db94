//! Decisions about claims, from the runs of programs.
use serde::Serialize;
use stochc_ir::claim::{Claim, ClaimedEvent, Relation};
use stochc_ir::record::{Origin, Outcome, RunRecord};
use stochc_results::{EnsembleProgram, JournalError, Records};

use crate::completion_status;
use crate::statistics::{Mean, MeanTest, ShareTest, Side, Status};

/// Result of testing a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The claim is true.
    Holds,
    /// The claim is false.
    Fails,
    /// The runs do not decide.
    Undecided,
}

/// Quantity of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ClaimedQuantity {
    /// Probability of an event.
    Probability,
    /// Mean completion time \[ticks\].
    Mean,
    /// Relative difference of two means.
    Difference,
}

/// Method of testing a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ClaimMethod {
    /// Independent runs.
    Runs,
    /// Distribution of the rate model, without runs.
    Convolution,
}

/// A tested claim.
#[derive(Clone, Debug, PartialEq)]
pub struct TestedClaim {
    /// Result of the test.
    pub verdict: Verdict,
    /// Meaning of the estimate and of the limits.
    pub quantity: ClaimedQuantity,
    /// Estimate of the quantity. `None` if a stopped run leaves it unknown.
    pub estimate: Option<f64>,
    /// Lower and upper limit of the quantity, possibly infinite.
    pub limits: (f64, f64),
    /// Number of runs of each program until the decision, or of all runs.
    pub runs: u64,
    /// CPU time of these runs \[s\]. `None` if it was not measured.
    pub cpu: Option<f64>,
    /// Method of the test.
    pub method: ClaimMethod,
}

/// Settings of a test of claims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClaimTesting {
    /// Largest probability of a wrong decision about one claim.
    pub alpha: f64,
    /// Half-width of the range around the bound of a probability within which any decision is
    /// allowed.
    pub margin: f64,
    /// Largest relative error of the times of the model.
    pub error: ModelError,
}

/// Systematic error of the times of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelError {
    /// Smallest ratio of the true time to the time of the model.
    pub shortest: f64,
    /// Largest ratio of the true time to the time of the model. Infinite if times of the model are
    /// lower bounds.
    pub longest: f64,
}

impl ModelError {
    /// No error.
    pub const NONE: ModelError = ModelError {
        shortest: 1.0,
        longest: 1.0,
    };
}

/// Time from its shortest to its longest possible value \[ticks\]. Infinite for an event that
/// never happens.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TimeRange {
    shortest: f64,
    longest: f64,
}

const NEVER: TimeRange = TimeRange::new(f64::INFINITY, f64::INFINITY);

const UNKNOWN: TimeRange = TimeRange::new(0.0, f64::INFINITY);

impl TimeRange {
    const fn new(shortest: f64, longest: f64) -> TimeRange {
        TimeRange { shortest, longest }
    }

    const fn known(time: f64) -> TimeRange {
        TimeRange::new(time, time)
    }

    fn with_error(self, error: ModelError) -> TimeRange {
        let TimeRange { shortest, longest } = self;
        // A time of 0 has no error.
        let longest = if longest == 0.0 {
            0.0
        } else {
            longest * error.longest
        };
        TimeRange::new(shortest * error.shortest, longest)
    }

    /// Returns whether the event happens within a limit. Returns `None` if this is unknown.
    fn is_within(self, limit: Option<f64>) -> Option<bool> {
        let limit = limit.unwrap_or(f64::MAX);
        if self.longest <= limit {
            Some(true)
        } else {
            (self.shortest > limit).then_some(false)
        }
    }
}

/// Returns the time of an event in a run.
fn event_time(event: ClaimedEvent, record: &RunRecord) -> TimeRange {
    let ticks = record.ticks as f64;
    let missing = |earliest: f64| match completion_status(&record.outcome) {
        Some(Status::Completed | Status::Competing) => NEVER,
        Some(Status::Censored) => TimeRange::new(earliest, f64::INFINITY),
        // The events of the last tick are unknown.
        None => TimeRange::new((earliest - 1.0).max(0.0), f64::INFINITY),
    };
    // The run has processed the events of its last tick.
    let next = ticks + 1.0;
    match event {
        ClaimedEvent::Completion if record.outcome == Outcome::Completed => TimeRange::known(ticks),
        ClaimedEvent::Completion => missing(next),
        ClaimedEvent::Phase(phase) => {
            let (phase, phases) = (phase.0 as usize, &record.phase_ticks);
            match phases.get(phase) {
                Some(&time) => TimeRange::known(time as f64),
                None if phases.len() == phase => missing(next - phases.iter().sum::<u64>() as f64),
                None => missing(0.0),
            }
        }
        ClaimedEvent::Capture { block, by } => {
            let was_block =
                |origin: &Origin| matches!(origin, Origin::Released { role, .. } if *role == block);
            let mut bonds = record.all_bonds().filter(|bond| bond.parent == by);
            let bond = bonds.find(|bond| bond.child == block || was_block(&bond.origin));
            bond.map_or_else(
                || missing(next),
                |bond| TimeRange::known(bond.docked as f64),
            )
        }
    }
}

/// Times of one run that a claim needs: of its own program, and of the other program.
struct ClaimedRun {
    own: TimeRange,
    other: Option<TimeRange>,
    cpu: Option<f64>,
}

/// Tests the claims of the first program. Each claim uses the runs in the order of their numbers,
/// until it is decided. `programs` contains all programs that the claims name.
///
/// # Errors
///
/// If the runs cannot be read.
pub fn test_claims(
    claims: &[Claim],
    programs: &[EnsembleProgram],
    finished: &Records,
    testing: ClaimTesting,
) -> Result<Vec<TestedClaim>, JournalError> {
    let mut runs: Vec<Vec<ClaimedRun>> = claims.iter().map(|_| Vec::new()).collect();
    let mut next: Vec<usize> = vec![0; claims.len()];
    finished.each(|done| {
        for (number, claim) in claims.iter().enumerate() {
            let event = match claim {
                Claim::Probability { event, .. } => *event,
                Claim::Mean { .. } | Claim::Faster { .. } => ClaimedEvent::Completion,
            };
            let time = event_time(event, &done.record);
            if done.program == 0 {
                runs[number].push(ClaimedRun {
                    own: time,
                    other: None,
                    cpu: done.cpu,
                });
            } else if matches!(claim, Claim::Faster { than, .. } if programs[done.program].assembly() == than)
                && let Some(run) = runs[number].get_mut(next[number])
            {
                // Runs are sorted by program and number.
                next[number] += 1;
                let ratio = programs[done.program].scene.tick / programs[0].scene.tick;
                run.other = Some(TimeRange::new(time.shortest * ratio, time.longest * ratio));
                run.cpu = run.cpu.zip(done.cpu).map(|(own, other)| own + other);
            }
        }
    })?;
    let claims = claims.iter().zip(&runs);
    Ok(claims
        .map(|(claim, runs)| tested(claim, runs, testing))
        .collect())
}

fn tested(claim: &Claim, runs: &[ClaimedRun], testing: ClaimTesting) -> TestedClaim {
    let ClaimTesting {
        alpha,
        margin,
        error,
    } = testing;
    let mut own = runs.iter().map(|run| run.own.with_error(error));
    match claim {
        Claim::Probability {
            within,
            relation,
            bound,
            ..
        } => {
            let mut test = ShareTest::new(*bound, margin, alpha);
            let decided = own.find_map(|time| test.add(time.is_within(*within)));
            let runs = &runs[..test.runs() as usize];
            let happened = runs.iter().map(|run| run.own.is_within(*within));
            let share = happened
                .map(|happened| happened.map(f64::from))
                .sum::<Option<f64>>();
            let share = share.map(|sum| sum / runs.len() as f64);
            TestedClaim {
                verdict: verdict(decided, *relation),
                quantity: ClaimedQuantity::Probability,
                estimate: share.filter(|_| !runs.is_empty()),
                limits: test.interval(),
                runs: test.runs(),
                cpu: cpu(runs),
                method: ClaimMethod::Runs,
            }
        }
        Claim::Mean { relation, bound } => {
            let mut test = MeanTest::new(*bound, alpha);
            let decided = own.find_map(|time| test.add(time.shortest, time.longest));
            let runs = &runs[..test.runs() as usize];
            TestedClaim {
                verdict: verdict(decided, *relation),
                quantity: ClaimedQuantity::Mean,
                estimate: mean(runs.iter().map(|run| run.own)),
                limits: test.interval(),
                runs: test.runs(),
                cpu: cpu(runs),
                method: ClaimMethod::Runs,
            }
        }
        Claim::Faster { by, .. } => faster(*by, runs, testing),
    }
}

/// Tests the mean of the differences of pairs: (1 - `by`) times the other time, minus the own time.
/// Runs with the same number have the same seed.
fn faster(by: f64, runs: &[ClaimedRun], testing: ClaimTesting) -> TestedClaim {
    let mut test = MeanTest::new(0.0, testing.alpha);
    let other = |run: &ClaimedRun| run.other.unwrap_or(UNKNOWN);
    let decided = runs.iter().find_map(|run| {
        let [own, other] = [run.own, other(run)].map(|time| time.with_error(testing.error));
        let low = (1.0 - by) * other.shortest - own.longest;
        let high = (1.0 - by) * other.longest - own.shortest;
        // A program that never completes has no mean, so its time shows nothing.
        let is_unknown = low.is_nan() || other.shortest.is_infinite();
        let low = if is_unknown { f64::NEG_INFINITY } else { low };
        // The difference of two times that are both unknown is unknown.
        let high = if high.is_nan() { f64::INFINITY } else { high };
        test.add(low, high)
    });
    let runs = &runs[..test.runs() as usize];
    let [own, others] = [
        mean(runs.iter().map(|run| run.own)),
        mean(runs.iter().map(other)),
    ];
    let (low, high) = test.interval();
    let limits = match others {
        Some(mean) => (by + low / mean, by + high / mean),
        // Without a mean of the other program, only the side of the bound is known.
        None => (
            if low > 0.0 { by } else { f64::NEG_INFINITY },
            if high < 0.0 { by } else { f64::INFINITY },
        ),
    };
    TestedClaim {
        verdict: verdict(decided, Relation::AtLeast),
        quantity: ClaimedQuantity::Difference,
        estimate: own.zip(others).map(|(own, others)| 1.0 - own / others),
        limits,
        runs: test.runs(),
        cpu: cpu(runs),
        method: ClaimMethod::Runs,
    }
}

/// Returns the mean of known times. Returns `None` if a time is unknown or infinite, or there are
/// none.
fn mean(times: impl Iterator<Item = TimeRange>) -> Option<f64> {
    let mut mean = Mean::default();
    for time in times {
        let is_known = time.shortest == time.longest && time.longest.is_finite();
        mean.add(is_known.then_some(time.longest)?);
    }
    mean.value()
}

fn verdict(side: Option<Side>, relation: Relation) -> Verdict {
    match (side, relation) {
        (None, _) => Verdict::Undecided,
        (Some(Side::Above), Relation::AtLeast) | (Some(Side::Below), Relation::AtMost) => {
            Verdict::Holds
        }
        _ => Verdict::Fails,
    }
}

/// Returns the CPU time of runs \[s\].
fn cpu(runs: &[ClaimedRun]) -> Option<f64> {
    runs.iter().map(|run| run.cpu).sum()
}

#[cfg(test)]
mod tests {
    use stochc_ir::record::Limit;
    use stochc_ir::table::PhaseId;

    use super::*;

    fn stopped(by: Limit) -> RunRecord {
        let outcome = Outcome::TimedOut {
            phase: PhaseId(1),
            by,
        };
        RunRecord {
            phase_ticks: vec![70],
            ..RunRecord::without_bonds(0, outcome, 100)
        }
    }

    /// A run that reached its tick limit has failed a claim about a time up to the limit, and is in
    /// doubt for a longer time.
    #[test]
    fn stopped_runs_never_count_as_successes() {
        let limit = stopped(Limit::MaxTicks);
        let time = event_time(ClaimedEvent::Completion, &limit);
        assert_eq!(time.is_within(Some(100.0)), Some(false));
        assert_eq!(time.is_within(Some(100.5)), Some(false));
        assert_eq!(time.is_within(Some(101.0)), None);
        assert_eq!(time.is_within(None), None);
        let timeout = stopped(Limit::Timeout);
        let time = event_time(ClaimedEvent::Completion, &timeout);
        assert_eq!(time.is_within(Some(200.0)), Some(false));
        assert_eq!(time.is_within(None), Some(false));
    }

    #[test]
    fn broken_structures_never_complete() {
        let run = |is_broken| {
            let (phase, reason) = (PhaseId(1), String::new());
            let outcome = Outcome::Failed {
                phase,
                reason,
                is_broken,
            };
            RunRecord::without_bonds(0, outcome, 100)
        };
        let time = |is_broken| event_time(ClaimedEvent::Completion, &run(is_broken));
        assert_eq!(time(true), NEVER);
        assert_eq!(time(false).is_within(Some(200.0)), None);
    }

    #[test]
    fn phases_have_their_own_times() {
        let limit = stopped(Limit::MaxTicks);
        let phase = |number| event_time(ClaimedEvent::Phase(PhaseId(number)), &limit);
        assert_eq!(phase(0), TimeRange::known(70.0));
        assert_eq!(phase(1), TimeRange::new(31.0, f64::INFINITY));
        assert_eq!(phase(2), UNKNOWN);
        let timeout = stopped(Limit::Timeout);
        let phase = event_time(ClaimedEvent::Phase(PhaseId(2)), &timeout);
        assert_eq!(phase, NEVER);
    }

    #[test]
    fn errors_of_the_model_widen_times() {
        let error = ModelError {
            shortest: 0.5,
            longest: 2.0,
        };
        let time = TimeRange::known(100.0).with_error(error);
        assert_eq!(time.is_within(Some(49.0)), Some(false));
        assert_eq!(time.is_within(Some(100.0)), None);
        assert_eq!(time.is_within(Some(200.0)), Some(true));
    }

    /// Pairs of runs whose times differ by a quarter each.
    #[test]
    fn a_difference_is_relative_to_the_other_program() {
        let runs = (0..100).map(|run| {
            let other = 100.0 + f64::from(run);
            ClaimedRun {
                own: TimeRange::known(0.75 * other),
                other: Some(TimeRange::known(other)),
                cpu: Some(0.5),
            }
        });
        let runs: Vec<ClaimedRun> = runs.collect();
        let testing = ClaimTesting {
            alpha: 0.05,
            margin: 0.0,
            error: ModelError::NONE,
        };
        let holds = faster(0.2, &runs, testing);
        assert_eq!(holds.verdict, Verdict::Holds);
        assert_eq!((holds.runs, holds.cpu), (100, Some(50.0)));
        assert!((holds.estimate.unwrap() - 0.25).abs() < 1e-9, "{holds:?}");
        assert!(holds.limits.0 > 0.2 && holds.limits.1 > 0.25, "{holds:?}");
        assert_eq!(faster(0.3, &runs, testing).verdict, Verdict::Fails);
    }
}
