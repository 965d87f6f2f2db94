//! When a summed hazard comes to a value, nearly, or within bounds: that takes a few multiplications instead of some steps of
//! Newton's, each with an exponential.
use std::sync::LazyLock;

use crate::docking_time::{docked, when_summed};

/// Parts of each binade of values, by the leading bits of their mantissas.
const PART_BITS: u32 = 5;

/// The bits of a value that say where in its part it is.
const WITHIN_BITS: u32 = f64::MANTISSA_DIGITS - 1 - PART_BITS;

/// The values of the table; larger ones need none.
const MIN: f64 = 1.0 / 128.0;
const MAX: f64 = 8.0;

/// Parts between them.
const PARTS: usize = part(MAX) - part(MIN);

/// By how much the table may be off, of itself: thirty times what it is.
const ERROR: f64 = 1e-7;

/// Of values from here on, single bits are larger than that.
const HUGE: f64 = 1e6;

/// A polynomial for each part.
static CUBICS: LazyLock<[[f64; 4]; PARTS]> =
    LazyLock::new(|| std::array::from_fn(|number| cubic(part(MIN) + number)));

/// Bounds of [`when_summed`].
pub(crate) fn bounds(value: f64) -> (f64, f64) {
    if (MIN..HUGE).contains(&value) {
        let time = about_when_summed(value);
        (time * (1.0 - ERROR), time * (1.0 + ERROR))
    } else {
        let time = when_summed(value);
        (time, time)
    }
}

/// [`when_summed`], to [`ERROR`] of itself.
pub(crate) fn about_when_summed(value: f64) -> f64 {
    if (MIN..MAX).contains(&value) {
        near(value)
    } else if (MAX..HUGE).contains(&value) {
        // Nobody is left who has come and not docked.
        value + 1.0
    } else {
        when_summed(value)
    }
}

/// About [`when_summed`], of a value of the table.
fn near(value: f64) -> f64 {
    let [a, b, c, d] = CUBICS[part(value) - part(MIN)];
    let within = value.to_bits() & ((1 << WITHIN_BITS) - 1);
    let one_and = f64::from_bits(1.0_f64.to_bits() | within << PART_BITS);
    let u = one_and - 1.0;
    a + u * (b + u * (c + u * d))
}

/// The number of a value's part, from 0 on.
const fn part(value: f64) -> usize {
    (value.to_bits() >> WITHIN_BITS) as usize
}

/// The least value of a part.
fn begin(part: usize) -> f64 {
    f64::from_bits((part as u64) << WITHIN_BITS)
}

/// With the times and slopes of both ends of a part (C. Hermite 1878); its variable grows from 0 to 1.
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
