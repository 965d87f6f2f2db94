//! Statistics of censored times: the Kaplan-Meier estimator (1958), and the cumulative incidence
//! with competing events.
use super::distribution::normal_quantile;
use super::{Observation, Status};

/// Kaplan-Meier curve: the share of incomplete runs as a function of time.
///
/// S(t) is the product of 1 - d/n over the times up to t. Here d of the n runs under observation
/// completed at a time. A run censored at the same time counts as under observation. The estimate
/// assumes that censoring is independent of the speed of a run. A limit on the ticks fulfils this
/// assumption.
///
/// Runs that never complete ([`Status::Competing`]) are not censored. They count as under
/// observation forever. Then 1 - S is the cumulative incidence of completion. With the same limit
/// for all runs it equals the Aalen-Johansen estimator.
///
/// # Source
///
/// R. J. Gray, Ann. Stat. 16 (1988), 1141-1154.
///
/// [`Status::Competing`]: super::Status::Competing
#[derive(Clone, Debug, PartialEq)]
pub struct KaplanMeier {
    steps: Vec<SurvivalStep>,
    last: f64,
    /// End of the time range where the curve is known.
    reach: f64,
}

/// Step of the curve at a time with at least one completion.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SurvivalStep {
    time: f64,
    at_risk: usize,
    completed: usize,
    /// Share of incomplete runs after this time.
    after: f64,
}

/// Time when runs complete. Includes the share of runs that are still incomplete after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurvivalPoint {
    /// Time, in the unit of the observations.
    pub time: f64,
    /// Number of runs under observation directly before this time, including those that never
    /// complete.
    pub at_risk: usize,
    /// Number of runs that completed at this time.
    pub completed: usize,
    /// Share of incomplete runs after this time.
    pub incomplete: f64,
    /// 95 % confidence interval of the share. `None` once all runs have completed, because the
    /// formula then has no value.
    pub interval: Option<(f64, f64)>,
}

/// Restricted mean: the mean of min(time, horizon).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RestrictedMean {
    /// Restricted mean, a lower bound of the mean, in the unit of the times.
    pub mean: f64,
    pub horizon: f64,
}

impl KaplanMeier {
    /// Estimates the curve from observations in any order. Returns `None` if there are no
    /// observations.
    pub fn new(observations: &[Observation]) -> Option<KaplanMeier> {
        let mut sorted = observations.to_vec();
        sorted.sort_by(|a, b| a.at_risk_until().total_cmp(&b.at_risk_until()));
        let last = observations.iter().map(|o| o.time).max_by(f64::total_cmp)?;
        let mut steps = Vec::new();
        let mut share = 1.0;
        let mut at_risk = sorted.len();
        for same_time in sorted.chunk_by(|a, b| a.at_risk_until() == b.at_risk_until()) {
            let completed = same_time.iter().filter(|o| o.is_completed()).count();
            if completed > 0 {
                share *= (at_risk - completed) as f64 / at_risk as f64;
                steps.push(SurvivalStep {
                    time: same_time[0].time,
                    at_risk,
                    completed,
                    after: share,
                });
            }
            at_risk -= same_time.len();
        }
        Some(KaplanMeier {
            steps,
            last,
            reach: if observations.iter().any(|o| o.status == Status::Censored) {
                last
            } else {
                f64::INFINITY
            },
        })
    }

    /// Returns the last observed time of any run, which serves as a horizon of the mean.
    pub fn last(&self) -> f64 {
        self.last
    }

    /// Returns the share of runs that are still incomplete after `time`.
    pub fn incomplete(&self, time: f64) -> f64 {
        let passed = self.steps.partition_point(|step| step.time <= time);
        passed.checked_sub(1).map_or(1.0, |i| self.steps[i].after)
    }

