//! Ensemble of two programs without physics. Each run is a hash of its number.
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use stochc_ir::graph::{EventAction, EventGraph, EventId, GraphEvent};
use stochc_ir::record::{
    AbortRecord, BondRecord, FaultKind, FaultRecord, Limit, Origin, Outcome, ReleaseRecord,
    RunRecord, UnplannedRecord, WaitRecord,
};
use stochc_ir::scene::schema::unspecified;
use stochc_ir::scene::{Arrangement, Block, Enclosure, Free, Scene};
use stochc_ir::state::StateReader;
use stochc_ir::table::{Action, Phase, PhaseId, Plate, Recovery, Role, RoleId, Tables, Trigger};
use stochc_ir::{Cell, Executable, Face};
use stochc_results::{
    Destination, EnsembleError, EnsembleProgram, Folder, Interval, Manifest, Progress, Results,
    RunCancelled, RunWatch, Source, run,
};
use stochc_runtime::{Settings, Watch as _};

/// Returns a scene with numbers that an inexact JSON reader would change.
pub fn scene() -> Scene {
    Scene {
        name: "void".into(),
        tick: 0.1 + 0.2,
        block: Block {
            side: 1.0 / 3.0,
            mass: 1e-300,
            faces: 1,
        },
        free: Free {
            count: 300,
            arrangement: Arrangement::Uniform,
        },
        enclosure: Some(Enclosure::Hemisphere {
            radius: std::f64::consts::PI,
            wall: 7.038531e-26,
        }),
        ..unspecified()
    }
}

/// Returns a program with two phases: A captures B, then B captures C.
pub fn program(name: &str) -> EnsembleProgram {
    let role = |name: &str, seed| Role {
        name: name.into(),
        seed,
    };
    let phase = |name: &str| Phase {
        name: name.into(),
        timeout: None,
        wait: 0,
        reports: 1,
        recovery: None,
        pre_attached: false,
    };
    let retried = Phase {
        timeout: Some(5),
        recovery: Some(Recovery {
            retries: 1,
            reports: 1,
            pause: 3,
        }),
        ..phase("second")
    };
    let catch = |child, z| Action::Magnetize {
        face: Face::Up,
        child: RoleId(child),
        cell: Cell::new(0, 0, z),
    };
    let report = |role, phase| {
        let rules = vec![(vec![], Action::Report)];
        (RoleId(role), PhaseId(phase), Trigger::Anchored, rules)
    };
    let tables = Tables::assemble(
        name,
        1,
        Plate { width: 1, depth: 1 },
        vec![phase("first"), retried],
        vec![
            role("A", Some(Cell::new(0, 0, 0))),
            role("B", None),
            role("C", None),
        ],
        vec![
            (
                RoleId(0),
                PhaseId(0),
                Trigger::Start,
                vec![(vec![], catch(1, 1))],
            ),
            report(1, 0),
            (
                RoleId(1),
                PhaseId(1),
                Trigger::Start,
                vec![(vec![], catch(2, 2))],
            ),
            report(2, 1),
        ],
    );
    let source = Source {
        path: format!("somewhere/{name}.sa"),
        text: format!("assembly {name} {{}}"),
    };
    let (scene, graph) = (scene(), graph());
    let executable = Executable {
        tables,
        scene,
        graph,
        jam_risks: Vec::new(),
    };
    EnsembleProgram::new(name, vec![source], executable)
}

pub fn manifest(runs: u64) -> Manifest {
    Manifest::new(
        Settings::default(),
        u64::MAX,
        runs,
        vec![program("left"), program("right")],
    )
}

/// Returns the dependency graph. In the first phase, A captures B. In the second, B captures C and
/// is then released.
fn graph() -> EventGraph {
    let capture = |phase, child: u32| GraphEvent {
        phase: PhaseId(phase),
        action: EventAction::Capture {
            parent: RoleId(child - 1),
            face: Face::Up,
            child: RoleId(child),
        },
        cell: Some(Cell::new(-1, 0, child as i32)),
        delay: 0,
    };
    let release = GraphEvent {
        phase: PhaseId(1),
        action: EventAction::Release { child: RoleId(1) },
        cell: Some(Cell::new(-1, 0, 1)),
        delay: 0,
    };
    let chains = vec![vec![EventId(0)], vec![EventId(1)]];
    let events = vec![capture(0, 1), capture(1, 2), release];
    EventGraph::new(events, Vec::new(), chains)
}

