//! Runs without a plate: free blocks bond to each other, and no controller is needed.
use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::table::{PhaseId, Tables};

use crate::observe::{ObservedEvent, StepObserver};
use crate::run_error::RunError;
use crate::watch::{Watch, report_tick, resume};
use crate::world::World;

/// Progress of a run towards its largest group.
struct Growth {
    /// Duration of each completed phase \[ticks\].
    phase_ticks: Vec<u64>,
    /// First tick of the current phase.
    began: u64,
    largest: u32,
    /// Events of the phases that have begun since the last call of the observer.
    events: Vec<ObservedEvent>,
}

stochc_ir::state! {
    () Growth;
    values: phase_ticks, began, largest;
    parts: ;
    // Not part of the state: observers receive these events before a state is saved.
    same: events
}

/// Steps a world until its largest group reaches the size in the tables.
///
/// Calls `step_observer` at every tick with the phases that begin there. Phase i ends at the first
/// tick with a group of i + 2 blocks. A phase takes 0 ticks if several sizes are reached at once. A
/// group that breaks later still counts.
///
/// # Errors
///
/// [`RunError::State`], and [`RunError::Cancelled`] if `watch` cancels the run.
pub(crate) fn gather<W: World>(
    tables: &Tables,
    world: &mut W,
    max_ticks: Option<u64>,
    run: u64,
    watch: &mut (impl Watch + ?Sized),
    mut step_observer: impl StepObserver<W>,
) -> Result<RunRecord, RunError> {
    let mut dockings = Vec::new();
    let mut growth = Growth {
        phase_ticks: Vec::new(),
        began: world.tick(),
        largest: 1,
        events: vec![ObservedEvent::Phase(PhaseId(0))],
    };
    let mut is_reported = resume(watch, &mut [&mut growth, world, &mut step_observer])?;
    let outcome = loop {
        let tick = world.tick();
        growth.take_in(world.largest_group(), tick, tables.phases.len());
        // A resumed run has already reported the tick of its saved state.
        let events = std::mem::take(&mut growth.events);
        if !std::mem::take(&mut is_reported) {
            step_observer.observe(world, events);
        }
        let phase = PhaseId(growth.phase_ticks.len() as u32);
        let Some(running) = tables.phases.get(growth.phase_ticks.len()) else {
            break Outcome::Completed;
        };
        let is_late = running
            .timeout
            .is_some_and(|timeout| tick - growth.began >= timeout);
        if let Some(by) = Limit::reached(is_late, tick, max_ticks) {
            break Outcome::TimedOut { phase, by };
        }
        report_tick(watch, tick, phase, &[&growth, world, &step_observer])?;
        dockings.clear();
        if let Err(fault) = world.step(&mut dockings) {
            let reason = fault.to_string();
            break Outcome::Failed {
                phase,
                reason,
                is_broken: false,
            };
        }
    };
    Ok(RunRecord {
        phase_ticks: growth.phase_ticks,
        blocks_used: growth.largest,
        ..RunRecord::without_bonds(run, outcome, world.tick())
    })
}

impl Growth {
    /// Records `largest`, the size of the largest group at `tick`. `phases` is the number of phases
    /// in the run.
    fn take_in(&mut self, largest: u32, tick: u64, phases: usize) {
        self.largest = self.largest.max(largest);
        while self.phase_ticks.len() < phases && self.largest as usize >= self.phase_ticks.len() + 2
        {
            self.phase_ticks.push(tick - self.began);
            self.began = tick;
            if self.phase_ticks.len() < phases {
                let next = PhaseId(self.phase_ticks.len() as u32);
                self.events.push(ObservedEvent::Phase(next));
            }
        }
    }
}