    /// Returns the steps of the curve with pointwise intervals.
    ///
    /// The interval is symmetric for log(-log S), so that it stays between 0 and 1. Its ends are S
    /// to the power exp(± 1.96 e), with e = sqrt(G) / |log S|. G is Greenwood's sum of d / (n (n -
    /// d)).
    ///
    /// # Source
    ///
    /// J. D. Kalbfleisch and R. L. Prentice, The Statistical Analysis of Failure Time Data, 2nd ed.
    /// 2002, section 1.4.
    pub fn curve(&self) -> Vec<SurvivalPoint> {
        let mut greenwood = 0.0;
        let point = |step: &SurvivalStep| {
            let left = step.at_risk - step.completed;
            let interval = (left > 0).then(|| {
                greenwood += step.completed as f64 / (step.at_risk as f64 * left as f64);
                let error = f64::sqrt(greenwood) / step.after.ln().abs();
                let by = (normal_quantile() * error).exp();
                (step.after.powf(by), step.after.powf(1.0 / by))
            });
            SurvivalPoint {
                time: step.time,
                at_risk: step.at_risk,
                completed: step.completed,
                incomplete: step.after,
                interval,
            }
        };
        self.steps.iter().map(point).collect()
    }

    /// Returns each completion time with the share of runs that completed then. The last item is
    /// infinity, with the share of incomplete runs.
    pub(crate) fn shares(&self) -> impl Iterator<Item = (f64, f64)> {
        let incomplete = self.steps.last().map_or(1.0, |step| step.after);
        let completed = self.steps.iter().scan(1.0, |before, step| {
            let share = *before - step.after;
            *before = step.after;
            Some((step.time, share))
        });
        completed.chain([(f64::INFINITY, incomplete)])
    }

    /// Returns the median completion time; see [`quantile`](Self::quantile).
    pub fn median(&self) -> Option<f64> {
        self.quantile(0.5)
    }

    /// Returns the time when `share` of the runs have completed. Returns `None` if the estimate
    /// never reaches this share.
    ///
    /// If the estimate equals the share between two completions, the result is the midpoint of the
    /// two times. Without censoring, the quantile of 0.5 is therefore the sample's median.
    pub fn quantile(&self, share: f64) -> Option<f64> {
        // A product of fractions differs from the exact share by rounding errors.
        const ROUNDING: f64 = 1e-12;
        let rest = 1.0 - share;
        let i = self
            .steps
            .iter()
            .position(|step| step.after <= rest + ROUNDING)?;
        let step = self.steps[i];
        match self.steps.get(i + 1) {
            Some(next) if (step.after - rest).abs() <= ROUNDING => {
                Some(0.5 * (step.time + next.time))
            }
            _ => Some(step.time),
        }
    }

    /// Returns the mean of min(time, horizon): the area under the curve up to `horizon`. If the
    /// known curve ends before `horizon`, uses this end instead. If that is infinite, uses the last
    /// observed time.
    pub(crate) fn restricted_mean(&self, horizon: f64) -> RestrictedMean {
        let horizon = self.known_until(horizon);
        let steps = &self.steps[..self.steps.partition_point(|step| step.time <= horizon)];
        // Sum from the right, in the same order as the contributions.
        let mut area = 0.0;
        let mut until = horizon;
        for step in steps.iter().rev() {
            area += step.after * (until - step.time);
            until = step.time;
        }
        RestrictedMean {
            mean: area + until,
            horizon,
        }
    }

