//! How long each capture waits, by the rates of a scene.
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::{SmallVec, smallvec};
use stochc_ir::{Cell, Face};
use stochc_rates::{HeadStart, Rates, Surroundings, Wait};

use crate::Program;
use crate::plan::{EventId, EventKind};

/// When a cell is full, in levels of the phase: from one to before the other.
type Stay = (u32, u32);

/// What a capture waits for.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureWait {
    /// In the structure as it stands when its turn comes and all captures take equally long, those of the same turn half there.
    pub wait: Wait,
    /// What blocks may do that are released near the open face, in this phase or the one before.
    pub head_starts: Vec<(EventId, HeadStart)>,
}

/// For every capture what it waits for. Releases, and what is attached by hand, have `None`.
pub fn waits(program: &Program, levels: &[u32], rates: &Rates) -> Vec<Option<CaptureWait>> {
    let (plan, layout) = (&program.plan, &program.layout);
    let count = program.scene.as_ref().map_or(1, |scene| scene.free.count);
    let mut full: FxHashMap<Cell, SmallVec<[Stay; 1]>> = FxHashMap::default();
    let mut waits: Vec<Option<CaptureWait>> = vec![None; plan.events.len()];
    // Blocks that are not free when a phase begins.
    let mut bound = 0_i64;
    let mut cold = true;
    let mut released = [Released::default(), Released::default()];
    for phase in &plan.phases {
        let events = || {
            plan.events_of(phase)
                .filter_map(|id| Some((id, layout.cells[id.0 as usize]?)))
        };
        let is_release = |id: EventId| plan.event(id).kind == EventKind::Release;
        let level = |id: EventId| levels[id.0 as usize];
        let mut open: FxHashSet<(u32, Cell, Face)> = FxHashSet::default();
        released.swap(0, 1);
        released[1].clear();
        // How many more are bound when the captures of a level begin.
        let mut more: Vec<i64> = vec![0];
        for (id, cell) in events() {
            more.resize(more.len().max(level(id) as usize + 2), 0);
            more[level(id) as usize + 1] += if is_release(id) { -1 } else { 1 };
            if is_release(id) {
                released[1].entry(cell).or_default().push(id);
                continue;
            }
            let stays = full.entry(cell).or_default();
            stays.push((level(id), u32::MAX));
            if let Some(face) = way(program, id) {
                open.insert((level(id), cell, face));
            }
        }
        for (id, cell) in events() {
            let Some(on) = layout.parents[id.0 as usize].filter(|_| is_release(id)) else {
                continue;
            };
            // The block that goes is the one captured in this phase, or the one from before.
            let since = match phase.events.contains(&on.capture.0) {
                true => level(on.capture),
                false => 0,
            };
            let stays = full.get_mut(&cell).into_iter().flatten();
            for stay in stays.filter(|stay| stay.0 == since) {
                stay.1 = level(id);
            }
        }
        let mut sum = bound;
        for more in &mut more {
            sum += *more;
            *more = sum;
        }
        for (id, cell) in events() {
            let Some(way) = way(program, id).filter(|_| !phase.planted) else {
                continue;
            };
            let level = level(id);
            let stands = |cell: Cell, with_mates: bool| {
                (full.get(&cell).into_iter().flatten()).any(|&(since, until)| {
                    let is_there = since < level || (with_mates && since == level);
                    is_there && level <= until
                })
            };
            let free = 1.0 - more[level as usize] as f64 / f64::from(count.max(1));
            let around = |with_mates: bool| Surroundings {
                free,
                cold: cold && level == 1,
                ..rates.surroundings(
                    cell,
                    way,
                    |near| near != cell && stands(near, with_mates),
                    |near| !with_mates && open.contains(&(level, near, way)),
                )
            };
            let [without, with] = [false, true].map(|mates| rates.wait(&around(mates)));
            waits[id.0 as usize] = Some(CaptureWait {
                wait: Wait {
                    rate: (without.rate * with.rate).sqrt(),
                    docking: (without.docking * with.docking).sqrt(),
                },
                head_starts: head_starts(rates, &released, cell, way),
            });
        }
        for (_, cell) in events() {
            let Some(stays) = full.get_mut(&cell) else {
                continue;
            };
            match stays.iter().any(|&(_, until)| until == u32::MAX) {
                true => *stays = smallvec![(0, u32::MAX)],
                false => drop(full.remove(&cell)),
            }
        }
        bound = more.last().copied().unwrap_or(bound);
        cold &= phase.planted || phase.events.is_empty();
    }
    waits
}

/// The way from the block that captures to the cell.
fn way(program: &Program, id: EventId) -> Option<Face> {
    if program.plan.event(id).kind == EventKind::Release {
        return None;
    }
    Some(program.layout.parents[id.0 as usize]?.face)
}

/// The releases of this phase and of the one before, by the cells that they empty.
type Released = FxHashMap<Cell, SmallVec<[EventId; 1]>>;

/// How far a released block may be to have a head start \[side\].
const NEAR: i32 = 3;

/// What the blocks that were released near an open cell may do, in source order.
fn head_starts(
    rates: &Rates,
    released: &[Released; 2],
    cell: Cell,
    way: Face,
) -> Vec<(EventId, HeadStart)> {
    let mut found = Vec::new();
    if released.iter().all(FxHashMap::is_empty) {
        return found;
    }
    let along = || -NEAR..=NEAR;
    let offsets = along().flat_map(|x| along().flat_map(move |y| along().map(move |z| [x, y, z])));
    for [x, y, z] in offsets {
        let from = Cell::new(
            cell.x.saturating_add(x),
            cell.y.saturating_add(y),
            cell.z.saturating_add(z),
        );
        let Some(start) = rates.head_start(cell, way, from) else {
            continue;
        };
        for phase in released {
            let releases = phase.get(&from).into_iter().flatten();
            found.extend(releases.map(|&release| (release, start)));
        }
    }
    found.sort_unstable_by_key(|(release, _)| *release);
    found
}