/// Returns a random number: SplitMix64 of the run and of `what`, the purpose of the draw.
fn draw(program: usize, run: u64, what: u64) -> u64 {
    let mut z = (run << 8 | (program as u64) << 4 | what).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Interval between checkpoints in these tests. The longest run has a thousand ticks.
pub const EVERY: Interval = Interval::Ticks(300);

/// Makes a run that waits for one block, and usually for a second one. The state of the run is its
/// tick.
pub fn simulate(program: usize, run: u64, mut watch: &RunWatch) -> Result<RunRecord, RunCancelled> {
    let waits = [draw(program, run, 0) % 500, draw(program, run, 1) % 500];
    let bond = |phase: usize, magnetized, origin| BondRecord {
        phase: PhaseId(phase as u32),
        parent: RoleId(phase as u32),
        face: Face::Up,
        child: RoleId(phase as u32 + 1),
        cell: Cell::new(-1, 0, phase as i32 + 1),
        magnetized,
        docked: magnetized + waits[phase],
        entries: 3,
        docking: waits[phase] / 10,
        body: (draw(program, run, 2) % 300) as u32,
        origin,
    };
    let total = waits[0] + waits[1];
    let begins = match watch.saved() {
        Some(mut state) => {
            let tick: u64 = StateReader::new(&mut *state)
                .take()
                .map_err(|_| RunCancelled)?;
            assert!(tick < total, "there is no such tick");
            tick
        }
        None => 0,
    };
    for tick in begins..total {
        let phase = PhaseId(u32::from(tick >= waits[0]));
        let flow = watch.tick(tick, phase);
        if watch.wants_state() {
            watch.keep(&mut |to| to.put(&tick));
        }
        if flow.is_break() {
            return Err(RunCancelled);
        }
    }
    let released = Origin::Released {
        role: RoleId(1),
        tick: 7,
    };
    let mut record = RunRecord {
        phase_ticks: vec![waits[0], waits[1]],
        blocks_used: 2,
        hops: draw(program, run, 3) % 20,
        bonds: vec![bond(0, 0, Origin::Free), bond(1, waits[0], released)],
        ..RunRecord::without_bonds(run, Outcome::Completed, total)
    };
    add_rare_events(&mut record);
    match run {
        3 => panic!("run 3 goes wrong"),
        5 => {
            record.phase_ticks.clear();
            record.bonds.clear();
            record.waiting.clear();
            record.releases.clear();
            record.aborts.clear();
            record.outcome = Outcome::Failed {
                phase: PhaseId(0),
                reason: "block 7 left the world".into(),
                is_broken: program == 1,
            };
        }
        _ => {}
    }
    Ok(record)
}

/// Adds aborted attempts, releases, unplanned captures and timeouts to some of the runs.
fn add_rare_events(record: &mut RunRecord) {
    let total = record.ticks;
    if total.is_multiple_of(5) && record.phase_ticks[1] > 20 {
        add_abort(record);
    }
    let (parent, child, body) = (RoleId(0), RoleId(1), record.bonds[0].body);
    if total.is_multiple_of(3) {
        record.releases.push(ReleaseRecord {
            phase: PhaseId(1),
            parent,
            child,
            tick: record.phase_ticks[0],
            body,
        });
    }
    for tick in 0..total % 3 {
        record.faults.push(FaultRecord {
            phase: PhaseId(0),
            child,
            tick,
            body,
            kind: [FaultKind::Dead, FaultKind::Latch][(tick % 2) as usize],
        });
    }
    for tick in 0..total % 4 {
        record.unplanned += 1;
        record.unplanned_bonds.push(UnplannedRecord {
            phase: PhaseId(0),
            parent,
            face: Face::North,
            tick,
            body,
        });
    }
    if total > 800 {
        record.outcome = Outcome::TimedOut {
            phase: PhaseId(1),
            by: match record.run % 2 {
                0 => Limit::Timeout,
                _ => Limit::MaxTicks,
            },
        };
        record.phase_ticks.truncate(1);
        if let Some(missing) = record.bonds.pop() {
            record.waiting.push(WaitRecord {
                phase: missing.phase,
                parent: missing.parent,
                face: missing.face,
                child: missing.child,
                cell: missing.cell,
                magnetized: missing.magnetized,
                entries: 2,
            });
        }
    }
}

/// Adds an aborted attempt at the second phase, with its capture or with its open face.
fn add_abort(record: &mut RunRecord) {
    let began = record.phase_ticks[0];
    let last = &mut record.bonds[1];
    let bond = BondRecord {
        magnetized: began,
        docked: began + 3,
        docking: 1,
        ..last.clone()
    };
    last.magnetized = began + 10;
    let wait = WaitRecord {
        phase: bond.phase,
        parent: bond.parent,
        face: bond.face,
        child: bond.child,
        cell: bond.cell,
        magnetized: began,
        entries: 1,
    };
    let release = ReleaseRecord {
        phase: bond.phase,
        parent: bond.parent,
        child: bond.child,
        tick: began + 7,
        body: bond.body,
    };
    let is_captured = record.ticks.is_multiple_of(2);
    record.aborts.push(AbortRecord {
        phase: bond.phase,
        began,
        tick: began + 5,
        retried: Some(began + 10),
        waiting: if is_captured { vec![] } else { vec![wait] },
        bonds: if is_captured { vec![bond] } else { vec![] },
        releases: if is_captured { vec![release] } else { vec![] },
    });
}

/// Makes the runs of an ensemble on this number of threads.
pub fn run_on(
    threads: usize,
    destination: Destination,
    stop: &AtomicBool,
    simulate: impl Fn(usize, u64, &RunWatch) -> Result<RunRecord, RunCancelled> + Sync,
) -> Result<Results, EnsembleError> {
    let manifest = match &destination {
        Destination::Memory(manifest) | Destination::MoreInMemory(manifest, _) => {
            (*manifest).clone()
        }
        Destination::Folder(folder) => folder.manifest().clone(),
    };
    let progress = Progress::new(&manifest, NonZeroUsize::new(threads).unwrap());
    run(destination, &progress, stop, simulate)
}

/// Makes or resumes the ensemble of `manifest` in the folder `path`.
pub fn complete(path: &Path, manifest: &Manifest, threads: usize) -> Results {
    let folder = Folder::open(path, manifest, true).unwrap();
    let folder = folder.with_checkpoints(EVERY).unwrap();
    let never = AtomicBool::new(false);
    run_on(threads, Destination::Folder(folder), &never, simulate).unwrap()
}

/// Returns the bytes of all tables in a folder.
pub fn bytes(path: &Path) -> Vec<Vec<u8>> {
    let names = stochc_results::tables().into_iter();
    let files = names.map(|table| path.join(format!("{}.parquet", table.name)));
    files.map(|file| std::fs::read(file).unwrap()).collect()
}

/// Writes a file for a test.
#[expect(
    clippy::disallowed_methods,
    reason = "the test writes files that other programs would write"
)]
pub fn put(path: &Path, content: impl AsRef<[u8]>) {
    std::fs::write(path, content).unwrap();
}
