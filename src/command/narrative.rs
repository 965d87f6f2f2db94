//! Events of one run, printed as text or JSON.
use std::fmt::Write as _;

use serde_json::json;
use stochc_ir::record::{
    BondRecord, FaultKind, FaultRecord, Limit, Origin, Outcome, ReleaseRecord, RunRecord,
    WaitRecord,
};
use stochc_ir::table::{PhaseId, RoleId};
use stochc_results::{EnsembleProgram, record_json};
use stochc_text::counted;
use stochc_text::{Tick, seconds, visible};

use super::terminal::print;
use crate::exit::{Exit, Failure};
use crate::operations::json::document;

/// Prints the events of each run. Returns [`Exit::UnsuccessfulRun`] if one of the runs did not
/// complete.
pub fn show_runs(
    records: &[(RunRecord, &EnsembleProgram)],
    is_json: bool,
) -> Result<Exit, Failure> {
    if is_json {
        let records = records.iter();
        let records: Vec<_> = records
            .map(|(it, program)| record_json(it, program))
            .collect();
        print(&document(json!({ "runs": records })))?;
    } else {
        for (record, program) in records {
            print(&narrative(record, program))?;
        }
    }
    let mut outcomes = records.iter().map(|(record, _)| &record.outcome);
    Ok(Exit::from_runs(
        outcomes.all(|it| *it == Outcome::Completed),
    ))
}

/// Returns the description of a run in lines: each phase with its events, then the outcome.
fn narrative(record: &RunRecord, program: &EnsembleProgram) -> String {
    let narrator = RunNarrator { record, program };
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{}, run {}", visible(&program.name), record.run);
    let mut begun: u64 = 0;
    for (number, name) in (0..).zip(program.phases().iter().map(|phase| &phase.name)) {
        let (phase, name) = (PhaseId(number), visible(name));
        let ended = record.phase_ticks.get(number as usize);
        let lines = narrator.lines(phase);
        if ended.is_none() && lines.is_empty() {
            break;
        }
        let note = if program.is_pre_attached(phase) {
            ", pre-attached"
        } else {
            ""
        };
        let _ = writeln!(
            out,
            "  phase {name}, from tick {begun}{}{note}",
            narrator.tick().beside(begun as f64)
        );
        for (tick, line) in lines {
            let time = seconds(tick as f64 * program.scene.tick);
            let _ = writeln!(out, "    tick {tick:>7} {time:>8}  {line}");
        }
        begun = begun.saturating_add(*ended.unwrap_or(&0));
    }
    out += &narrator.end();
    out
}

/// Generator of descriptions for the events of a run.
struct RunNarrator<'a> {
    record: &'a RunRecord,
    program: &'a EnsembleProgram,
}

