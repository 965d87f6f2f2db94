//! Free blocks that bond to each other: a run without a plate, and so without anybody to control it.
use std::ops::ControlFlow;

use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::table::{PhaseId, Tables};

use crate::observe::Event;
use crate::run::{RunError, Watch};
use crate::world::World;

/// Steps a world until its largest group has the size that the tables say; `look` is called at every
/// tick, with the phases that begin there.
///
/// Phase i takes from the end of the one before to the first tick with a group of i + 2 blocks, 0 ticks if
/// several sizes are reached at once. A group that breaks again has been reached all the same.
///
/// # Errors
/// [`RunError::Cancelled`] when `watch` says so.
pub(crate) fn gather<W: World>(
    tables: &Tables,
    world: &mut W,
    max_ticks: Option<u64>,
    run: u64,
    watch: &mut (impl Watch + ?Sized),
    mut look: impl FnMut(&W, &[Event]),
) -> Result<RunRecord, RunError> {
    let mut dockings = Vec::new();
    let mut phase_ticks: Vec<u64> = Vec::new();
    let mut began = world.tick();
    let mut largest = 1;
    let mut events = vec![Event::Phase(PhaseId(0))];
    let outcome = loop {
        let tick = world.tick();
        largest = largest.max(world.largest_group());
        while phase_ticks.len() < tables.phases.len() && largest as usize >= phase_ticks.len() + 2 {
            phase_ticks.push(tick - began);
            began = tick;
            if phase_ticks.len() < tables.phases.len() {
                events.push(Event::Phase(PhaseId(phase_ticks.len() as u32)));
            }
        }
        look(world, &events);
        events.clear();
        let phase = PhaseId(phase_ticks.len() as u32);
        let Some(running) = tables.phases.get(phase_ticks.len()) else {
            break Outcome::Completed;
        };
        let is_late = running
            .timeout
            .is_some_and(|timeout| tick - began >= timeout);
        if let Some(by) = Limit::reached(is_late, tick, max_ticks) {
            break Outcome::TimedOut { phase, by };
        }
        if let ControlFlow::Break(()) = watch.tick(tick, phase) {
            return Err(RunError::Cancelled);
        }
        dockings.clear();
        if let Err(fault) = world.step(&mut dockings) {
            let reason = fault.to_string();
            break Outcome::Failed { phase, reason };
        }
    };
    Ok(RunRecord {
        run,
        outcome,
        ticks: world.tick(),
        phase_ticks,
        blocks_used: largest,
        hops: 0,
        unplanned: 0,
        bonds: Vec::new(),
        waiting: Vec::new(),
        releases: Vec::new(),
        unplanned_bonds: Vec::new(),
    })
}
