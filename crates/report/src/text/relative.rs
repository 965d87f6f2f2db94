//! Relative differences as percentages.
use stochc_experiments::statistics::Relative;

/// Returns a relative difference with the half-width of its interval, such as `-4.0 ± 3.1 %`.
pub fn relative(difference: &Relative) -> String {
    let value = 100.0 * difference.value;
    match difference.half_width {
        Some(half_width) => format!("{value:.1} ± {:.1} %", 100.0 * half_width),
        None => format!("{value:.1} ± ? %"),
    }
}

/// Returns the absolute value of a relative difference, such as `4.0 ± 3.1 %`.
pub(crate) fn relative_size(difference: &Relative) -> String {
    relative(&Relative {
        value: difference.value.abs(),
        ..*difference
    })
}
