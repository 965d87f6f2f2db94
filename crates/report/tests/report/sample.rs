//! Ensemble that is small enough for computing results by hand.
use std::collections::BTreeMap;

use stochc_compiler::{Limits, LintLevels};
use stochc_ir::record::{BondRecord, Limit, Origin, Outcome, ReleaseRecord, RunRecord, WaitRecord};
use stochc_ir::table::{PhaseId, RoleId};
use stochc_ir::{Cell, Executable, Face};
use stochc_report::ensemble_report::{
    CRITICAL_PATHS, Figures, Input, Report, ReportLocation, report,
};
use stochc_results::{EnsembleProgram, Finished, Manifest, Source};
use stochc_runtime::{Model, Settings};

/// Source of a program that builds two towers next to each other. Then the second block of one
/// tower is released, and M captures a block.
pub const TEXT: &str = "\
assembly pair {
    seed plate 3 x 3 { A at (0, 0)  B at (2, 0)  M at (1, 1) }
    phase towers {
        A.up -> C.up -> E
        B.up -> D
    }
    phase last {
        release E
        M.up -> F
    }
}
";

/// Returns a manifest of the program in a scene with this friction.
pub fn manifest(friction: f64, runs: u64) -> Manifest {
    let mut read = |_: &str| Ok(TEXT.as_bytes().to_vec());
    let checked = stochc_compiler::check_with(
        "pair.sa",
        &mut read,
        Limits::default(),
        &LintLevels::default(),
    );
    assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
    let program = &checked.programs[0];
    let text = match friction {
        0.2 => TEXT.replace("pair {", "pair in hemisphere_2005 {"),
        _ => format!(
            "scene other from hemisphere_2005 {{ contact {{ restitution 0  friction {friction} }} }}\n{}",
            TEXT.replace("pair {", "pair in other {")
        ),
    };
    let mut read = |_: &str| Ok(text.as_bytes().to_vec());
    let checked = stochc_compiler::check_with(
        "pair.sa",
        &mut read,
        Limits::default(),
        &LintLevels::default(),
    );
    let scene = checked.programs[0].scene.clone().unwrap();
    let source = Source {
        path: "pair.sa".into(),
        text,
    };
    let executable = Executable {
        tables: program.tables.clone().unwrap(),
        scene,
        graph: program.event_graph(),
        jam_risks: Vec::new(),
    };
    let program = EnsembleProgram::new("pair", vec![source], executable);
    Manifest::new(Settings::new(Model::Rigid, 1), 7, runs, vec![program])
}

/// Waiting times of a run for the captures of C, E, D and F. The face for F is switched on when the
/// first phase ends. Without `f`, the run is stopped after it has waited `after` ticks for F.
pub struct Waits {
    pub c: u64,
    pub e: u64,
    pub d: u64,
    pub f: Option<u64>,
    pub after: u64,
}

/// Returns the record of a run with these waiting times. Every second run captures the released
/// block.
pub fn record(manifest: &Manifest, run: u64, waits: &Waits) -> Finished {
    let program = &manifest.programs[0];
    let role = |name: &str| {
        let place = program.roles().iter().position(|role| role.name == name);
        RoleId(place.unwrap() as u32)
    };
    let bond = |phase, parent: &str, child: &str, magnetized, docked| BondRecord {
        phase: PhaseId(phase),
        parent: role(parent),
        face: Face::Up,
        child: role(child),
        cell: Cell::new(0, 0, 1),
        magnetized,
        docked,
        entries: 4,
        docking: (docked - magnetized) / 2,
        body: run as u32,
        origin: Origin::Free,
    };
    let first = (waits.c + waits.e).max(waits.d);
    let mut bonds = vec![
        bond(0, "A", "C", 0, waits.c),
        bond(0, "C", "E", waits.c, waits.c + waits.e),
        bond(0, "B", "D", 0, waits.d),
    ];
    bonds.sort_by_key(|bond| bond.docked);
    let mut waiting = Vec::new();
    let (outcome, second) = match waits.f {
        Some(wait) => {
            let mut last = bond(1, "M", "F", first, first + wait);
            if run % 2 == 1 {
                last.origin = Origin::Released {
                    role: role("E"),
                    tick: first,
                };
            }
            bonds.push(last);
            (Outcome::Completed, Some(wait))
        }
        None => {
            let missing = bond(1, "M", "F", first, first);
            waiting.push(WaitRecord {
                phase: missing.phase,
                parent: missing.parent,
                face: missing.face,
                child: missing.child,
                cell: missing.cell,
                magnetized: missing.magnetized,
                entries: 1,
            });
            let (phase, by) = (PhaseId(1), Limit::MaxTicks);
            (Outcome::TimedOut { phase, by }, None)
        }
    };
    let release = ReleaseRecord {
        phase: PhaseId(1),
        parent: role("C"),
        child: role("E"),
        tick: first,
        body: run as u32,
    };
    let record = RunRecord {
        phase_ticks: [Some(first), second].into_iter().flatten().collect(),
        blocks_used: 4,
        hops: 9,
        bonds,
        waiting,
        releases: vec![release],
        ..RunRecord::without_bonds(run, outcome, first + second.unwrap_or(waits.after))
    };
    Finished {
        program: 0,
        record,
        cpu: None,
    }
}

/// Returns a results folder with five runs, which take 100, 200, 200, more than 300, and 400 ticks.
pub fn five(friction: f64) -> Input {
    let manifest = manifest(friction, 5);
    let waits = [
        (20, 30, 40, Some(50)),
        (50, 40, 100, Some(100)),
        (60, 60, 10, Some(80)),
        (50, 50, 90, None),
        (70, 30, 10, Some(300)),
    ];
    let finished = (0..).zip(waits).map(|(run, (c, e, d, f))| {
        let waits = Waits {
            c,
            e,
            d,
            f,
            after: 200,
        };
        record(&manifest, run, &waits)
    });
    Input {
        path: format!("results/friction {friction}"),
        finished: finished.collect::<Vec<_>>().into(),
        manifest,
    }
}

/// Returns the report on folders without replays.
pub fn report_of(inputs: &[Input]) -> Report {
    drawn(inputs, &Figures::default())
}

/// Returns the report on folders, with these options for figures.
pub fn drawn(inputs: &[Input], figures: &Figures) -> Report {
    let surroundings = ReportLocation {
        reload: None,
        folder: "report-figures",
        figures,
        replay: &|_, _, _| None,
        recordings: &|_, _, _| None,
    };
    let mut chains = Vec::new();
    let mut report = report(inputs, &surroundings, &mut chains).unwrap();
    let chains = String::from_utf8(chains).unwrap();
    report
        .files
        .push((CRITICAL_PATHS.to_owned(), chains.into_bytes()));
    report.files.sort();
    report
}

/// Returns the text of a report's file by its name.
pub fn file<'a>(report: &'a Report, name: &str) -> &'a str {
    let found = report.files.iter().find(|(file, _)| file == name);
    let content = &found.unwrap_or_else(|| panic!("no {name}")).1;
    std::str::from_utf8(content).unwrap()
}

/// Returns the rows of a report's table, each by column name.
pub fn rows(report: &Report, name: &str) -> Vec<BTreeMap<String, String>> {
    crate::reading::fields(file(report, name))
}
