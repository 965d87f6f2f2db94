//! Compact list of times.
use super::{Observation, Status};

/// Times in the order of insertion. Uses 4 bytes per time if all times are small multiples of 1/4,
/// as ticks usually are.
#[derive(Clone, Debug)]
pub struct TimeSample(StoredTimes);

#[derive(Clone, Debug)]
enum StoredTimes {
    /// Each element is four times the time, plus the number of the status.
    Short(Vec<u32>),
    Any(Vec<f64>, Vec<Status>),
}

impl Default for TimeSample {
    fn default() -> TimeSample {
        TimeSample(StoredTimes::Short(Vec::new()))
    }
}

impl TimeSample {
    /// Adds a time.
    pub fn push(&mut self, observation: Observation) {
        if let StoredTimes::Short(times) = &mut self.0 {
            if let Some(short) = short(observation) {
                times.push(short);
                return;
            }
            let all = times.iter().copied().map(long);
            self.0 = StoredTimes::Any(
                all.clone().map(|it| it.time).collect(),
                all.map(|it| it.status).collect(),
            );
        }
        if let StoredTimes::Any(times, statuses) = &mut self.0 {
            times.push(observation.time);
            statuses.push(observation.status);
        }
    }

    /// Returns the number of times.
    pub fn len(&self) -> usize {
        match &self.0 {
            StoredTimes::Short(times) => times.len(),
            StoredTimes::Any(times, _) => times.len(),
        }
    }

    /// Returns whether the sample is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns an iterator over the times in order.
    pub fn iter(&self) -> impl Iterator<Item = Observation> {
        let (shorts, times, statuses): (&[u32], &[f64], &[Status]) = match &self.0 {
            StoredTimes::Short(times) => (times, &[], &[]),
            StoredTimes::Any(times, statuses) => (&[], times, statuses),
        };
        let others = times.iter().zip(statuses);
        let others = others.map(|(&time, &status)| Observation { time, status });
        shorts.iter().copied().map(long).chain(others)
    }

    /// Returns all times as a list.
    pub fn to_vec(&self) -> Vec<Observation> {
        self.iter().collect()
    }
}

/// Statuses, indexed by their number.
const STATUSES: [Status; 3] = [Status::Completed, Status::Censored, Status::Competing];

fn short(observation: Observation) -> Option<u32> {
    let time = observation.time;
    let is_short = time.fract() == 0.0 && (0.0..f64::from(1 << 30)).contains(&time);
    is_short.then_some((time as u32) << 2 | observation.status as u32)
}

fn long(short: u32) -> Observation {
    Observation {
        time: f64::from(short >> 2),
        status: STATUSES[(short & 3) as usize],
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn observation() -> impl Strategy<Value = Observation> {
        let time = prop_oneof![(0u32..=u32::MAX).prop_map(f64::from), 0.0..1e300, Just(0.0),];
        let both = (time, prop::sample::select(&STATUSES));
        both.prop_map(|(time, status)| Observation { time, status })
    }

    proptest! {
        #[test]
        fn returns_the_added_values(times in prop::collection::vec(observation(), 0..40)) {
            let mut sample = TimeSample::default();
            for &time in &times {
                sample.push(time);
            }
            prop_assert_eq!(sample.len(), times.len());
            prop_assert_eq!(sample.to_vec(), times);
        }
    }
}
