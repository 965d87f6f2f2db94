//! Measures the cost of checking a large program. Arguments: `[CAPTURES [REPEATS]]`.
//!
//! Two programs with the same structure, towers of four on a square plate, are read, checked and
//! lowered. One program is flat, the other uses nested patterns and loops. Times are medians of
//! several runs. They are divided by the time that pest alone takes to parse the same text with the
//! grammar's `program` rule. Memory is the memory in use at the end of each stage, without the text
//! itself. Without arguments the sizes are 10^3 to 10^6 captures.
#![allow(missing_docs, reason = "a command, not a library")]
#![expect(clippy::disallowed_methods, reason = "a benchmark needs a clock")]

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use peak_alloc::PeakAlloc;
use stochc_compiler::{Checked, Limits, LintLevels, Stage, check_observed};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Number of captures in each tower.
const HEIGHT: usize = 4;

const STAGES: [Stage; 9] = [
    Stage::Parse,
    Stage::Expand,
    Stage::Names,
    Stage::Layout,
    Stage::Graph,
    Stage::Order,
    Stage::Reach,
    Stage::Compare,
    Stage::Lower,
];

fn main() {
    let numbers: Vec<usize> = std::env::args()
        .skip(1)
        .filter_map(|word| word.parse().ok())
        .collect();
    let repeats = numbers.get(1).copied().unwrap_or(5).max(1);
    let sizes = match numbers.first() {
        Some(&captures) => vec![captures],
        None => vec![1_000, 10_000, 100_000, 1_000_000],
    };
    let mut bare = Vec::new();
    for (name, generate) in [("flat", flat as fn(usize) -> String), ("nested", nested)] {
        println!(
            "\n{name}: time as a ratio to the bare parse of the flat text, bytes held for each capture\n"
        );
        println!(
            "| captures | text | bare parse of it | {} | check | at the end | at the peak |",
            STAGES
                .map(|stage| format!("{stage:?}").to_lowercase())
                .join(" | ")
        );
        println!("|{}", "---|".repeat(STAGES.len() + 6));
        for (i, &captures) in sizes.iter().enumerate() {
            let edge = ((captures / HEIGHT) as f64).sqrt().round().max(1.0) as usize;
            let text = generate(edge);
            let own = bare_parse(&text, repeats);
            if name == "flat" {
                bare.push(own);
            }
            report(edge * edge * HEIGHT, &text, own, bare[i], repeats);
        }
    }
}

fn bare_parse(text: &str, repeats: usize) -> Duration {
    median((0..repeats).map(|_| {
        let start = Instant::now();
        assert!(stochc_grammar::accepts(text));
        start.elapsed()
    }))
}

fn report(captures: usize, text: &str, own: Duration, bare: Duration, repeats: usize) {
    let runs: Vec<Measured> = (0..repeats).map(|_| measure(text)).collect();
    let ratio = |time: Duration| time.as_secs_f64() / bare.as_secs_f64();
    let stages: Vec<String> = (0..STAGES.len())
        .map(|stage| {
            let time = median(runs.iter().map(|run| run.stages[stage].0));
            let held = runs[0].stages[stage].1 / captures;
            format!("{:.2}, {held} B", ratio(time))
        })
        .collect();
    let total = median(runs.iter().map(|run| run.total));
    println!(
        "| {captures} | {:.1} kB | {:.2} ms | {} | {:.2} | {} B | {} B |",
        text.len() as f64 / 1e3,
        own.as_secs_f64() * 1e3,
        stages.join(" | "),
        ratio(total),
        runs[0].held / captures,
        runs[0].peak / captures,
    );
}

struct Measured {
    /// Time of each stage, and the memory in use at its end \[bytes\].
    stages: Vec<(Duration, usize)>,
    total: Duration,
    held: usize,
    peak: usize,
}

fn measure(text: &str) -> Measured {
    let mut stages = vec![(Duration::ZERO, 0); STAGES.len()];
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let start = Instant::now();
    let mut last = start;
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let mut done = |stage| {
        let now = Instant::now();
        let held = MEMORY.current_usage().saturating_sub(before + text.len());
        if let Some(i) = STAGES.iter().position(|&known| known == stage) {
            stages[i] = (now - last, held);
        }
        last = now;
    };
    let checked = check_observed(
        "generated.sa",
        &mut reader,
        Limits {
            events: usize::MAX,
            ..Limits::default()
        },
        &LintLevels::default(),
        &mut done,
    );
    let total = start.elapsed();
    right(&checked);
    Measured {
        stages,
        total,
        held: MEMORY.current_usage().saturating_sub(before + text.len()),
        peak: MEMORY.peak_usage().saturating_sub(before + text.len()),
    }
}

/// Checks that the program has no errors. Otherwise, its timing would be meaningless.
fn right(checked: &Checked) {
    assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
    assert!(checked.programs[0].tables.is_some());
}

fn median(times: impl Iterator<Item = Duration>) -> Duration {
    let mut times: Vec<Duration> = times.collect();
    times.sort_unstable();
    times[times.len() / 2]
}

fn scene(out: &mut String, edge: usize) {
    let blocks = edge * edge * HEIGHT;
    let radius = edge + 10;
    let _ = writeln!(out, "scene vast from hemisphere {{");
    let _ = writeln!(out, "    free {blocks} uniform");
    let _ = writeln!(
        out,
        "    enclosure hemisphere {{ radius {radius}m  wall 25 N/m }}\n}}"
    );
}

/// Returns the source of a program with a separate line for every seed and every tower.
fn flat(edge: usize) -> String {
    let mut out = String::new();
    scene(&mut out, edge);
    let _ = writeln!(
        out,
        "assembly flat in vast {{\n    seed plate {edge} x {edge} {{"
    );
    for y in 0..edge {
        for x in 0..edge {
            let _ = writeln!(out, "        S{} at ({x}, {y})", y * edge + x);
        }
    }
    out.push_str("    }\n    phase grow {\n");
    for tower in 0..edge * edge {
        let _ = write!(out, "        S{tower}.up");
        for level in 1..=HEIGHT {
            let up = if level == HEIGHT { "" } else { ".up" };
            let _ = write!(out, " -> T{tower}_{level}{up}");
        }
        out.push('\n');
    }
    out.push_str("    }\n}\n");
    out
}

/// Returns the source of a program with a pattern of towers in a pattern of rows in a loop.
fn nested(edge: usize) -> String {
    let mut out = String::new();
    scene(&mut out, edge);
    let last = edge - 1;
    let _ = write!(
        out,
        "pattern tower(base, height) {{
    base.up ->> T[1..height]
}}
assembly nested in vast {{
    seed plate {edge} x {edge} {{
        for y in 0..{last} {{ for x in 0..{last} {{ S[x, y] at (x, y) }} }}
    }}
    phase grow {{
        for y in 0..{last} {{
            for x in 0..{last} {{ tower(S[x, y], {HEIGHT}) as t[x, y] }}
        }}
    }}
}}
"
    );
    out
}
