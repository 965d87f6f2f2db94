//! Scales that convert values to positions.

/// Conversion from a range of values to a range of positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    values: (f64, f64),
    positions: (f64, f64),
    logarithmic: bool,
}

impl Scale {
    /// Creates a linear scale. Equal ends are moved apart.
    pub fn linear(values: (f64, f64), positions: (f64, f64)) -> Scale {
        let values = if values.1 > values.0 {
            values
        } else {
            // The distance is large enough to change the number in spite of rounding.
            (values.0, values.0 + values.0.abs().max(1.0))
        };
        Scale {
            values,
            positions,
            logarithmic: false,
        }
    }

    /// Creates a logarithmic scale. Both ends must be positive.
    pub fn logarithmic(values: (f64, f64), positions: (f64, f64)) -> Scale {
        let values = if values.1 > values.0 {
            values
        } else {
            (values.0 / 2.0, values.0 * 2.0)
        };
        Scale {
            values,
            positions,
            logarithmic: true,
        }
    }

    pub fn is_logarithmic(&self) -> bool {
        self.logarithmic
    }

    /// Returns the position of a value. Values outside of the ends are moved to the nearest end.
    pub fn at(&self, value: f64) -> f64 {
        let (from, to) = self.values;
        let value = value.clamp(from, to);
        let share = if self.logarithmic {
            (value / from).ln() / (to / from).ln()
        } else {
            (value - from) / (to - from)
        };
        self.positions.0 + (self.positions.1 - self.positions.0) * share
    }

    /// Returns about `n` round values for the ticks of an axis.
    pub fn ticks(&self, n: usize) -> Vec<f64> {
        let (from, to) = self.values;
        if self.logarithmic && to / from > 10.0 {
            let decades = from.log10().floor() as i32..=to.log10().ceil() as i32;
            let digits: &[f64] = if to / from > 1e3 {
                &[1.0]
            } else {
                &[1.0, 2.0, 5.0]
            };
            let all = decades
                .flat_map(|decade| digits.iter().map(move |digit| digit * 10f64.powi(decade)));
            let all: Vec<f64> = all.filter(|tick| (from..=to).contains(tick)).collect();
            let every = all.len().div_ceil(2 * n.max(1)).max(1);
            return all.into_iter().step_by(every).collect();
        }
        let step = round_up((to - from) / n.max(1) as f64);
        let first = (from / step - 1e-9).ceil() as i64;
        let last = (to / step + 1e-9).floor() as i64;
        (first..=last).map(|i| i as f64 * step).collect()
    }
}

/// Rounds a positive step up to 1, 2 or 5 times a power of ten.
fn round_up(step: f64) -> f64 {
    let decade = 10f64.powf(step.log10().floor());
    let digits = [1.0, 2.0, 5.0, 10.0].into_iter();
    let mut fitting = digits.map(|digit| digit * decade);
    fitting
        .find(|round| *round >= step * (1.0 - 1e-9))
        .unwrap_or(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within() {
        let scale = Scale::linear((0.0, 7300.0), (0.0, 100.0));
        assert_eq!(scale.ticks(5), [0.0, 2000.0, 4000.0, 6000.0]);
        assert_eq!(scale.at(3650.0), 50.0);
        assert_eq!(scale.at(9000.0), 100.0);
        let scale = Scale::logarithmic((1.0, 100.0), (0.0, 10.0));
        assert_eq!(scale.ticks(5), [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
        assert!((scale.at(10.0) - 5.0).abs() < 1e-12);
        let scale = Scale::logarithmic((1e-100, 1e100), (0.0, 10.0));
        assert!((3..=10).contains(&scale.ticks(5).len()));
        // Equal ends must not cause an endless number of ticks.
        assert!(Scale::linear((3.0, 3.0), (0.0, 1.0)).ticks(4).len() < 9);
        // Adding 1 does not change this number.
        assert_eq!(Scale::linear((1e17, 1e17), (0.0, 1.0)).at(1e17), 0.0);
    }
}