    /// Returns the contribution of each run to the restricted mean, in the order of the
    /// observations. The plain mean of the contributions is the restricted mean. `observations`
    /// must be the observations that this estimate was made from.
    ///
    /// Without censoring the contributions are the times. With censoring they are
    /// pseudo-observations from the influence function of the estimate. The sum of their squared
    /// deviations then equals Greenwood's sum.
    ///
    /// # Source
    ///
    /// P. K. Andersen, M. G. Hansen and J. P. Klein, Lifetime Data Anal. 10 (2004), 335-350.
    pub(crate) fn contributions(&self, observations: &[Observation], horizon: f64) -> Vec<f64> {
        let horizon = self.known_until(horizon);
        let steps = &self.steps[..self.steps.partition_point(|step| step.time <= horizon)];
        let n = observations.len() as f64;
        // Reduction of the mean by a completion at each step, multiplied by the number of runs n.
        let mut loss = vec![0.0; steps.len()];
        let (mut area, mut until) = (0.0, horizon);
        for (loss, step) in loss.iter_mut().zip(steps).rev() {
            area += step.after * (until - step.time);
            until = step.time;
            if step.at_risk > step.completed {
                *loss = n * area / (step.at_risk - step.completed) as f64;
            }
        }
        let mean = area + until;
        // Expected reduction for a run that is under observation up to a step.
        let expected: Vec<f64> = (loss.iter().zip(steps))
            .scan(0.0, |sum, (loss, step)| {
                *sum += loss * step.completed as f64 / step.at_risk as f64;
                Some(*sum)
            })
            .collect();
        let contribution = |run: &Observation| {
            let passed = steps.partition_point(|step| step.time <= run.at_risk_until());
            let Some(last) = passed.checked_sub(1) else {
                return mean;
            };
            let lost = if run.is_completed() && steps[last].time == run.time {
                loss[last]
            } else {
                0.0
            };
            mean + expected[last] - lost
        };
        observations.iter().map(contribution).collect()
    }

    /// Returns the smaller of `horizon` and the end of the known curve. Returns the last observed
    /// time if both are infinite.
    fn known_until(&self, horizon: f64) -> f64 {
        let known = horizon.min(self.reach);
        if known.is_finite() { known } else { self.last }
    }

