//! Many times in little memory.
use super::Observation;

/// Times in the order in which they were told: 4 bytes for each while all of them are whole and short, as ticks mostly are.
#[derive(Clone, Debug)]
pub struct TimeSample(StoredTimes);

#[derive(Clone, Debug)]
enum StoredTimes {
    /// Twice the time, and one more if it is censored.
    Short(Vec<u32>),
    /// The time, with a minus if it is censored.
    Any(Vec<f64>),
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
            self.0 = StoredTimes::Any(times.iter().map(|&short| signed(long(short))).collect());
        }
        if let StoredTimes::Any(times) = &mut self.0 {
            times.push(signed(observation));
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match &self.0 {
            StoredTimes::Short(times) => times.len(),
            StoredTimes::Any(times) => times.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Each time.
    pub fn iter(&self) -> impl Iterator<Item = Observation> {
        let (shorts, others): (&[u32], &[f64]) = match &self.0 {
            StoredTimes::Short(times) => (times, &[]),
            StoredTimes::Any(times) => (&[], times),
        };
        let others = others.iter().map(|&time| Observation {
            time: time.abs(),
            completed: time.is_sign_positive(),
        });
        shorts.iter().map(|&short| long(short)).chain(others)
    }

    /// All of them, for as long as somebody works with them.
    pub fn to_vec(&self) -> Vec<Observation> {
        self.iter().collect()
    }
}

fn short(observation: Observation) -> Option<u32> {
    let time = observation.time;
    let is_short = time.fract() == 0.0 && (0.0..f64::from(1 << 30)).contains(&time);
    is_short.then(|| (time as u32) << 1 | u32::from(!observation.completed))
}

fn long(short: u32) -> Observation {
    Observation {
        time: f64::from(short >> 1),
        completed: short & 1 == 0,
    }
}

fn signed(observation: Observation) -> f64 {
    match observation.completed {
        true => observation.time.abs(),
        false => -observation.time.abs(),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn observation() -> impl Strategy<Value = Observation> {
        let time = prop_oneof![(0u32..=u32::MAX).prop_map(f64::from), 0.0..1e300, Just(0.0),];
        let both = (time, proptest::bool::ANY);
        both.prop_map(|(time, completed)| Observation { time, completed })
    }

    proptest! {
        #[test]
        fn what_goes_in_comes_out(times in prop::collection::vec(observation(), 0..40)) {
            let mut sample = TimeSample::default();
            for &time in &times {
                sample.push(time);
            }
            prop_assert_eq!(sample.len(), times.len());
            prop_assert_eq!(sample.to_vec(), times);
        }
    }
}
