//! Measures the number of events per second of tables without physics. Arguments: `[CAPTURES
//! [REPEATS]]`.
//!
//! The programs are towers of ten on a square plate. One program only builds the towers. The other
//! one also releases them, which sends a message for each release. Events are counted as in a
//! replay. They are faces switched on, captures, releases, hops of messages, reports counted by the
//! plate, and phases. Times are the shortest of several runs, from the tables to the record.
//! Without arguments the sizes are 10^3 to 10^6 captures.
#![allow(missing_docs, reason = "a command, not a library")]
#![expect(clippy::disallowed_methods, reason = "a benchmark needs a clock")]

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use stochc_compiler::{Checked, Limits, check};
use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::PhaseId;
use stochc_runtime::{Model, Settings, run};

/// Number of captures in each tower.
const HEIGHT: usize = 10;

/// Total time after which the measurement of a size stops. At least one run is measured.
const ENOUGH: Duration = Duration::from_secs(2);

fn main() {
    let numbers: Vec<usize> = std::env::args()
        .skip(1)
        .filter_map(|word| word.parse().ok())
        .collect();
    let repeats = numbers.get(1).copied().unwrap_or(usize::MAX).max(1);
    let sizes = match numbers.first() {
        Some(&captures) => vec![captures],
        None => vec![1_000, 10_000, 100_000, 1_000_000],
    };
    println!(
        "| program | captures | releases | hops | events | million events a second | ns a capture or release |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, down) in [
        ("build", ""),
        (
            "build, take down",
            "    phase clear { for y in 0..LAST { for x in 0..LAST { for i in 1..HEIGHT { release t[x, y].T[i] } } } }\n",
        ),
    ] {
        for &captures in &sizes {
            let checked = towers(captures, down);
            let (time, record) = measure(&checked, repeats);
            let (bonds, releases) = (record.bonds.len(), record.releases.len());
            let events = events(&checked, &record);
            let ns = time.as_secs_f64() * 1e9;
            println!(
                "| {name} | {bonds} | {releases} | {} | {events} | {:.2} | {:.0} |",
                record.hops,
                1e3 * events as f64 / ns,
                ns / (bonds + releases) as f64,
            );
        }
    }
}

/// Returns the number of events that a replay of a complete run would list. Every open face has
/// captured a block.
fn events(checked: &Checked, record: &RunRecord) -> u64 {
    let tables = checked.programs[0].tables.as_ref();
    let phases = &tables.expect("the program is valid").phases;
    let reports: u32 = phases.iter().map(|phase| phase.reports).sum();
    let of_blocks = 2 * record.bonds.len() + record.releases.len() + phases.len();
    of_blocks as u64 + record.hops + u64::from(reports)
}

/// Returns the shortest time of a run, and its record.
fn measure(checked: &Checked, repeats: usize) -> (Duration, RunRecord) {
    let program = &checked.programs[0];
    let tables = program.tables.as_ref().expect("the program is valid");
    let scene = program.scene.as_ref().expect("the program is valid");
    let settings = Settings::new(Model::Shuffle, 1);
    let mut proceed = |_, _: PhaseId| ControlFlow::Continue(());
    let mut best: Option<(Duration, RunRecord)> = None;
    let began = Instant::now();
    for number in 0..repeats {
        let start = Instant::now();
        let record =
            run(tables, scene, &settings, 1, 0, &mut proceed).expect("the run is not cancelled");
        let time = start.elapsed();
        assert_eq!(record.outcome, Outcome::Completed);
        if best.as_ref().is_none_or(|(shortest, _)| time < *shortest) {
            best = Some((time, record));
        }
        if number > 0 && began.elapsed() > ENOUGH {
            break;
        }
    }
    best.expect("it is measured once at least")
}

/// Returns a checked program that builds about `captures` captures in towers. The statements `down`
/// follow.
fn towers(captures: usize, down: &str) -> Checked {
    let edge = ((captures / HEIGHT) as f64).sqrt().round().max(1.0) as usize;
    let (last, blocks, radius) = (edge - 1, edge * edge * HEIGHT, edge + 20);
    let down = down.replace("LAST", &last.to_string());
    let down = down.replace("HEIGHT", &HEIGHT.to_string());
    let text = format!(
        "scene vast from hemisphere {{
    free {blocks} uniform
    enclosure hemisphere {{ radius {radius}m  wall 25 N/m }}
}}
pattern tower(base) {{
    base.up ->> T[1..{HEIGHT}]
}}
assembly towers in vast {{
    seed plate {edge} x {edge} {{
        for y in 0..{last} {{ for x in 0..{last} {{ S[x, y] at (x, y) }} }}
    }}
    phase build {{
        for y in 0..{last} {{ for x in 0..{last} {{ tower(S[x, y]) as t[x, y] }} }}
    }}
{down}}}
"
    );
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let limits = Limits {
        events: usize::MAX,
        ..Limits::default()
    };
    let checked = check("towers.sa", &mut reader, limits);
    assert!(!checked.has_errors(), "{:?}\n{text}", checked.diagnostics);
    checked
}
