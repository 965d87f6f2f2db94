//! How long a program takes whose captures each wait for one other at most, without chance: distributions of waits are
//! added up by convolution, and of captures that are waited for side by side the latest counts.
//!
//! A time is a probability for each multiple of a step. The mean of a wait is kept as it is put onto the multiples, so that means of sums are exact;
//! quantiles, and means of what is the latest of several, are good to the second order of the step.
use rustc_hash::FxHashMap;
use stochc_rates::{Times, Wait};

use super::steps::Step;
use super::waits::CaptureWait;

/// Multiples of the step.
const POINTS: usize = 1024;

/// Different branches of a phase at most, and phases that take time, each of which takes a convolution.
const MAX: usize = 400;

/// The probability that may lie beyond the last multiple.
const BEYOND: f64 = 1e-9;

/// Ranges of multiples that are tried, each twice as long as the one before.
const TRIES: usize = 8;

/// Waits of fewer steps than this are put onto the multiples by their mean.
const SHORT: f64 = 4.0;

/// A time: its probability at each multiple of a step \[tick\].
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution {
    step: f64,
    /// From 0 on, as many as there are.
    at: Vec<f64>,
}

/// How long each phase takes, and all of them; `None`: somewhere a capture waits for more than one, or for what a released block does, a
/// phase may come to its timeout \[tick\], or there is too much of it.
pub fn exact_times(
    phases: &[Vec<Step>],
    timeouts: &[f64],
    waits: &[Option<CaptureWait>],
) -> Option<(Vec<Times>, Times)> {
    let lasting = phases.iter().filter(|steps| takes_time(steps, waits));
    if lasting.count() > MAX {
        return None;
    }
    let phases = phases.iter().zip(timeouts).map(|(steps, timeout)| {
        let phase = of_phase(steps, waits)?;
        (phase.range() <= *timeout).then_some(phase)
    });
    let phases: Vec<Distribution> = phases.collect::<Option<_>>()?;
    let times = phases.iter().map(Distribution::times).collect();
    let lasting = phases.iter().filter(|phase| phase.range() > 0.0);
    let lasting: Vec<&Distribution> = lasting.collect();
    let total = match lasting.as_slice() {
        [] => Distribution::none().times(),
        [phase] => phase.times(),
        _ => {
            let range = lasting.iter().map(|phase| phase.range()).sum::<f64>();
            let resampled = lasting.iter().map(|phase| phase.resampled(range));
            let sum = resampled.reduce(|sum, phase| sum.plus(&phase, usize::MAX));
            sum.unwrap_or_else(Distribution::none).times()
        }
    };
    Some((times, total))
}

/// Whether anything is waited for in a phase.
fn takes_time(steps: &[Step], waits: &[Option<CaptureWait>]) -> bool {
    let mut waits = steps.iter().map(|step| &waits[step.event as usize]);
    waits.any(Option::is_some)
}

fn of_phase(steps: &[Step], waits: &[Option<CaptureWait>]) -> Option<Distribution> {
    if !takes_time(steps, waits) {
        return Some(Distribution::none());
    }
    let forest = Forest::new(steps, waits)?;
    let mut range = forest.range().max(1.0);
    for _ in 0..TRIES {
        let mut found = forest.latest(range / POINTS as f64);
        if 1.0 - found.at.iter().sum::<f64>() <= BEYOND {
            let last = found.at.iter().rposition(|p| *p > BEYOND / POINTS as f64);
            found.at.truncate(last.map_or(1, |last| last + 1));
            return Some(found);
        }
        range *= 2.0;
    }
    None
}

/// The captures of a phase, where each waits for one other at most. Branches that are alike are kept once.
struct Forest {
    /// Each behind those that wait for it.
    branches: Vec<Branch>,
    roots: Vec<u32>,
}

/// A capture and all that wait for it.
#[derive(Clone, Debug, PartialEq)]
struct Branch {
    /// `None`: it takes no time.
    wait: Option<Wait>,
    /// Sorted.
    next: Vec<u32>,
}

