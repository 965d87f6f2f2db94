//! Formats percentages as text.

/// Error of a text that is not a share between 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "give a percentage between 0 and 100 with its sign, such as 5%, or a part of 1, such as 0.05"
)]
pub struct ShareError;

/// Parses a share above 0 and below 1: `5%` or `0.05`.
///
/// # Errors
///
/// If it is malformed or out of range.
pub fn share(text: &str) -> Result<f64, ShareError> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(number) => (number.trim_end(), 100.0),
        None => (text, 1.0),
    };
    let number: f64 = number.parse().map_err(|_| ShareError)?;
    let share = number / unit;
    (share > 0.0 && share < 1.0)
        .then_some(share)
        .ok_or(ShareError)
}

/// Returns a share, 0 to 1, as a percentage with at most one decimal: `5 %`, `12.5 %`, `< 0.1 %`.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent > 0.0 && percent < 0.05 {
        return "< 0.1 %".to_owned();
    }
    let text = format!("{percent:.1}");
    format!("{} %", text.strip_suffix(".0").unwrap_or(&text))
}

/// Returns a share, 0 to 1, as a percentage without decimals: `13 %`.
pub fn whole_percent(share: f64) -> String {
    format!("{} %", percent_number(share))
}

/// Returns a share as a percentage without the percent sign: `13`. The label of an axis contains
/// the sign.
pub fn percent_number(share: f64) -> String {
    format!("{:.0}", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_share_is_not_printed_as_zero() {
        let texts = [0.0, 0.0001, 0.05, 0.0996, 0.125, 1.0].map(percent);
        assert_eq!(texts, ["0 %", "< 0.1 %", "5 %", "10 %", "12.5 %", "100 %"]);
        let whole = [0.0, 0.0049, 0.126, 1.0].map(whole_percent);
        assert_eq!(whole, ["0 %", "0 %", "13 %", "100 %"]);
    }
}
