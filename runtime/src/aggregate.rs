//! Free blocks that bond to each other: a run without a plate, and so without anybody to control it.
use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::table::{PhaseId, Tables};

use crate::observe::{ObservedEvent, StepObserver};
use crate::run_error::RunError;
use crate::watch::{Watch, resume, tell};
use crate::world::World;

/// How far the groups of a run have grown.
struct Growth {
    /// Ticks that each phase took.
    phase_ticks: Vec<u64>,
    /// When the running one began.
    began: u64,
    /// The size of the largest group so far.
    largest: u32,
    /// Phases that have begun since they were last told of.
    events: Vec<ObservedEvent>,
}

stochc_ir::state! {
    () Growth;
    values: phase_ticks, began, largest;
    parts: ;
    // They are told of before a state is kept.
    same: events
}

/// Steps a world until its largest group has the size that the tables say; `step_observer` is shown every
/// tick, with the phases that begin there.
///
/// Phase i takes from the end of the one before to the first tick with a group of i + 2 blocks, 0 ticks if
/// several sizes are reached at once. A group that breaks again has been reached all the same.
///
/// # Errors
/// [`RunError::State`], and [`RunError::Cancelled`] by `watch`.
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
    let mut is_told = resume(watch, &mut [&mut growth, world, &mut step_observer])?;
    let outcome = loop {
        let tick = world.tick();
        growth.take_in(world.largest_group(), tick, tables.phases.len());
        // Of a tick at which the state was kept it has been told before.
        let events = std::mem::take(&mut growth.events);
        if !std::mem::take(&mut is_told) {
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
        tell(watch, (tick, phase), &[&growth, world, &step_observer])?;
        dockings.clear();
        if let Err(fault) = world.step(&mut dockings) {
            let reason = fault.to_string();
            break Outcome::Failed { phase, reason };
        }
    };
    Ok(RunRecord {
        phase_ticks: growth.phase_ticks,
        blocks_used: growth.largest,
        ..RunRecord::without_bonds(run, outcome, world.tick())
    })
}

impl Growth {
    /// Takes in the size of the largest group at a tick, of a run with so many phases.
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