impl Forest {
    fn new(steps: &[Step], waits: &[Option<CaptureWait>]) -> Option<Forest> {
        let place: FxHashMap<u32, usize> = (steps.iter().enumerate())
            .map(|(i, step)| (step.event, i))
            .collect();
        let mut next: Vec<Vec<u32>> = vec![Vec::new(); steps.len()];
        let mut roots = Vec::new();
        let mut known: FxHashMap<(Option<[u64; 2]>, Vec<u32>), u32> = FxHashMap::default();
        let mut branches = Vec::new();
        // What waits comes behind what it waits for.
        for (i, step) in steps.iter().enumerate().rev() {
            let Step { event, before, .. } = step;
            let of = waits[*event as usize].as_ref();
            let has_messages = step.messages.is_some();
            if has_messages || before.len() > 1 || of.is_some_and(|of| !of.head_starts.is_empty()) {
                return None;
            }
            let wait = of.map(|of| of.wait);
            let mut next_of = std::mem::take(&mut next[i]);
            next_of.sort_unstable();
            let number = *known
                .entry((wait.map(bits), next_of))
                .or_insert_with_key(|(_, next)| {
                    let next = next.clone();
                    branches.push(Branch { wait, next });
                    branches.len() as u32 - 1
                });
            if branches.len() > MAX {
                return None;
            }
            match before.first() {
                Some(before) => next[*place.get(before)?].push(number),
                None => roots.push(number),
            }
        }
        roots.sort_unstable();
        Some(Forest { branches, roots })
    }

    /// A time that it probably does not reach \[tick\].
    fn range(&self) -> f64 {
        // Of each branch, the mean and variance of its longest chain, and its longest wait.
        let mut longest: Vec<[f64; 3]> = Vec::with_capacity(self.branches.len());
        for Branch { wait, next } in &self.branches {
            let (mean, variance) = wait.map_or((0.0, 0.0), Wait::moments);
            let below = next.iter().map(|next| longest[*next as usize]);
            let [sum, spread, most] = below.fold([0.0; 3], longer);
            longest.push([mean + sum, variance + spread, most.max(mean)]);
        }
        let roots = self.roots.iter().map(|root| longest[*root as usize]);
        let [mean, variance, most] = roots.fold([0.0; 3], longer);
        // The latest of many waits is later by the logarithm of how many there are.
        let many = libm::log(1.0 + self.roots.len() as f64);
        mean + 6.0 * variance.sqrt() + most * (many + 3.0)
    }

    /// When the last of it is there.
    fn latest(&self, step: f64) -> Distribution {
        let mut done: Vec<Distribution> = Vec::with_capacity(self.branches.len());
        // Many captures have the same wait.
        let mut known: FxHashMap<[u64; 2], Distribution> = FxHashMap::default();
        for Branch { wait, next } in &self.branches {
            let rest = Distribution::latest_of(step, next, &done);
            done.push(match *wait {
                Some(wait) => {
                    let own = known.entry(bits(wait));
                    let own = own.or_insert_with(|| Distribution::new(wait, step));
                    own.plus(&rest, POINTS)
                }
                None => rest,
            });
        }
        Distribution::latest_of(step, &self.roots, &done)
    }
}

/// A wait, to be told apart from others.
pub fn bits(wait: Wait) -> [u64; 2] {
    [wait.rate, wait.docking].map(f64::to_bits)
}

fn longer(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    let [sum, spread, _] = if one[0] < other[0] { other } else { one };
    [sum, spread, one[2].max(other[2])]
}

impl Distribution {
    /// No time at all.
    fn none() -> Distribution {
        Distribution {
            step: 0.0,
            at: vec![1.0],
        }
    }

    /// Of a wait: what lies between two multiples is shared out so that the mean is kept.
    fn new(wait: Wait, step: f64) -> Distribution {
        // The mean probability to wait longer, within each step: by Gauss's rule of three points, in parts.
        const PARTS: usize = 4;
        const NODES: [(f64, f64); 3] = [
            (0.112_701_665_379_258_3, 5.0 / 18.0),
            (0.5, 8.0 / 18.0),
            (0.887_298_334_620_741_7, 5.0 / 18.0),
        ];
        let longer = |time: f64| libm::exp(-wait.cumulative_hazard(time));
        let mut means = Vec::with_capacity(POINTS);
        while means.len() < POINTS
            && means
                .last()
                .is_none_or(|last| *last > BEYOND / POINTS as f64)
        {
            let i = means.len() as f64;
            let parts = (0..PARTS)
                .flat_map(|part| NODES.map(|(x, weight)| (part as f64 + x, weight)))
                .map(|(x, weight)| weight * longer((i + x / PARTS as f64) * step));
            means.push(parts.sum::<f64>() / PARTS as f64);
        }
        // The rule sees nothing of what is over within a part of the first step.
        let mean = wait.mean();
        if mean < SHORT * step {
            means[0] = (mean / step - means[1..].iter().sum::<f64>()).clamp(0.0, 1.0);
        }
        let before = std::iter::once(1.0).chain(means.iter().copied());
        let after = means.iter().copied().chain([0.0]);
        let mut at: Vec<f64> = before
            .zip(after)
            .map(|(before, after)| before - after)
            .collect();
        // What lies beyond the last multiple is not at it.
        if means.len() == POINTS {
            at.pop();
        }
        Distribution { step, at }
    }

