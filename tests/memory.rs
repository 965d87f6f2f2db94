//! Tests the memory for programs beyond the limits, and for output of large programs.
use std::fmt::{Display, Write as _};
use std::io::{Write as _, sink};
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};

use peak_alloc::PeakAlloc;
use stochc::compiler::diagnostic::Code;
use stochc::compiler::emit::{structure_json, structure_text};
use stochc::compiler::{Checked, Limits, check};
use stochc::experiments::ComparisonTally;
use stochc::ir::Json;
use stochc::ir::emit::{graph_dot, graph_json, graph_text, table_json, table_text};
use stochc::report::ensemble_report::{Figures, Input, ReportLocation, report};
use stochc::results::{
    Destination, EnsembleProgram, Folder, Manifest, Progress, RunCancelled, RunWatch, run,
};
use stochc_runtime::{Model, Settings};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

const MIB: usize = 1 << 20;

/// Returns the result of `work`, and the peak of its additional memory \[bytes\].
fn peak<T>(work: impl FnOnce() -> T) -> (T, usize) {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let result = work();
    (result, MEMORY.peak_usage().saturating_sub(before))
}

/// Lock that makes tests run one after the other. The counter of memory is shared by the whole
/// process.
static TURN: Mutex<()> = Mutex::new(());

fn checked(text: &str) -> Checked {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    check("large.sa", &mut reader, Limits::default())
}

/// Returns the source of `towers` towers of four blocks on a square plate. With `in_one`, it is one
/// tower of `4 * towers` blocks in one statement.
fn program(towers: usize, in_one: bool) -> String {
    let edge = (towers as f64).sqrt().ceil() as usize;
    let mut text = format!(
        "scene vast from hemisphere {{ free {} uniform enclosure hemisphere {{ radius {}m wall 25 N/m }} }}\n\
         assembly large in vast {{ seed plate {edge} x {edge} {{\n",
        towers * 4,
        towers * 8,
    );
    let seeds = if in_one { 1 } else { towers };
    for i in 0..seeds {
        let _ = writeln!(text, "S{i} at ({}, {})", i % edge, i / edge);
    }
    text.push_str("}\nphase grow {\n");
    for i in 0..seeds {
        let _ = write!(text, "S{i}.up");
        let height = 4 * towers / seeds;
        for level in 1..=height {
            let up = if level == height { "" } else { ".up" };
            let _ = write!(text, " -> T{i}_{level}{up}");
        }
        text.push('\n');
    }
    text.push_str("} }");
    text
}

#[test]
fn showing_a_program_needs_no_more_memory_than_compiling() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let json = |document: Json| peak(|| serde_json::to_writer_pretty(sink(), &document).unwrap()).1;
    let text = |text: &dyn Display| peak(|| write!(sink(), "{text}").unwrap()).1;
    for (towers, in_one) in [(2_500, false), (10_000, false), (10_000, true)] {
        let checked = checked(&program(towers, in_one));
        assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
        let (program, symbols) = (&checked.programs[0], &checked.symbols);
        let (plan, layout, graph) = (&program.plan, &program.layout, &program.event_graph());
        let tables = program.tables.as_ref().unwrap();
        assert_eq!(plan.events.len(), 4 * towers);
        // The structure is sorted by cell, which needs a copy.
        let sorted = 64 * plan.events.len();
        for (what, more, taken) in [
            ("table as JSON", 0, json(table_json(tables))),
            ("table", 0, text(&table_text(tables))),
            ("graph as JSON", 0, json(graph_json(graph, tables))),
            ("graph", 0, text(&graph_text(graph, tables))),
            ("graph as DOT", 0, text(&graph_dot(graph, tables))),
            (
                "structure as JSON",
                sorted,
                json(structure_json(plan, layout, symbols)),
            ),
            ("structure", sorted, text(&structure_text(plan, layout))),
        ] {
            assert!(
                taken < MIB + more,
                "{what} of {towers}, {in_one}: {taken} bytes"
            );
        }
    }
}

#[test]
fn a_program_beyond_the_limits_needs_little_memory() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let phase = |body: &str| {
        format!("assembly a {{ seed plate 3 x 3 {{ A at (0, 0) }} phase p {{ {body} }} }}")
    };
    let doubling = |core: &str| {
        let first = format!("pattern p0(b) {{ {core} }}\n");
        (1..60).fold(first, |text, i| {
            let p = i - 1;
            format!("{text}pattern p{i}(b) {{ p{p}(b) p{p}(b) }}\n")
        })
    };
    for text in [
        "assembly a { seed plate 100000 x 100000 { for i in 1..1000000000 { S[i] at (1, 1) } } }"
            .to_owned(),
        "assembly a { seed plate 100000 x 100000 { for i in 0..99999 { for j in 0..99999 { S[i, j] at (i, j) } } } }"
            .to_owned(),
        format!("{}{}", doubling("b.up -> B"), phase("p59(A)")),
        format!("{}{}", doubling("b.up ->> T[1..1000]"), phase("p59(A)")),
        format!("{}{}", doubling(""), phase("p59(A)")),
        phase("for i in 1..1000000000 { for j in 1..10 { A.up -> T[i, j] } }"),
        phase("A.up ->> T[1..9999999] A.north ->> U[1..9999999]"),
        phase("A.up -> B release T[1..1000000000]"),
        phase("for i in 1..1000 { release T[i, 1..9999] after U[1..9999] }"),
        phase("A.up -> B after T[1..9999999], U[1..9999999]"),
        "pattern p(b) { } assembly a { seed plate 3 x 3 { A at (0, 0) }
         phase q { for i in 1..1000000000 { p(A) as t[i] } } }"
            .to_owned(),
    ] {
        let (checked, taken) = peak(|| checked(&text));
        let codes: Vec<Code> = checked.diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
        assert!(codes.contains(&Code::ExpansionLimit), "{text:.200}: {codes:?}");
        assert!(taken < 100 * MIB, "{text:.200}: {} MiB", taken / MIB);
    }
}

