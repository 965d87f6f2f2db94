//! Phases of a run: their starts, ends, timeouts and retries.
use stochc_ir::record::AbortRecord;
use stochc_ir::table::{Phase, PhaseId};

use super::RunBuilder;
use crate::experiment_log::error::RowError;
use crate::experiment_log::rows::Row;

impl<'l> RunBuilder<'l> {
    pub(super) fn phase(&self) -> &'l Phase {
        &self.log.tables.phases[self.phase.0 as usize]
    }

    /// Returns the end of the running phase \[ticks\]. Returns `None` if events are missing.
    pub(super) fn phase_end(&self) -> Option<u64> {
        let wait = self.attempt_began.saturating_add(self.phase().wait);
        (self.left == 0).then(|| self.last_event.max(wait))
    }

    /// Begins the next phases whose previous phase has ended, unless the log has rows for phases.
    pub(super) fn pass_phases(&mut self) {
        while !self.has_phases
            && let Some(end) = self.phase_end().filter(|end| *end <= self.tick)
            && self.next_phase().is_some()
        {
            self.enter_phase(end);
        }
    }

    pub(super) fn next_phase(&self) -> Option<PhaseId> {
        let next = PhaseId(self.phase.0 + 1);
        ((next.0 as usize) < self.log.tables.phases.len()).then_some(next)
    }

    fn enter_phase(&mut self, tick: u64) {
        self.record.phase_ticks.push(tick - self.began);
        self.phase.0 += 1;
        self.left = self.log.graph.events_of(self.phase).count();
        self.earlier_bonds = self.record.bonds.len();
        self.began = tick;
        self.begin_attempt(tick);
    }

    fn begin_attempt(&mut self, tick: u64) {
        self.attempt_began = tick;
        self.last_event = tick;
    }

    pub(super) fn begin_phase(&mut self, row: &Row) -> Result<(), RowError> {
        let log = self.log;
        let name = log.phase_name(&row.block)?;
        let running = self.log.phase(self.phase);
        if self.is_aborting {
            return self.retry(name);
        }
        let is_first = self.record.bonds.len() == self.log.start.bonds.len()
            && self.record.releases.is_empty()
            && self.tick == 0;
        if name == running && is_first {
            return Ok(());
        }
        if self.left > 0 {
            return Err(RowError::Phase(format!(
                "phase `{name}` cannot begin: {}",
                self.missing()
            )));
        }
        match self.next_phase() {
            Some(next) if self.log.phase(next) == name => {
                self.enter_phase(self.tick);
                Ok(())
            }
            Some(next) => Err(RowError::Phase(format!(
                "phase `{name}` does not follow phase `{running}`; the next phase is `{}`",
                self.log.phase(next)
            ))),
            None => Err(RowError::Phase(format!(
                "phase `{name}` does not follow phase `{running}`, which is the last phase",
            ))),
        }
    }

    fn retry(&mut self, name: &str) -> Result<(), RowError> {
        let running = self.log.phase(self.phase);
        let Some(abort) = self.record.aborts.last_mut() else {
            return Ok(());
        };
        if name != running {
            return Err(RowError::Phase(format!(
                "phase `{name}` cannot begin: phase `{running}` has timed out and begins again"
            )));
        }
        if abort.releases.len() < abort.bonds.len() {
            return Err(RowError::Phase(format!(
                "phase `{running}` cannot begin again: {} of its {} captures have been released",
                abort.releases.len(),
                abort.bonds.len()
            )));
        }
        abort.retried = Some(self.tick);
        self.is_aborting = false;
        self.begin_attempt(self.tick);
        Ok(())
    }

    pub(super) fn abort(&mut self, row: &Row) -> Result<(), RowError> {
        let log = self.log;
        let name = log.phase_name(&row.block)?;
        self.pass_phases();
        let running = self.log.phase(self.phase);
        if name != running || self.is_aborting {
            return Err(RowError::Phase(format!(
                "phase `{name}` cannot time out: phase `{running}` {}",
                if self.is_aborting {
                    "has timed out already"
                } else {
                    "is running"
                }
            )));
        }
        if self.phase().timeout.is_none() {
            return Err(RowError::Phase(format!(
                "phase `{running}` cannot time out: it has no `timeout` in the program"
            )));
        }
        let retries = self.phase().recovery.map_or(0, |recovery| recovery.retries);
        if self.record.retries(self.phase) >= u64::from(retries) {
            self.is_timed_out = true;
            self.ended = Some(row.line);
            return Ok(());
        }
        self.record.aborts.push(AbortRecord {
            phase: self.phase,
            began: self.attempt_began,
            tick: self.tick,
            retried: None,
            bonds: self.record.bonds.split_off(self.earlier_bonds),
            waiting: self.waiting(),
            releases: Vec::new(),
        });
        self.is_aborting = true;
        self.left = 0;
        for id in self.log.graph.events_of(self.phase) {
            self.happened[id.0 as usize] = None;
            self.opened[id.0 as usize] = None;
            self.left += 1;
        }
        Ok(())
    }
}