    /// The sum of two independent times of one step, of which so many multiples are kept.
    fn plus(&self, other: &Distribution, most: usize) -> Distribution {
        let count = (self.at.len() + other.at.len() - 1).min(most);
        let mut at = vec![0.0; count];
        let (short, long) = if self.at.len() < other.at.len() {
            (self, other)
        } else {
            (other, self)
        };
        for (i, weight) in short
            .at
            .iter()
            .enumerate()
            .filter(|(_, weight)| **weight > 0.0)
        {
            let end = count.min(i + long.at.len());
            for (sum, p) in at[i.min(end)..end].iter_mut().zip(&long.at) {
                *sum += weight * p;
            }
        }
        Distribution {
            step: self.step,
            at,
        }
    }

    /// The latest of some branches, which do not depend on each other; of none: at once.
    fn latest_of(step: f64, branches: &[u32], done: &[Distribution]) -> Distribution {
        let branches = branches.iter().map(|branch| &done[*branch as usize]);
        let count = branches.clone().map(|it| it.at.len()).max().unwrap_or(1);
        // The probability that all are there.
        let mut all = vec![1.0; count];
        for branch in branches {
            let mut there = 0.0;
            for (i, all) in all.iter_mut().enumerate() {
                there += branch.at.get(i).unwrap_or(&0.0);
                *all *= there;
            }
        }
        let mut before = 0.0;
        for all in &mut all {
            let there = *all;
            *all -= before;
            before = there;
        }
        Distribution { step, at: all }
    }

    /// The time up to its last multiple \[tick\].
    fn range(&self) -> f64 {
        self.step * self.at.len() as f64
    }

    /// The same, of the multiples of a step that goes into a range as often as is usual.
    fn resampled(&self, range: f64) -> Distribution {
        let step = range / POINTS as f64;
        let mut at = vec![0.0; POINTS + 2];
        for (i, p) in self.at.iter().enumerate() {
            let place = i as f64 * self.step / step;
            let below = (place as usize).min(POINTS);
            let part = place - below as f64;
            at[below] += p * (1.0 - part);
            at[below + 1] += p * part;
        }
        Distribution { step, at }
    }

    fn times(&self) -> Times {
        let mean = (0..)
            .zip(&self.at)
            .map(|(i, p)| f64::from(i) * p)
            .sum::<f64>();
        let at = |share| Some(self.quantile(share));
        Times {
            mean: Some(self.step * mean),
            half_width: Some(0.0),
            p10: at(0.1),
            p10_half_width: Some(0.0),
            median: at(0.5),
            median_half_width: Some(0.0),
            p90: at(0.9),
            p90_half_width: Some(0.0),
        }
    }

