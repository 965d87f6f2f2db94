//! Waiting times of captures, from the rates of a scene.
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use stochc_ir::graph::EventId;
use stochc_ir::{Cell, Face, offsets_within};

use super::events::{Events, PhaseEvent, bound};
use super::occupancy::Occupancy;
use crate::{HeadStarts, Neighbourhood, Rates, ReleaseNearby, Surroundings, Wait, feature_cells};

/// Limit on the share of free blocks that one level captures. Above this limit, free blocks count
/// as scarce. Waiting times assume that half of the blocks of a level are captured.
const FEW: f64 = 0.03;

/// Limit on the share of free blocks that a phase captures outside the critical path. Above this
/// limit, free blocks count as scarce. Equal waiting times for all captures are then a poor
/// assumption.
const MANY: f64 = 0.1;

/// Waiting time of a capture, with its conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureWait {
    /// Waiting time at the capture's level. Half of the other captures of this level count as
    /// complete.
    pub wait: Wait,
    /// Share of the initial free blocks that are still free.
    pub free: f64,
    /// Whether free blocks are scarce. This is the case if the capture's level captures more than
    /// the share [`FEW`] of them. It is also the case if the phase captures more than [`MANY`]
    /// outside the critical path.
    pub is_scarce: bool,
    /// Head starts at the open face: the likely captures of blocks that this phase or the previous
    /// one releases nearby.
    pub head_starts: Vec<(EventId, ReleaseNearby)>,
}

/// Returns the waiting time of each capture. Releases and pre-attached blocks have `None`.
pub fn waits(all: &Events<'_>, rates: &Rates) -> Vec<Option<CaptureWait>> {
    let count = all.parts.scene.free.count;
    let mut waits = vec![None; all.parts.graph.events.len()];
    let mut occupancy = Occupancy::default();
    // Number of bound blocks at the start of the phase.
    let mut before = 0;
    let mut cold = true;
    let mut released = [Released::default(), Released::default()];
    let of_releases = rates.head_starts();
    let delayed = all.delayed();
    for phase in all.phases() {
        let events = all.of_phase(phase);
        occupancy.begin(&events);
        released.swap(0, 1);
        released[1] = releases(&events);
        let bound = bound(before, &events);
        let captures = || events.iter().filter_map(|event| Some((event, event.face?)));
        let open: FxHashMap<(u32, Cell), Face> = captures()
            .map(|(event, direction)| ((event.level, event.cell), direction))
            .collect();
        let depth = captures().map(|(event, _)| event.level).max().unwrap_or(0);
        let beside = captures().count() as f64 - f64::from(depth);
        let is_scarce = beside > MANY * (f64::from(count) - before as f64);
        for (event, direction) in captures().filter(|_| !all.is_pre_attached(phase)) {
            let &PhaseEvent { cell, level, .. } = event;
            // Half of the blocks of the same level count as captured.
            let mates = bound[level as usize + 1] - bound[level as usize] - 1;
            let taken = bound[level as usize] as f64 + mates.max(0) as f64 / 2.0;
            let free = 1.0 - taken / f64::from(count.max(1));
            let near = |which: Neighbourhood, with_mates: bool| {
                let is_full = |near| near != cell && occupancy.is_full(near, level, with_mates);
                Neighbourhood::around(which, cell, is_full)
            };
            let wait = |near: Neighbourhood, open_direction: &dyn Fn(Cell) -> Option<Face>| {
                let around = rates.surroundings(cell, direction, near, open_direction);
                rates.wait(&Surroundings {
                    free,
                    cold: cold && level == 1 && !delayed[event.id.0 as usize],
                    ..around
                })
            };
            let with_mates = near(feature_cells(direction), true);
            // Cells that are empty with mates are also empty without them.
            let alone = near(with_mates, false);
            let without = wait(alone, &|near| open.get(&(level, near)).copied());
            let with = wait(with_mates, &|_| None);
            waits[event.id.0 as usize] = Some(CaptureWait {
                wait: without.between(with),
                free,
                is_scarce: is_scarce || mates as f64 > FEW * f64::from(count),
                head_starts: head_starts(of_releases, &released, cell, direction),
            });
        }
        occupancy.end(&events);
        before = bound.last().copied().unwrap_or(before);
        cold &= all.is_pre_attached(phase)
            || (events.is_empty() && all.parts.tables.phases[phase.0 as usize].wait == 0);
    }
    waits
}

/// For each cell, the releases of a phase that empty it.
type Released = FxHashMap<Cell, SmallVec<[EventId; 1]>>;

fn releases(events: &[PhaseEvent]) -> Released {
    let mut released = Released::default();
    for event in events.iter().filter(|event| event.is_release()) {
        released.entry(event.cell).or_default().push(event.id);
    }
    released
}

/// Returns the cells within `reach` of a cell along every axis, including the cell.
pub(super) fn within(cell: Cell, reach: i32) -> impl Iterator<Item = Cell> {
    offsets_within(reach).filter_map(move |offset| cell.offset(offset))
}

/// Largest distance of a released block with a head start \[block lengths\].
const NEAR: i32 = 3;

/// Returns the head starts of blocks that are released near an open cell, in source order.
fn head_starts(
    of_releases: HeadStarts,
    released: &[Released; 2],
    cell: Cell,
    direction: Face,
) -> Vec<(EventId, ReleaseNearby)> {
    let mut found = Vec::new();
    if released.iter().all(FxHashMap::is_empty) {
        return found;
    }
    for from in within(cell, NEAR) {
        let Some(nearby) = of_releases.nearby(cell, direction, from) else {
            continue;
        };
        for phase in released {
            let releases = phase.get(&from).into_iter().flatten();
            found.extend(releases.map(|&release| (release, nearby)));
        }
    }
    found.sort_unstable_by_key(|(release, _)| *release);
    found
}