/// Checks the memory of large ensembles. Their runs are stored in files. An additional run takes
/// only a few bytes while runs are made, summarized and reported. A record of this program has 2
/// kB.
#[test]
fn memory_hardly_grows_with_the_number_of_runs() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    // Both numbers of runs exceed a row group of a table.
    let few = ensemble_memory(10_000);
    let many = ensemble_memory(24_000);
    let grown = many.saturating_sub(few);
    assert!(
        grown < 14_000 * 300,
        "{few} and {many} bytes: {} for each run",
        grown / 14_000
    );
}

/// Returns the peak of memory for simulating `runs` runs into a folder, summarizing and reporting
/// them \[bytes\].
fn ensemble_memory(runs: u64) -> usize {
    let text =
        "assembly line { seed plate 1 x 1 { M at (0, 0) } phase grow { M.up ->> T[1..13] } }";
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let mut checked = check("line.sa", &mut reader, Limits::default());
    let executable = checked.programs.remove(0).into_executable().unwrap();
    let settings = Settings::new(Model::Shuffle, 1);
    let program = EnsembleProgram::new("line", Vec::new(), executable);
    let manifest = Manifest::new(settings, 1, runs, vec![program]);
    let place = tempfile::tempdir().unwrap();
    let (_, bytes) = peak(|| {
        let folder = Folder::open(place.path(), &manifest, false).unwrap();
        let progress = Progress::new(&manifest, NonZeroUsize::MIN);
        let never = AtomicBool::new(false);
        let program = &manifest.programs[0];
        let simulate = |_: usize, run, watch: &RunWatch| {
            let mut watcher = |tick, phase| watch.tick(tick, phase);
            let (tables, scene) = (program.tables(), &program.scene);
            let (settings, seed) = (&manifest.settings, manifest.seed);
            let record = stochc_runtime::run(tables, scene, settings, seed, run, &mut watcher);
            record.map_err(|_| RunCancelled)
        };
        let results = run(Destination::Folder(folder), &progress, &never, simulate);
        assert!(results.unwrap().complete);
        let contents = Folder::read(place.path()).unwrap();
        let mut comparison = ComparisonTally::new(&contents.manifest);
        let result = contents.finished.each(|done| comparison.add(done));
        result.unwrap();
        assert_eq!(comparison.finish().programs[0].completed, runs);
        let inputs = [Input {
            path: "line".to_owned(),
            manifest: contents.manifest,
            finished: contents.finished,
        }];
        let surroundings = ReportLocation {
            reload: None,
            folder: "figures",
            figures: &Figures::default(),
            replay: &|_, _, _| None,
            recordings: &|_, _, _| None,
        };
        let made = report(&inputs, &surroundings, &mut sink());
        assert!(made.unwrap().page.contains("line"));
    });
    bytes
}

/// Checks short programs at the limits of the language.
#[test]
fn no_short_text_needs_more_than_300_mib() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let scene = "scene w from hemisphere { free 10000000 uniform enclosure hemisphere { radius 1e7 m wall 250 N/m } }";
    let seed = "seed plate 1 x 1 { M at (0, 0) }";
    for text in [
        format!("{scene} assembly a in w {{ {seed} phase p {{ M.up ->> T[1..499990] }} }}"),
        format!(
            "assembly a {{ {seed} shape s {{ layer 1..5000000 {{ # }} }} phase p {{ M.up ->> T[1..3] yields s }} }}"
        ),
        format!(
            "{scene} assembly a in w {{ seed plate 6000 x 1 {{ for i in 0..5999 {{ S[i] at (i, 0) }} }} \
             phase p {{ for i in 0..699 {{ S[i].up -> T[i] }} for i in 700..1399 {{ S[i].up -> T[i] after T[0..690] }} }} }}"
        ),
        "assembly a { seed plate 700 x 700 { for i in 0..699 { for j in 0..699 { S[i, j] at (i, j) } } } }".to_owned(),
        format!(
            "{scene} assembly a in w {{ {seed} for i in 1..240000 {{ phase p[i] {{ M.up -> T[i] }} }} }}"
        ),
        format!(
            "{scene} pattern p(b) {{ b.up -> T }} assembly a in w {{ seed plate 700 x 350 {{ \
             for i in 0..699 {{ for j in 0..349 {{ S[i, j] at (i, j) }} }} }} phase q {{ \
             for i in 0..230 {{ for j in 0..349 {{ p(S[i, j]) }} }} }} }}"
        ),
        format!("{scene} assembly a in w {{ {seed} phase p {{ M.up ->> T[1..9000000] }} }}"),
    ] {
        let (checked, bytes) = peak(|| checked(&text));
        let codes: Vec<Code> = checked.diagnostics.iter().map(|it| it.code).collect();
        assert!(bytes < 300 * MIB, "{} MiB: {text}: {codes:?}", bytes / MIB);
    }
}