    /// The time before which it is over with a probability.
    fn quantile(&self, share: f64) -> f64 {
        let mut there = 0.0;
        for (i, p) in self.at.iter().enumerate() {
            // What is at a multiple lies half a step to either side of it.
            if there + p >= share && *p > 0.0 {
                let place = i as f64 - 0.5 + (share - there) / p;
                return self.step * place.max(0.0);
            }
            there += p;
        }
        self.range()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waits that are exponential, of a mean.
    fn exponential(mean: f64) -> Option<CaptureWait> {
        Some(CaptureWait {
            wait: Wait {
                rate: 1.0 / mean,
                docking: 1e-9,
            },
            free: 1.0,
            is_scarce: false,
            head_starts: Vec::new(),
        })
    }

    fn steps(before: &[&[u32]]) -> Vec<Step> {
        let steps = (0..).zip(before);
        steps
            .map(|(event, before)| Step {
                messages: None,
                event,
                before: before.to_vec(),
            })
            .collect()
    }

    fn close(found: Option<f64>, expected: f64, share: f64) {
        assert!(
            (found.unwrap() / expected - 1.0).abs() < share,
            "{found:?} instead of {expected}"
        );
    }

    /// A chain of exponential waits is gamma distributed: of five of mean 1 the quantiles are 2.4326, 4.6709 and 7.9936.
    #[test]
    fn a_chain_has_the_gamma_distribution() {
        let waits = vec![exponential(100.0); 5];
        let chain = steps(&[&[], &[0], &[1], &[2], &[3]]);
        let (phases, total) = exact_times(&[chain], &[f64::INFINITY], &waits).unwrap();
        close(total.mean, 500.0, 1e-6);
        close(total.p10, 243.26, 1e-3);
        close(total.median, 467.09, 1e-3);
        close(total.p90, 799.36, 1e-3);
        close(phases[0].mean, 500.0, 1e-6);
    }

    /// Phases that take no time change nothing, and of too many that do there is no sum.
    #[test]
    fn phases_are_added_up_unless_there_are_too_many() {
        let waits = vec![exponential(100.0); MAX + 1];
        let phases = |events: &[u32]| -> Vec<Vec<Step>> {
            let step = |&event: &u32| {
                vec![Step {
                    messages: None,
                    event,
                    before: Vec::new(),
                }]
            };
            events.iter().map(step).collect()
        };
        let total = |phases: &[Vec<Step>]| {
            let timeouts = vec![f64::INFINITY; phases.len()];
            exact_times(phases, &timeouts, &waits).map(|(_, total)| total)
        };
        let five = phases(&[0, 1, 2, 3, 4]);
        let empty = || (0..3).map(|_| Vec::new());
        let among_empty = (phases(&[0, 1, 2]).into_iter())
            .chain(empty())
            .chain(phases(&[3, 4]))
            .collect::<Vec<_>>();
        assert_eq!(total(&among_empty), total(&five));
        close(total(&five).unwrap().mean, 500.0, 1e-3);
        assert_eq!(total(&empty().collect::<Vec<_>>()).unwrap().mean, Some(0.0));
        let all: Vec<u32> = (0..=MAX as u32).collect();
        assert!(total(&phases(&all[1..])).is_some());
        assert!(total(&phases(&all)).is_none());
    }

    /// The latest of n exponential waits has the mean 1 + 1/2 + ... + 1/n.
    #[test]
    fn the_latest_of_many_has_the_harmonic_mean() {
        for n in [2_u32, 10, 300] {
            let waits = vec![exponential(100.0); n as usize];
            let none: Vec<&[u32]> = vec![&[]; n as usize];
            let (_, total) = exact_times(&[steps(&none)], &[f64::INFINITY], &waits).unwrap();
            let harmonic: f64 = (1..=n).map(|i| 1.0 / f64::from(i)).sum();
            close(total.mean, 100.0 * harmonic, 2e-4);
            let median = -libm::log1p(-libm::pow(0.5, 1.0 / f64::from(n)));
            close(total.median, 100.0 * median, 1e-3);
        }
    }

    /// Of a wait and then the latest of two, the mean is the sum of the means, however short one is beside the others.
    #[test]
    fn phases_and_branches_of_all_lengths_add_up() {
        let waits = vec![
            exponential(3.0),
            exponential(500.0),
            exponential(500.0),
            exponential(0.5),
            exponential(2000.0),
        ];
        let branch = steps(&[&[], &[0], &[0]]);
        let mut later = steps(&[&[], &[0]]);
        later[0].event = 3;
        later[1] = Step {
            messages: None,
            event: 4,
            before: vec![3],
        };
        let (phases, total) = exact_times(&[branch, later], &[f64::INFINITY; 2], &waits).unwrap();
        close(phases[0].mean, 3.0 + 750.0, 1e-4);
        close(phases[1].mean, 2000.5, 1e-4);
        close(total.mean, 2753.5, 1e-4);
    }

    #[test]
    fn the_mean_of_a_wait_with_a_docking_time_is_kept() {
        let wait = Wait {
            rate: 1.0 / 300.0,
            docking: 200.0,
        };
        let waits = vec![
            Some(CaptureWait {
                wait,
                free: 1.0,
                is_scarce: false,
                head_starts: Vec::new(),
            });
            3
        ];
        let (_, total) =
            exact_times(&[steps(&[&[], &[0], &[1]])], &[f64::INFINITY], &waits).unwrap();
        close(total.mean, 3.0 * wait.mean(), 1e-4);
    }

    #[test]
    fn joins_and_timeouts_that_may_come_are_left_to_others() {
        let waits = vec![exponential(100.0); 3];
        let of = |steps: Vec<Step>, timeout| exact_times(&[steps], &[timeout], &waits);
        assert_eq!(of(steps(&[&[], &[], &[0, 1]]), f64::INFINITY), None);
        let chain = || steps(&[&[], &[0], &[1]]);
        assert_eq!(of(chain(), 1000.0), None);
        assert_eq!(of(chain(), 1e6), of(chain(), f64::INFINITY));
        assert!(of(chain(), 1e6).is_some());
    }
}
