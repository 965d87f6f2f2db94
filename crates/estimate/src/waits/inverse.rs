//! Fast inverse of the cumulative hazard, approximate or with bounds: a few multiplications instead
//! of Newton steps with an exponential each.
use std::sync::LazyLock;

use crate::waits::docking_time::{docked, when_summed};

/// Number of leading mantissa bits that select a part of the table.
const PART_BITS: u32 = 5;

/// Number of low mantissa bits, which locate a value within its part.
const WITHIN_BITS: u32 = f64::MANTISSA_DIGITS - 1 - PART_BITS;

/// Smallest value of the table. Smaller values need Newton steps.
const MIN: f64 = 1.0 / 128.0;

/// Largest value of the table. For larger values, all arrived blocks have docked.
const MAX: f64 = 8.0;

const PARTS: usize = part(MAX) - part(MIN);

/// Bound of the relative error: thirty times the largest actual error.
const ERROR: f64 = 1e-7;

/// Value beyond which the spacing of doubles exceeds [`ERROR`].
const HUGE: f64 = 1e6;

/// Polynomial of each part.
static CUBICS: LazyLock<[[f64; 4]; PARTS]> =
    LazyLock::new(|| std::array::from_fn(|number| cubic(part(MIN) + number)));

/// Returns a lower and an upper bound of [`when_summed`].
pub(crate) fn bounds(value: f64) -> (f64, f64) {
    if (MIN..HUGE).contains(&value) {
        let time = about_when_summed(value);
        (time * (1.0 - ERROR), time * (1.0 + ERROR))
    } else {
        let time = when_summed(value);
        (time, time)
    }
}

/// Returns [`when_summed`] with the relative error [`ERROR`].
pub(crate) fn about_when_summed(value: f64) -> f64 {
    if (MIN..MAX).contains(&value) {
        near(value)
    } else if (MAX..HUGE).contains(&value) {
        // All arrived blocks have docked.
        value + 1.0
    } else {
        when_summed(value)
    }
}

/// Approximates [`when_summed`] for a value of the table.
fn near(value: f64) -> f64 {
    let [a, b, c, d] = CUBICS[part(value) - part(MIN)];
    let within = value.to_bits() & ((1 << WITHIN_BITS) - 1);
    let one_and = f64::from_bits(1.0_f64.to_bits() | within << PART_BITS);
    let u = one_and - 1.0;
    a + u * (b + u * (c + u * d))
}

/// Returns the index of a value's part.
const fn part(value: f64) -> usize {
    (value.to_bits() >> WITHIN_BITS) as usize
}

/// Returns the smallest value of a part.
fn begin(part: usize) -> f64 {
    f64::from_bits((part as u64) << WITHIN_BITS)
}

/// Returns the Hermite cubic from the times and slopes at both ends of a part. The variable of the
/// polynomial runs from 0 to 1.
fn cubic(part: usize) -> [f64; 4] {
    let ends = [begin(part), begin(part + 1)];
    let [from, to] = ends.map(when_summed);
    let [first, last] = [from, to].map(|time| (ends[1] - ends[0]) / docked(time));
    let rise = to - from;
    [
        from,
        first,
        3.0 * rise - 2.0 * first - last,
        first + last - 2.0 * rise,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_much_better_than_its_bounds() {
        let values = (0..200_000).map(|i| MIN + (MAX - MIN) * f64::from(i) / 200_000.0);
        let error = |value| (near(value) / when_summed(value) - 1.0).abs();
        let most = values.map(error).fold(0.0, f64::max);
        assert!(most < ERROR / 30.0, "{most}");
    }

    #[test]
    fn times_are_within_their_bounds() {
        let mut value = 1e-12;
        while value < 1e12 {
            let (low, high) = bounds(value);
            let time = when_summed(value);
            let about = about_when_summed(value);
            assert!(
                (about - time).abs() <= ERROR * time,
                "{value}: {about} {time}"
            );
            assert!(low <= time && time <= high, "{value}: {low} {time} {high}");
            value *= 1.0001;
        }
        assert_eq!(bounds(0.0), (0.0, 0.0));
        assert_eq!(bounds(f64::INFINITY), (f64::INFINITY, f64::INFINITY));
    }
}