impl RunNarrator<'_> {
    fn tick(&self) -> Tick {
        Tick(self.program.scene.tick)
    }

    fn role(&self, role: RoleId) -> String {
        visible(self.program.role(role))
    }

    /// Returns a number of ticks as text, with the same time in seconds.
    fn ticks(&self, n: u64) -> String {
        counted(n as usize, "tick") + &self.tick().beside(n as f64)
    }

    /// Returns the events of a phase, each with its tick. Captures that were still waiting at the
    /// end of the run come last.
    fn lines(&self, phase: PhaseId) -> Vec<(u64, String)> {
        let record = self.record;
        let bonds = record.all_bonds().filter(|bond| bond.phase == phase);
        let bonds = bonds.map(|bond| (bond.docked, self.capture(bond)));
        let releases = record.all_releases().filter(|it| it.phase == phase);
        let releases = releases.map(|release| (release.tick, self.release(release)));
        let waiting = record.waiting.iter().filter(|wait| wait.phase == phase);
        let waiting = waiting.map(|wait| (record.ticks, self.waiting(wait)));
        let aborts = record.aborts.iter().filter(|abort| abort.phase == phase);
        let retries = aborts.clone().filter_map(|abort| abort.retried);
        let aborts =
            aborts.map(|abort| (abort.tick, "timeout: the captures are released".to_owned()));
        let retries = retries.map(|tick| (tick, "the phase begins again".to_owned()));
        let faults = record.faults.iter().filter(|fault| fault.phase == phase);
        let faults = faults.map(|fault| (fault.tick, self.fault(fault)));
        let lines = bonds.chain(faults).chain(aborts).chain(releases);
        let lines = lines.chain(retries);
        let mut lines: Vec<(u64, String)> = lines.chain(waiting).collect();
        lines.sort_by_key(|&(tick, _)| tick);
        lines
    }

    fn capture(&self, bond: &BondRecord) -> String {
        let entries = match bond.entries {
            // Blocks do not move in this model.
            0 => String::new(),
            entries => format!(" and {}", counted(entries as usize, "entry")),
        };
        let origin = match &bond.origin {
            Origin::Free => String::new(),
            Origin::Released { role, tick } => {
                let role = self.role(*role);
                format!(", the former {role}, released at {tick}")
            }
        };
        format!(
            "{}.{} captures {} after {}{entries}: block {}{origin}",
            self.role(bond.parent),
            bond.face,
            self.role(bond.child),
            self.ticks(bond.docked.saturating_sub(bond.magnetized)),
            bond.body,
        )
    }

    fn fault(&self, fault: &FaultRecord) -> String {
        let (role, body) = (self.role(fault.child), fault.body);
        match fault.kind {
            FaultKind::Dead => format!("a dead block docks as {role}: block {body}"),
            FaultKind::Latch => format!("a latch fails to hold {role}: block {body}"),
        }
    }

    fn release(&self, release: &ReleaseRecord) -> String {
        format!(
            "{} releases {}: block {}",
            self.role(release.parent),
            self.role(release.child),
            release.body
        )
    }

    fn waiting(&self, wait: &WaitRecord) -> String {
        format!(
            "{}.{} still waits for {} after {} and {}",
            self.role(wait.parent),
            wait.face,
            self.role(wait.child),
            self.ticks(self.record.ticks.saturating_sub(wait.magnetized)),
            counted(wait.entries as usize, "entry"),
        )
    }

    fn end(&self) -> String {
        let record = self.record;
        let phase = |phase| visible(self.program.phase(phase));
        let end = match &record.outcome {
            Outcome::Completed => "complete".to_owned(),
            Outcome::TimedOut { phase: of, by } => match by {
                Limit::Timeout => format!("timed out in phase {}", phase(*of)),
                Limit::MaxTicks => format!("stopped by `--max-ticks` in phase {}", phase(*of)),
            },
            Outcome::Failed {
                phase: of, reason, ..
            } => {
                format!("failed in phase {}: {}", phase(*of), visible(reason))
            }
        };
        let mut parts = vec![
            counted(record.all_bonds().count(), "capture")
                + " of "
                + &counted(record.blocks_used as usize, "different block"),
            counted(record.hops as usize, "message hop"),
        ];
        if !record.waiting.is_empty() {
            let waiting = record.waiting.len();
            parts.insert(1, counted(waiting, "capture") + " still waiting");
        }
        let mut out = format!(
            "  {end} after {}; {}\n",
            self.ticks(record.ticks),
            parts.join(", ")
        );
        if record.unplanned > 0 {
            let bonds = counted(record.unplanned as usize, "unplanned bond");
            out += &format!("  {bonds}, undone at once\n");
        }
        let [dead, latches] = [FaultKind::Dead, FaultKind::Latch].map(|it| record.faults_of(it));
        if dead > 0 {
            let times = counted(dead, "time");
            out += &format!("  a dead block docked {times}\n");
        }
        if latches > 0 {
            let times = counted(latches, "time");
            out += &format!("  a latch failed {times}\n");
        }
        out
    }
}
