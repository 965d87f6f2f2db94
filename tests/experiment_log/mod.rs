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

/// Row of a log.
struct LogRow {
    /// Tick, then the order within a tick.
    order: (u64, PhaseId, usize, Kind),
    texts: [String; 3],
    body: Option<u32>,
}

/// Kinds of rows, in their order within a tick.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Phase,
    Captured,
    Released,
    Rejected,
    Opened,
    Timeout,
    Undone,
}

/// Returns runs as a log in CSV, with times in seconds.
pub fn csv(records: &[RunRecord], program: &EnsembleProgram, detail: Detail) -> String {
    let mut table = CsvTable::new(["run", "seconds", "event", "block", "by", "body"]);
    for record in records {
        for LogRow { order, texts, body } in rows(record, program, detail) {
            let [event, block, by] = texts;
            let seconds = order.0 as f64 * program.scene.tick;
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
        for LogRow { order, texts, body } in rows(record, program, detail) {
            let (tick, [event, block, by]) = (order.0, texts);
            let row = serde_json::json!({
                "run": record.run, "ticks": tick, "event": event, "block": block, "by": by, "body": body,
            });
            text += &format!("{row}\n");
        }
    }
    text
}

/// Rows of a run.
struct LogRows<'a> {
    program: &'a EnsembleProgram,
    detail: Detail,
    rows: Vec<LogRow>,
}

impl LogRows<'_> {
    fn role(&self, role: RoleId) -> &str {
        self.program.role(role)
    }

    fn add(&mut self, order: (u64, PhaseId, usize, Kind), texts: [&str; 3], body: Option<u32>) {
        let texts = texts.map(str::to_owned);
        self.rows.push(LogRow { order, texts, body });
    }

    /// Adds an attempt at a phase. `number` is the number of earlier attempts.
    fn attempt(&mut self, number: usize, bonds: &[BondRecord], waiting: &[WaitRecord]) {
        let opened = bonds
            .iter()
            .map(|it| (it.magnetized, it.phase, it.parent, it.face, it.child));
        let waits = waiting
            .iter()
            .map(|it| (it.magnetized, it.phase, it.parent, it.face, it.child));
        if self.detail == Detail::All {
            for (tick, phase, parent, face, child) in opened.chain(waits) {
                let [by, child] = [
                    format!("{}.{face}", self.role(parent)),
                    self.role(child).into(),
                ];
                self.add(
                    (tick, phase, number, Kind::Opened),
                    ["opened", &child, &by],
                    None,
                );
            }
        }
        for it in bonds {
            let by = format!("{}.{}", self.role(it.parent), it.face);
            let child = self.role(it.child).to_owned();
            let order = (it.docked, it.phase, number, Kind::Captured);
            self.add(order, ["captured", &child, &by], Some(it.body));
        }
    }

    fn releases(&mut self, number: usize, releases: &[ReleaseRecord], kind: Kind) {
        for it in releases {
            let [parent, child] = [it.parent, it.child].map(|role| self.role(role).to_owned());
            let order = (it.tick, it.phase, number, kind);
            self.add(order, ["released", &child, &parent], Some(it.body));
        }
    }

    fn aborts(&mut self, name: &str, aborts: &[&AbortRecord]) {
        for (number, abort) in aborts.iter().enumerate() {
            let order = (abort.tick, abort.phase, number, Kind::Timeout);
            self.add(order, ["timeout", name, ""], None);
            self.attempt(number, &abort.bonds, &abort.waiting);
            self.releases(number, &abort.releases, Kind::Undone);
            if let Some(tick) = abort.retried {
                let order = (tick, abort.phase, number + 1, Kind::Phase);
                self.add(order, ["phase", name, ""], None);
            }
        }
    }
}

/// Returns the items of a phase.
fn of_phase<T: Clone>(items: &[T], is_of_phase: impl Fn(&T) -> bool) -> Vec<T> {
    items.iter().filter(|it| is_of_phase(it)).cloned().collect()
}

fn rows(record: &RunRecord, program: &EnsembleProgram, detail: Detail) -> Vec<LogRow> {
    let mut rows = LogRows {
        program,
        detail,
        rows: Vec::new(),
    };
    let mut began = 0;
    for (number, of) in program.phases().iter().enumerate() {
        let phase = PhaseId(number as u32);
        if of.pre_attached || record.phase_ticks.len() < number {
            continue;
        }
        if detail == Detail::All {
            rows.add(
                (began, phase, 0, Kind::Phase),
                ["phase", &of.name, ""],
                None,
            );
        }
        let aborts: Vec<_> = record
            .aborts
            .iter()
            .filter(|it| it.phase == phase)
            .collect();
        rows.aborts(&of.name, &aborts);
        let bonds = of_phase(&record.bonds, |it| it.phase == phase);
        let waiting = of_phase(&record.waiting, |it| it.phase == phase);
        rows.attempt(aborts.len(), &bonds, &waiting);
        let releases = of_phase(&record.releases, |it| it.phase == phase);
        rows.releases(aborts.len(), &releases, Kind::Released);
        began += record.phase_ticks.get(number).copied().unwrap_or(0);
    }
    for it in &record.unplanned_bonds {
        let by = format!("{}.{}", rows.role(it.parent), it.face);
        let order = (it.tick, it.phase, 0, Kind::Rejected);
        rows.add(order, ["rejected", "", &by], Some(it.body));
    }
    rows.rows.sort_by_key(|row| row.order);
    let last = match record.outcome {
        Outcome::TimedOut {
            phase,
            by: Limit::Timeout,
        } => ["timeout", program.phase(phase), ""],
        _ => ["end", "", ""],
    };
    rows.add((record.ticks, PhaseId(0), 0, Kind::Phase), last, None);
    rows.rows
}

/// Returns a record without the quantities that no log contains.
pub fn without_physics(record: &RunRecord) -> RunRecord {
    let mut record = RunRecord {
        hops: 0,
        faults: Vec::new(),
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