    /// Returns the end of the time range where the curve is known. Returns infinity without
    /// censoring. If the last run completed and others were censored, the curve ends at 0. The
    /// remaining times of the censored runs are then unknown.
    pub fn reach(&self) -> f64 {
        self.reach
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::statistics::observation::tests::observation;
    use crate::statistics::{Summary, median};

    /// Duration of remission of leukaemia under 6-mercaptopurine \[weeks\] (Freireich et al. 1963).
    /// The first nine times are complete, the other twelve are censored.
    const TREATED: [f64; 21] = [
        6.0, 6.0, 6.0, 7.0, 10.0, 13.0, 16.0, 22.0, 23.0, 6.0, 9.0, 10.0, 11.0, 17.0, 19.0, 20.0,
        25.0, 32.0, 32.0, 34.0, 35.0,
    ];

    fn observed() -> Vec<Observation> {
        let observations = TREATED.iter().enumerate();
        let of = |(i, &time): (usize, &f64)| {
            if i < 9 {
                Observation::completed(time)
            } else {
                Observation::censored(time)
            }
        };
        observations.map(of).collect()
    }

    fn treated() -> KaplanMeier {
        KaplanMeier::new(&observed()).unwrap()
    }

    /// Returns the standard error of the restricted mean from the contributions, by Greenwood.
    /// Without censoring it is SD / sqrt n, where the SD has n in its denominator.
    fn error(curve: &KaplanMeier, runs: &[Observation], horizon: f64) -> f64 {
        let parts = curve.contributions(runs, horizon);
        let n = parts.len() as f64;
        let mean = parts.iter().sum::<f64>() / n;
        let squares: f64 = parts.iter().map(|part| (part - mean).powi(2)).sum();
        squares.sqrt() / n
    }

    /// Returns the standard error of the restricted mean, by Greenwood's sum over the steps of the
    /// curve.
    fn greenwood(curve: &KaplanMeier, horizon: f64) -> f64 {
        let (mut area, mut variance, mut until) = (0.0, 0.0, horizon);
        for step in curve.steps.iter().rev().filter(|step| step.time <= horizon) {
            area += step.after * (until - step.time);
            until = step.time;
            let left = (step.at_risk - step.completed) as f64;
            if left > 0.0 {
                variance += area * area * step.completed as f64 / (step.at_risk as f64 * left);
            }
        }
        variance.sqrt()
    }

    /// Compares with lifelines 0.30.3: `k = KaplanMeierFitter().fit(t, e)`,
    /// `k.median_survival_time_`, `restricted_mean_survival_time(k, t=35)`. The error is
    /// Greenwood's sum in numpy.
    #[test]
    fn censored_times_agree_with_lifelines() {
        let curve = treated();
        assert_eq!(curve.median(), Some(23.0));
        let mean = curve.restricted_mean(35.0);
        assert!((mean.mean - 23.287394957983185).abs() < 1e-12);
        assert!((error(&curve, &observed(), 35.0) - 2.8274676233714393).abs() < 1e-12);
        let earlier = curve.restricted_mean(23.0);
        assert!((earlier.mean - 17.909243697478985).abs() < 1e-12);
        assert!((error(&curve, &observed(), 23.0) - 1.5531899782483798).abs() < 1e-12);
        assert!((curve.incomplete(6.0) - 18.0 / 21.0).abs() < 1e-12);
        assert_eq!(curve.incomplete(5.9), 1.0);
    }

    /// Compares with `k.confidence_interval_survival_function_` of lifelines 0.30.3, which uses the
    /// same interval.
    #[test]
    fn intervals_agree_with_lifelines() {
        let curve = treated().curve();
        let steps: Vec<_> = (curve.iter())
            .map(|point| (point.time, point.at_risk, point.completed))
            .collect();
        assert_eq!(steps[..3], [(6.0, 21, 3), (7.0, 17, 1), (10.0, 15, 1)]);
        for (point, low, high) in [
            (curve[0], 0.6197179552659838, 0.9515517476469969),
            (curve[2], 0.5031995107999564, 0.8893618351692651),
            (curve[6], 0.18805200595923233, 0.6801426284952412),
        ] {
            let (found_low, found_high) = point.interval.unwrap();
            assert!((found_low - low).abs() < 1e-12, "{point:?}");
            assert!((found_high - high).abs() < 1e-12, "{point:?}");
        }
    }

    #[test]
    fn without_runs_at_risk_there_is_no_interval() {
        let both = [1.0, 2.0].map(Observation::completed);
        let curve = KaplanMeier::new(&both).unwrap().curve();
        assert!(curve[0].interval.is_some());
        assert_eq!((curve[1].incomplete, curve[1].interval), (0.0, None));
    }

    #[test]
    fn with_all_censored_there_is_a_bound_and_no_median() {
        let curve = KaplanMeier::new(&[Observation::censored(40.0); 3]).unwrap();
        assert_eq!(curve.median(), None);
        let mean = curve.restricted_mean(f64::INFINITY);
        let error = error(&curve, &[Observation::censored(40.0); 3], f64::INFINITY);
        assert_eq!((mean.mean, error, mean.horizon), (40.0, 0.0, 40.0));
    }

    /// Checks nine completed runs, followed by censored runs. Late quantiles of this sample have
    /// only a lower bound.
    #[test]
    fn quantiles_include_censored_runs() {
        let of = |censored: &[f64]| {
            let completed = (1..=9).map(|i| Observation::completed(f64::from(i)));
            let censored = censored.iter().copied().map(Observation::censored);
            let curve = KaplanMeier::new(&completed.chain(censored).collect::<Vec<_>>()).unwrap();
            [0.1, 0.5, 0.9].map(|share| curve.quantile(share))
        };
        assert_eq!(of(&[]), [Some(1.0), Some(5.0), Some(9.0)]);
        assert_eq!(of(&[20.0]), [Some(1.5), Some(5.5), Some(9.0)]);
        assert_eq!(of(&[20.0; 2]), [Some(2.0), Some(6.0), None]);
    }

    /// Checks ten runs. Every second run is stopped at 5 because it is slow, and counts as never
    /// complete. The estimate must not assume that a stopped run would continue like the five
    /// faster runs.
    #[test]
    fn runs_that_never_complete_are_not_censored() {
        let fast = [6.0, 7.0, 8.0, 9.0, 10.0].map(Observation::completed);
        let of = |slow: Observation| {
            let runs: Vec<_> = fast.into_iter().chain([slow; 5]).collect();
            let curve = KaplanMeier::new(&runs).unwrap();
            (curve.incomplete(10.0), curve.restricted_mean(10.0).mean)
        };
        assert_eq!(of(Observation::competing(5.0)), (0.5, 9.0));
        assert_eq!(of(Observation::censored(5.0)), (0.0, 8.0));
    }

    proptest! {
        #[test]
        fn runs_that_never_complete_count_as_endless(
            runs in prop::collection::vec(observation(1..60), 1..40), horizon in 1_u32..80,
        ) {
            let known: Vec<_> = runs.into_iter().filter(|o| o.status != Status::Censored).collect();
            let Some(curve) = KaplanMeier::new(&known) else { return Ok(()) };
            let times: Vec<f64> = known.iter().map(|o| o.at_risk_until()).collect();
            let mean = curve.restricted_mean(horizon.into());
            let cut: Vec<f64> = times.iter().map(|time| time.min(mean.horizon)).collect();
            prop_assert!((mean.mean - Summary::from_values(&cut).unwrap().mean).abs() < 1e-9);
            let mut sorted = times;
            sorted.sort_by(f64::total_cmp);
            let (low, high) = (sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2]);
            // At a share of exactly one half, the quantile is the time of the last completed run.
            let plain = if high.is_finite() { f64::midpoint(low, high) } else { low };
            prop_assert_eq!(curve.median(), Some(plain).filter(|time| time.is_finite()));
        }
    }

