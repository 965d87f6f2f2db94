//! Loads of the structure's bonds at the end of each phase, in scenes whose bonds break.
use stochc_grammar::{Cancellation, Cancelled, Symbols};
use stochc_ir::scene::Scene;
use stochc_ir::scene::bond_load::{BlocksBeyond, BondLoad, BreakingBonds};

use crate::dependencies::order::Order;
use crate::diagnostic::{Code, Diagnostic};
use crate::expanded::{EventId, EventKind, ExpandedProgram};
use crate::shapes::layout::Layout;

/// Largest number of loads to compute.
const MAX_LOADS: usize = 50_000_000;

/// Largest load of a bond at the end of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseLoad {
    /// Index of the phase.
    pub phase: usize,
    /// Capture that made the bond.
    pub capture: EventId,
    /// Load of the bond.
    pub load: BondLoad,
}

/// Returns the bond with the largest share of its strength at the end of each phase with captured
/// blocks. The order of the events does not matter there. Returns no loads if bonds do not break.
/// Omits the last phases of a program with more than [`MAX_LOADS`] loads.
///
/// # Errors
///
/// [`Cancelled`] if the check was cancelled.
pub fn largest(
    plan: &ExpandedProgram,
    layout: &Layout,
    order: &Order,
    scene: &Scene,
    cancellation: Cancellation<'_>,
) -> Result<Vec<PhaseLoad>, Cancelled> {
    let Some(law) = BreakingBonds::from_scene(scene) else {
        return Ok(Vec::new());
    };
    let (mut loads, mut computed) = (Vec::new(), 0);
    // Captures of all attached blocks. A block comes after its parent.
    let mut attached: Vec<EventId> = Vec::new();
    // The latest capture of each role, if its block is attached.
    let mut holders: Vec<Option<EventId>> = vec![None; plan.roles.count()];
    let mut held = vec![BlocksBeyond::default(); plan.roles.count()];
    for (phase, events) in order.by_phase(plan).into_iter().enumerate() {
        for id in events {
            cancellation.check()?;
            let event = plan.event(id);
            let is_capture = matches!(event.kind, EventKind::Capture { .. });
            holders[event.role.0 as usize] = is_capture.then_some(id);
            attached.extend(is_capture.then_some(id));
        }
        attached.retain(|&id| holders[plan.event(id).role.0 as usize] == Some(id));
        computed += attached.len();
        if computed > MAX_LOADS {
            break;
        }
        for &id in &attached {
            held[plan.event(id).role.0 as usize] = BlocksBeyond::default();
        }
        let mut largest: Option<PhaseLoad> = None;
        for &capture in attached.iter().rev() {
            cancellation.check()?;
            let event = plan.event(capture);
            let EventKind::Capture { parent, face } = event.kind else {
                continue;
            };
            let Some(cell) = layout.cells[capture.0 as usize] else {
                continue;
            };
            let beyond = law.beyond(cell, held[event.role.0 as usize]);
            held[parent.0 as usize].add(beyond, 1);
            let load = law.load(face, cell, beyond);
            // The bond nearest to the plate comes last.
            if largest.is_none_or(|largest| load.share >= largest.load.share) {
                largest = Some(PhaseLoad {
                    phase,
                    capture,
                    load,
                });
            }
        }
        loads.extend(largest);
    }
    Ok(loads)
}

/// Reports the first phase that ends with a load of a bond above its strength.
pub fn check(
    plan: &ExpandedProgram,
    scene: &Scene,
    loads: &[PhaseLoad],
    symbols: &Symbols,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let broken = loads.iter().find(|it| it.load.share > 1.0);
    let (Some(broken), Some(law)) = (broken, BreakingBonds::from_scene(scene)) else {
        return;
    };
    let event = plan.event(broken.capture);
    let name = plan.roles.name(event.role, symbols);
    let title = format!("the bond of `{name}` breaks under the weight of the blocks beyond it");
    let phase = &plan.phases[broken.phase];
    diagnostics.push(
        Diagnostic::new(Code::OverloadedBond, title)
            .label(
                event.location,
                format!("this bond carries {}", law.describe(&broken.load)),
            )
            .label(
                phase.location,
                format!("its load at the end of phase `{}`", phase.name),
            )
            .help(format!(
                "write a larger `strength` in scene `{}`, use blocks and a fluid of similar densities, or build shorter arms",
                scene.name
            )),
    );
}
