//! Observed times, completed or right-censored.

/// Time of a run, possibly incomplete.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Time of completion or of the last observation, in any unit; finite and not negative.
    pub time: f64,
    /// Status of the run at that time.
    pub status: Status,
}

/// Status at the time of an observation, as in survival analysis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The run completed.
    Completed,
    /// The run was stopped for an unrelated reason. The true time is longer.
    Censored,
    /// The run ended by a competing event and can never complete. The true time is infinite.
    Competing,
}

impl Observation {
    /// Returns a run that completed at `time`.
    pub const fn completed(time: f64) -> Observation {
        Observation {
            time,
            status: Status::Completed,
        }
    }

    /// Returns a run that was censored at `time`.
    pub const fn censored(time: f64) -> Observation {
        Observation {
            time,
            status: Status::Censored,
        }
    }

    /// Returns a run that ended at `time` by a competing event, so that it never completes.
    pub const fn competing(time: f64) -> Observation {
        Observation {
            time,
            status: Status::Competing,
        }
    }

    /// Returns whether the run completed.
    pub fn is_completed(self) -> bool {
        self.status == Status::Completed
    }

    /// Returns the time until which the run is under observation. Returns infinity if the run never
    /// completes.
    pub fn at_risk_until(self) -> f64 {
        match self.status {
            Status::Completed | Status::Censored => self.time,
            Status::Competing => f64::INFINITY,
        }
    }

    /// Returns the time of a completed run. Returns `None` if the run did not complete.
    pub fn completed_time(self) -> Option<f64> {
        self.is_completed().then_some(self.time)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns a strategy for random observations of all kinds, most of them completed.
    pub(crate) fn observation(times: std::ops::Range<u32>) -> impl Strategy<Value = Observation> {
        let status = prop_oneof![
            3 => Just(Status::Completed),
            1 => Just(Status::Censored),
            1 => Just(Status::Competing),
        ];
        (times, status).prop_map(|(time, status)| Observation {
            time: time.into(),
            status,
        })
    }
}
