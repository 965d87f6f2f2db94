//! How much memory the runs of an ensemble need, and how many can be made at the same time in what is allowed.
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

use stochc_ensemble::{EnsembleProgram, Manifest, unless};
use stochc_files::budget::size;
use stochc_runtime::Settings;

use super::runs;
use crate::exit::Failure;
use crate::host::Host;

/// Bytes that a table of results keeps of each run, and of each of its phases: exact medians need them.
const OF_A_RUN: u64 = 50;
const OF_A_PHASE: u64 = 4;
/// Bytes of a run while a curve is drawn: its time, in four lists, and a step of the curve, without and with its interval.
const OF_A_POINT: u64 = 160;
/// Bytes of the report that is rewritten meanwhile.
const OF_A_PAGE: u64 = 32 << 20;
/// Bytes that a piece keeps of each run.
const OF_A_PLACE: u64 = 24;
/// Ticks after which a run has about all that it needs.
const TICKS: u64 = 10;

/// What runs leave in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// What the table of an ensemble needs.
    Figures,
    /// That, and what curves of the runs so far are drawn from.
    Curves,
    /// The places in a piece of so many runs.
    Places(u64),
}

impl Kept {
    fn bytes(self, manifest: &Manifest) -> u64 {
        let of_each = |program: &EnsembleProgram| {
            let phases = program.phases().len() as u64;
            let curve = match self {
                Kept::Curves => OF_A_POINT,
                Kept::Figures | Kept::Places(_) => 0,
            };
            OF_A_RUN + OF_A_PHASE * phases + curve
        };
        match self {
            Kept::Figures | Kept::Curves => {
                let all: u64 = manifest.programs.iter().map(of_each).sum();
                let page = if self == Kept::Curves { OF_A_PAGE } else { 0 };
                all.saturating_mul(manifest.runs).saturating_add(page)
            }
            Kept::Places(runs) => runs.saturating_mul(OF_A_PLACE),
        }
    }
}

/// How many runs to make at the same time: as many as are `asked` for, or fewer if more would not fit into the `limit` \[bytes\].
///
/// # Errors
/// When not one does.
pub fn threads(
    manifest: &Manifest,
    kept: Kept,
    (asked, limit): (Option<u16>, Option<u64>),
    host: &dyn Host,
) -> Result<NonZeroUsize, Failure> {
    let asked = runs::threads(asked);
    let (Some(limit), Some(taken)) = (limit, taken()) else {
        return Ok(asked);
    };
    let (kept, run) = (kept.bytes(manifest), of_a_run(manifest, taken, host.stop()));
    let left = limit.saturating_sub(taken.saturating_add(kept));
    let most = usize::try_from(left / run.max(1)).unwrap_or(usize::MAX);
    let figures = format!(
        "{} are taken, each run under way takes {}, and {} are kept of all runs in the end",
        size(taken),
        size(run),
        size(kept)
    );
    let limit = size(limit);
    match NonZeroUsize::new(most) {
        None => Err(Failure::usage(format!(
            "`--memory {limit}` is not enough: {figures}; allow more, make fewer runs, or make them in pieces, by `--shards`"
        ))),
        Some(most) if most < asked => {
            let runs = match most.get() {
                1 => "one run is made at a time".to_owned(),
                most => format!("{most} runs are made at the same time"),
            };
            host.warn(&format!(
                "note: {runs}, not {asked}, for `--memory {limit}`: {figures}\n"
            ));
            Ok(most)
        }
        Some(_) => Ok(asked),
    }
}

/// Bytes by which the largest run of any program makes more than is `taken`, with its thread; it is begun for that.
fn of_a_run(manifest: &Manifest, taken: u64, stop: &AtomicBool) -> u64 {
    let of = |program: &EnsembleProgram| of_one(program, &manifest.settings, stop);
    let most = || manifest.programs.iter().map(of).max();
    std::thread::scope(|scope| {
        // In this thread it might find what was taken before and is free again.
        let thread = std::thread::Builder::new().spawn_scoped(scope, most);
        let most = thread.ok().and_then(|thread| thread.join().ok());
        most.flatten().unwrap_or(0).saturating_sub(taken)
    })
}

fn of_one(program: &EnsembleProgram, settings: &Settings, stop: &AtomicBool) -> u64 {
    let mut most = 0;
    let mut watch = |tick, _| {
        most = most.max(taken().unwrap_or(0));
        match tick < TICKS {
            true => unless(stop),
            false => ControlFlow::Break(()),
        }
    };
    let _ = program.run(settings, (0, 0), &mut watch);
    most
}

/// Bytes that the process has for its data, as the limit counts them; `None`: only Linux says so.
fn taken() -> Option<u64> {
    let data = stochc_files::process::status("VmData")?;
    let kilobytes: u64 = data.strip_suffix("kB")?.trim_end().parse().ok()?;
    Some(kilobytes << 10)
}