    proptest! {
        #[test]
        fn without_censoring_it_is_the_plain_median_and_mean(
            times in prop::collection::vec(0u32..50_000, 1..60)
        ) {
            let times: Vec<f64> = times.into_iter().map(f64::from).collect();
            let observations: Vec<_> = times.iter().copied().map(Observation::completed).collect();
            let curve = KaplanMeier::new(&observations).unwrap();
            let summary = Summary::from_values(&times).unwrap();
            let mean = curve.restricted_mean(curve.last());
            prop_assert!((curve.median().unwrap() - median(&times).unwrap()).abs() < 1e-6);
            prop_assert!((mean.mean - summary.mean).abs() < 1e-6);
            let n = times.len() as f64;
            let known = summary.sd.unwrap_or(0.0) * (n - 1.0).max(0.0).sqrt() / n;
            let found = error(&curve, &observations, curve.last());
            prop_assert!((found - known).abs() < 1e-6 * known.max(1.0));
        }

        #[test]
        fn censoring_a_run_never_lowers_the_curve(
            times in prop::collection::vec(0u32..100, 1..30), which in any::<prop::sample::Index>()
        ) {
            let mut observations: Vec<_> =
                times.into_iter().map(|t| Observation::completed(f64::from(t))).collect();
            let before = KaplanMeier::new(&observations).unwrap();
            let i = which.index(observations.len());
            observations[i].status = Status::Censored;
            let after = KaplanMeier::new(&observations).unwrap();
            for t in 0..100 {
                let t = f64::from(t);
                prop_assert!(after.incomplete(t) >= before.incomplete(t) - 1e-12);
            }
        }
    }

    #[test]
    fn contributions_of_known_times_are_the_times() {
        let times = [5.0, 1.0, 4.0, 4.0, 9.0];
        let runs = times.map(Observation::completed);
        let found = KaplanMeier::new(&runs)
            .unwrap()
            .contributions(&runs, f64::INFINITY);
        for (found, time) in found.iter().zip(times) {
            assert!((found - time).abs() < 1e-12, "{found} {time}");
        }
    }

    proptest! {
        #[test]
        fn contributions_make_the_mean_and_its_error(
            runs in proptest::collection::vec(observation(1..60), 2..40),
            share in 0.2_f64..1.2,
        ) {
            let curve = KaplanMeier::new(&runs).unwrap();
            let horizon = curve.last() * share;
            let known = curve.restricted_mean(horizon);
            let parts = curve.contributions(&runs, horizon);
            let n = parts.len() as f64;
            let mean = parts.iter().sum::<f64>() / n;
            prop_assert!((mean - known.mean).abs() < 1e-9 * (1.0 + known.mean));
            let known = greenwood(&curve, known.horizon);
            let found = error(&curve, &runs, horizon);
            prop_assert!((found - known).abs() < 1e-7 * (1.0 + known));
        }
    }
}
