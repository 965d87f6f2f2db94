//! Writes runs as the log of an experiment.
use stochc_files::csv::CsvTable;
use stochc_ir::record::{
    AbortRecord, BondRecord, Limit, Outcome, ReleaseRecord, RunRecord, WaitRecord,
};
use stochc_ir::table::{PhaseId, RoleId};
use stochc_results::EnsembleProgram;

/// Rows that a log contains.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// Captures, releases and ends.
    Events,
    /// Also phases and faces that open.
    All,
}

/// Row of a log: time, then the order within a tick, then the texts of the row.
type LogRow = ([u64; 4], [String; 3], Option<u32>);

/// Returns runs as a log in CSV, with times in seconds.
pub fn csv(records: &[RunRecord], program: &EnsembleProgram, detail: Detail) -> String {
    let mut table = CsvTable::new(["run", "seconds", "event", "block", "by", "body"]);
    for record in records {
        for ([tick, ..], [event, block, by], body) in rows(record, program, detail) {
            let seconds = tick as f64 * program.scene.tick;
            let body = body.map_or(String::new(), |body| body.to_string());
            table.row([
                record.run.to_string(),
                seconds.to_string(),
                event,
                block,
                by,
                body,
            ]);
        }
    }
    table.finish()
}

/// Returns runs as a log in JSON Lines, with times in ticks.
pub fn json_lines(records: &[RunRecord], program: &EnsembleProgram, detail: Detail) -> String {
    let mut text = String::new();
    for record in records {
        for ([tick, ..], [event, block, by], body) in rows(record, program, detail) {
            let row = serde_json::json!({
                "run": record.run, "ticks": tick, "event": event, "block": block, "by": by, "body": body,
            });
            text += &format!("{row}\n");
        }
    }
    text
}

/// Attempt at a phase: its events, and the order of the attempt among all attempts.
struct Attempt<'a> {
    order: u64,
    bonds: Vec<&'a BondRecord>,
    waiting: Vec<&'a WaitRecord>,
    releases: Vec<&'a ReleaseRecord>,
}

fn rows(record: &RunRecord, program: &EnsembleProgram, detail: Detail) -> Vec<LogRow> {
    let role = |role: RoleId| program.role(role).to_owned();
    let mut rows: Vec<LogRow> = Vec::new();
    let mut row = |tick: u64, order: [u64; 3], texts: [String; 3], body: Option<u32>| {
        rows.push(([tick, order[0], order[1], order[2]], texts, body));
    };
    let mut began = 0;
    for phase in (0..program.phases().len() as u32).map(PhaseId) {
        let name = program.phase(phase).to_owned();
        let aborts: Vec<&AbortRecord> = record
            .aborts
            .iter()
            .filter(|it| it.phase == phase)
            .collect();
        let mut attempts: Vec<Attempt<'_>> = Vec::new();
        for (order, abort) in (0..).zip(&aborts) {
            attempts.push(Attempt {
                order,
                bonds: abort.bonds.iter().collect(),
                waiting: abort.waiting.iter().collect(),
                releases: Vec::new(),
            });
            row(
                abort.tick,
                [phase.0.into(), order, 5],
                ["timeout".into(), name.clone(), String::new()],
                None,
            );
            for it in &abort.releases {
                let texts = ["released".into(), role(it.child), role(it.parent)];
                row(it.tick, [phase.0.into(), order, 6], texts, Some(it.body));
            }
            if let Some(tick) = abort.retried {
                row(
                    tick,
                    [phase.0.into(), order + 1, 0],
                    ["phase".into(), name.clone(), String::new()],
                    None,
                );
            }
        }
        attempts.push(Attempt {
            order: aborts.len() as u64,
            bonds: record.bonds.iter().filter(|it| it.phase == phase).collect(),
            waiting: record
                .waiting
                .iter()
                .filter(|it| it.phase == phase)
                .collect(),
            releases: record
                .releases
                .iter()
                .filter(|it| it.phase == phase)
                .collect(),
        });
        let is_reached = record.phase_ticks.len() >= phase.0 as usize;
        if program.is_pre_attached(phase) || !is_reached {
            continue;
        }
        if detail == Detail::All {
            row(
                began,
                [phase.0.into(), 0, 0],
                ["phase".into(), name, String::new()],
                None,
            );
        }
        for Attempt {
            order,
            bonds,
            waiting,
            releases,
        } in attempts
        {
            let at = |kind| [phase.0.into(), order, kind];
            let opened = bonds
                .iter()
                .map(|it| (it.magnetized, it.parent, it.face, it.child));
            let waits = waiting
                .iter()
                .map(|it| (it.magnetized, it.parent, it.face, it.child));
            for (tick, parent, face, child) in opened.chain(waits).filter(|_| detail == Detail::All)
            {
                let by = format!("{}.{face}", role(parent));
                row(tick, at(4), ["opened".into(), role(child), by], None);
            }
            for it in bonds {
                let by = format!("{}.{}", role(it.parent), it.face);
                row(
                    it.docked,
                    at(1),
                    ["captured".into(), role(it.child), by],
                    Some(it.body),
                );
            }
            for it in releases {
                let texts = ["released".into(), role(it.child), role(it.parent)];
                row(it.tick, at(2), texts, Some(it.body));
            }
        }
        began += record
            .phase_ticks
            .get(phase.0 as usize)
            .copied()
            .unwrap_or(0);
    }
    for it in &record.unplanned_bonds {
        let by = format!("{}.{}", role(it.parent), it.face);
        row(
            it.tick,
            [it.phase.0.into(), 0, 3],
            ["rejected".into(), String::new(), by],
            Some(it.body),
        );
    }
    rows.sort_by_key(|(order, ..)| *order);
    let last = match record.outcome {
        Outcome::TimedOut {
            phase,
            by: Limit::Timeout,
        } => ["timeout", program.phase(phase), ""],
        _ => ["end", "", ""],
    };
    rows.push(([record.ticks, 0, 0, 0], last.map(str::to_owned), None));
    rows
}

/// Returns a record without the quantities that no log contains.
pub fn without_physics(record: &RunRecord) -> RunRecord {
    let mut record = RunRecord {
        hops: 0,
        ..record.clone()
    };
    let aborted = record.aborts.iter_mut();
    let (bonds, waits): (Vec<_>, Vec<_>) =
        aborted.map(|it| (&mut it.bonds, &mut it.waiting)).unzip();
    let bonds = bonds.into_iter().flatten().chain(&mut record.bonds);
    bonds.for_each(|bond| (bond.entries, bond.docking) = (0, 0));
    let waits = waits.into_iter().flatten().chain(&mut record.waiting);
    waits.for_each(|wait| wait.entries = 0);
    record
}

/// Returns whether a log can reproduce a run. Runs whose physics failed have no log.
pub fn is_loggable(record: &RunRecord) -> bool {
    !matches!(record.outcome, Outcome::Failed { .. })
}
