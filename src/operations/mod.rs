//! What commands do, for any [`Host`](crate::host::Host): programs of files, ensembles, pieces, pages.
//!
//! The command line reads options and prints; other programs give the same values and get the same folders, byte for byte.
pub mod chosen_run;
pub mod codes;
pub mod ensemble;
pub mod estimate;
pub mod export;
pub mod in_memory;
pub mod plan;
pub mod programs;
pub mod rates;
mod recordings;
pub mod replay;
pub mod report;
pub mod results;
pub mod runs;
pub mod scene_warnings;
pub mod shard;
pub mod sweep;
pub mod trade;

use std::time::Duration;

/// A time with its unit.
///
/// # Errors
/// In words, if it is none.
pub fn time(text: &str) -> Result<Duration, String> {
    let wrong = || "give a number and its unit: 90s, 10m, 2h".to_owned();
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match &text[digits.len()..] {
        "s" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(wrong()),
    };
    let number: f64 = digits.trim_end().parse().map_err(|_| wrong())?;
    let time = Duration::try_from_secs_f64(number * unit).map_err(|_| wrong())?;
    if time.is_zero() {
        return Err("no time is too little".to_owned());
    }
    Ok(time)
}
