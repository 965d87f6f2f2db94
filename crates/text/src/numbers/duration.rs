//! Text of times in seconds, also next to ticks.
use std::time::Duration;

/// Reason why a text is not a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DurationError {
    /// The text has no number or no unit.
    #[error("give a number and its unit: 90s, 10m, 2h")]
    Malformed,
    /// The duration is zero.
    #[error("the time must be above zero")]
    Zero,
}

/// Parses a time with its unit.
///
/// # Errors
///
/// If it is malformed or zero.
pub fn duration(text: &str) -> Result<Duration, DurationError> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match &text[digits.len()..] {
        "s" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(DurationError::Malformed),
    };
    let number: f64 = digits
        .trim_end()
        .parse()
        .map_err(|_| DurationError::Malformed)?;
    let time = Duration::try_from_secs_f64(number * unit).map_err(|_| DurationError::Malformed)?;
    if time.is_zero() {
        return Err(DurationError::Zero);
    }
    Ok(time)
}

/// Returns a suitable unit for a time in seconds, as its length in seconds and its symbol.
fn unit(seconds: f64) -> (f64, &'static str) {
    match seconds.abs() {
        0.0 => (1.0, "s"),
        s if s < 1e-3 => (1e-6, "us"),
        s if s < 1.0 => (1e-3, "ms"),
        _ => (1.0, "s"),
    }
}

/// Returns the number of decimals that gives a value three digits.
fn decimals(value: f64) -> usize {
    match value.abs() {
        0.0 => 0,
        v if v >= 99.95 => 0,
        v if v >= 9.995 => 1,
        _ => 2,
    }
}

/// Returns a time in a suitable unit with three digits: `21.4 ms`, `158 s`.
pub fn seconds(seconds: f64) -> String {
    let (of, unit) = unit(seconds);
    let value = seconds / of;
    format!("{value:.digits$} {unit}", digits = decimals(value))
}

/// Returns the number of decimals for printing a value and the half-width of its interval.
fn decimals_within(value: f64, half: f64) -> usize {
    /// Largest number of decimals. More decimals are not readable.
    const MAX: usize = 6;
    let shows = |&digits: &usize| (half * 10f64.powi(digits as i32)).round() > 0.0;
    let least = decimals(value);
    (least..=MAX).find(shows).unwrap_or(least)
}

/// Returns a time with the half-width of its interval, in one unit: `158 ± 21 s`.
fn seconds_within(seconds: f64, half_width: f64) -> String {
    let (of, unit) = unit(seconds);
    let (value, half) = (seconds / of, half_width / of);
    let digits = decimals_within(value, half);
    format!("{value:.digits$} ± {half:.digits$} {unit}")
}

/// Length of a tick of a scene, for the conversion of ticks to seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick(
    /// Length of a tick \[s\].
    pub f64,
);

impl Tick {
    /// Converts ticks to text in seconds: `158 s`.
    pub fn seconds(self, ticks: f64) -> String {
        seconds(ticks * self.0)
    }

    /// Converts ticks and an optional half-width to text in seconds: `158 ± 21 s`.
    pub fn interval(self, ticks: f64, half_width: Option<f64>) -> String {
        match half_width {
            None => self.seconds(ticks),
            Some(half) => seconds_within(ticks * self.0, half * self.0),
        }
    }

    /// Returns the unit of times in ticks: `ticks of 20 ms`.
    pub fn unit(self) -> String {
        let (of, unit) = unit(self.0);
        // Six digits without trailing zeros.
        let rounded = format!("{:.5e}", self.0 / of).parse::<f64>();
        format!("ticks of {} {unit}", rounded.unwrap_or(self.0 / of))
    }

    /// Converts ticks to text in seconds that follows a number of ticks: ` (158 s)`.
    pub fn beside(self, ticks: f64) -> String {
        format!(" ({})", self.seconds(ticks))
    }

    /// Converts ticks and an optional half-width to text in seconds. The text follows a number of
    /// ticks: ` (158 ± 21 s)`.
    pub fn beside_interval(self, ticks: f64, half_width: Option<f64>) -> String {
        format!(" ({})", self.interval(ticks, half_width))
    }
}

/// Returns a rounded time in words: `40 s`, `3 min`, `2 h 10 min`.
pub fn words(time: Duration) -> String {
    let seconds = time.as_secs_f64().round() as u64;
    match seconds {
        0..=89 => format!("{seconds} s"),
        90..=5399 => format!("{} min", (seconds + 30) / 60),
        _ => {
            let minutes = (seconds + 30) / 60;
            format!("{} h {} min", minutes / 60, minutes % 60)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_three_digits_in_a_suitable_unit() {
        for (value, text) in [
            (0.0, "0 s"),
            (3e-6, "3.00 us"),
            (0.021_44, "21.4 ms"),
            (1.0, "1.00 s"),
            (-12.345, "-12.3 s"),
            (158.4, "158 s"),
            (12_785.0, "12785 s"),
        ] {
            assert_eq!(seconds(value), text);
        }
    }

    #[test]
    fn seconds_follow_ticks() {
        let tick = Tick(0.02);
        assert_eq!(tick.unit(), "ticks of 20 ms");
        assert_eq!(Tick(0.1 + 0.2).unit(), "ticks of 300 ms");
        assert_eq!(tick.beside(7920.0), " (158 s)");
        assert_eq!(tick.beside_interval(7920.0, Some(1031.0)), " (158 ± 21 s)");
        assert_eq!(tick.beside_interval(160.0, Some(12.0)), " (3.20 ± 0.24 s)");
        assert_eq!(tick.beside_interval(160.0, None), " (3.20 s)");
    }

    /// Checks that the narrow interval of many runs is not printed as zero.
    #[test]
    fn a_narrow_interval_is_not_printed_as_zero() {
        let interval = |seconds, half| Tick(1.0).interval(seconds, Some(half));
        assert_eq!(interval(155.2, 0.37), "155.2 ± 0.4 s");
        assert_eq!(interval(155.2, 0.51), "155 ± 1 s");
        assert_eq!(interval(155.2, 0.04), "155.20 ± 0.04 s");
        assert_eq!(interval(15.52, 0.04), "15.52 ± 0.04 s");
        assert_eq!(interval(155.2, 0.0), "155 ± 0 s");
        assert_eq!(interval(155.2, 1e-9), "155 ± 0 s");
    }

    #[test]
    fn durations_are_written_in_words() {
        let texts = [0, 89, 90, 3600, 5400, 7800].map(|s| words(Duration::from_secs(s)));
        assert_eq!(
            texts,
            ["0 s", "89 s", "2 min", "60 min", "1 h 30 min", "2 h 10 min"]
        );
    }
}
