//! Forecasts of the CPU time of runs.
use stochc_results::{CpuForecast, EnsembleProgram, Manifest, forecast_cpu_time};
use stochc_runtime::rates::{Rates, estimate};
use stochc_text::words;

use super::in_memory::stopped;
use super::runs::{threads as default_threads, try_out_all};
use crate::exit::Failure;
use crate::host::Host;

/// Forecasts the CPU time of an ensemble. The forecast itself takes about a second.
///
/// # Errors
/// If a scene cannot be set up, or the user interrupts.
pub fn cpu_time(manifest: &Manifest, host: &dyn Host) -> Result<CpuForecast, Failure> {
    try_out_all(manifest)?;
    let forecast = forecast_cpu_time(manifest, expected_ticks, host.stop());
    forecast.ok_or_else(|| stopped("nothing was simulated"))
}

/// Returns the mean completion time in the rate model \[ticks\]. Returns `None` if the scene has no
/// rates.
fn expected_ticks(program: &EnsembleProgram) -> Option<f64> {
    let rates = Rates::known_or_guessed(&[], &program.scene)?;
    estimate(program.parts(), Some(&rates))?.total?.mean
}

/// Returns a forecast as one line of text, for example `576 runs, about 30 s of CPU time (15 s on 2
/// threads)`.
pub fn forecast_to_text(forecast: &CpuForecast, threads: Option<u16>) -> String {
    let about = if forecast.is_lower_bound {
        "at least"
    } else {
        "about"
    };
    let threads = default_threads(threads).get() as u32;
    let runs = match forecast.runs {
        1 => "1 run".to_owned(),
        runs => format!("{runs} runs"),
    };
    let on_threads = match threads {
        1 => String::new(),
        _ => format!(" ({} on {threads} threads)", words(forecast.time / threads)),
    };
    format!(
        "{runs}, {about} {} of CPU time{on_threads}\n",
        words(forecast.time)
    )
}
