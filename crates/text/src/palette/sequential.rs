//! Sequential colour scale: lighter colours for larger amounts.
//!
//! Ten evenly spaced colours of viridis. Their lightness increases evenly, so the scale is readable
//! in grey and with colour blindness.
//!
//! # Source
//!
//! S. van der Walt and N. Smith (2015), public domain.
use super::Rgb;

const VIRIDIS: [Rgb; 10] = [
    Rgb(0x44, 0x01, 0x54),
    Rgb(0x48, 0x28, 0x78),
    Rgb(0x3e, 0x4a, 0x89),
    Rgb(0x31, 0x68, 0x8e),
    Rgb(0x26, 0x82, 0x8e),
    Rgb(0x1f, 0x9e, 0x89),
    Rgb(0x35, 0xb7, 0x79),
    Rgb(0x6d, 0xcd, 0x59),
    Rgb(0xb4, 0xde, 0x2c),
    Rgb(0xfd, 0xe7, 0x25),
];

/// Returns the colour of a fraction from 0 to 1. Values outside are clamped.
pub fn sequential(share: f64) -> Rgb {
    let last = VIRIDIS.len() - 1;
    let place = share.clamp(0.0, 1.0) * last as f64;
    // NaN counts as 0.
    let first = (place as usize).min(last - 1);
    let within = if place.is_nan() {
        0.0
    } else {
        place - first as f64
    };
    let (from, to) = (VIRIDIS[first], VIRIDIS[first + 1]);
    let between = |from: u8, to: u8| {
        (f64::from(from) + within * (f64::from(to) - f64::from(from))).round() as u8
    };
    Rgb(
        between(from.0, to.0),
        between(from.1, to.1),
        between(from.2, to.2),
    )
}
