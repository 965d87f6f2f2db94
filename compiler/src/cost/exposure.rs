//! How open the surroundings of a cell are.
use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};
use stochc_ir::Cell;

use crate::Program;
use crate::plan::EventKind;

/// Sides from a cell at which a direction counts as open.
const FAR: f64 = 8.0;

/// Captures up to which many directions are looked in.
const FINE: usize = 10_000;

/// When a cell is full, in levels of the phase: from one to before the other.
type Stay = (u32, u32);

/// For every capture, the part of all directions from its cell's centre that meet neither a block
/// nor the ground within [`FAR`] sides, in the structure as it stands when the capture's turn comes
/// and all captures take equally long. Releases have `None`.
pub fn exposures(program: &Program, levels: &[u32]) -> Vec<Option<f64>> {
    let (plan, layout) = (&program.plan, &program.layout);
    let rays = rays(if plan.events.len() <= FINE { 8 } else { 4 });
    let mut full: FxHashMap<Cell, SmallVec<[Stay; 1]>> = FxHashMap::default();
    let mut exposures = vec![None; plan.events.len()];
    for phase in &plan.phases {
        let events = || {
            plan.events_of(phase)
                .filter_map(|id| Some((id, layout.cells[id.0 as usize]?)))
        };
        for (id, cell) in events() {
            if plan.event(id).kind != EventKind::Release {
                full.entry(cell)
                    .or_default()
                    .push((levels[id.0 as usize], u32::MAX));
            }
        }
        for (id, cell) in events() {
            let Some(on) =
                layout.parents[id.0 as usize].filter(|_| plan.event(id).kind == EventKind::Release)
            else {
                continue;
            };
            // The block that goes is the one captured in this phase, or the one from before.
            let since = match phase.events.contains(&on.capture.0) {
                true => levels[on.capture.0 as usize],
                false => 0,
            };
            let stays = full.get_mut(&cell).into_iter().flatten();
            for stay in stays.filter(|stay| stay.0 == since) {
                stay.1 = levels[id.0 as usize];
            }
        }
        for (id, cell) in events() {
            // What is attached by hand does not wait.
            if plan.event(id).kind != EventKind::Release && !phase.planted {
                let level = levels[id.0 as usize];
                let is_full = |cell: Cell| {
                    cell.z < 1
                        || (full.get(&cell).into_iter().flatten())
                            .any(|&(since, until)| since < level && level <= until)
                };
                exposures[id.0 as usize] = Some(open_part(cell, &rays, is_full));
            }
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
    }
    exposures
}

/// A direction, with the part of the sphere it stands for.
struct Ray {
    direction: [f64; 3],
    weight: f64,
}

/// Directions through the middles of a grid of `fineness` squares on each face of a cube.
fn rays(fineness: u32) -> Vec<Ray> {
    let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(fineness) * 2.0 - 1.0;
    let mut rays = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            for (u, v) in (0..fineness).flat_map(|i| (0..fineness).map(move |j| (i, j))) {
                let (u, v) = (middle(u), middle(v));
                let length = (1.0 + u * u + v * v).sqrt();
                let mut direction = [0.0; 3];
                direction[axis] = side / length;
                direction[(axis + 1) % 3] = u / length;
                direction[(axis + 2) % 3] = v / length;
                // A square farther from the centre is seen smaller and aslant.
                let weight = length.powi(-3);
                rays.push(Ray { direction, weight });
            }
        }
    }
    let total: f64 = rays.iter().map(|ray| ray.weight).sum();
    rays.iter_mut().for_each(|ray| ray.weight /= total);
    rays
}

fn open_part(cell: Cell, rays: &[Ray], is_full: impl Fn(Cell) -> bool) -> f64 {
    (rays.iter())
        .filter(|ray| is_open(cell, ray.direction, &is_full))
        .map(|ray| ray.weight)
        .sum()
}

/// Follows a ray from the centre of a cell through every cell that it crosses.
fn is_open(cell: Cell, direction: [f64; 3], is_full: impl Fn(Cell) -> bool) -> bool {
    let mut at = <[i32; 3]>::from(cell);
    // The distances at which the ray leaves the cell along each axis, and between two leavings.
    let step = direction.map(|part| 1.0 / part.abs());
    let mut next = step.map(|step| step / 2.0);
    loop {
        let axis = (0..3)
            .min_by(|&a, &b| next[a].total_cmp(&next[b]))
            .unwrap_or(0);
        if next[axis] > FAR {
            return true;
        }
        let toward = if direction[axis] > 0.0 { 1 } else { -1 };
        let Some(moved) = at[axis].checked_add(toward) else {
            return true;
        };
        at[axis] = moved;
        next[axis] += step[axis];
        if is_full(Cell::from(at)) {
            return false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HIGH: Cell = Cell::new(0, 0, 100);

    #[test]
    fn nothing_in_the_way_is_open_to_all_sides() {
        let open = open_part(HIGH, &rays(8), |_| false);
        assert!((open - 1.0).abs() < 1e-12, "{open}");
    }

    #[test]
    fn the_ground_closes_half() {
        let open = open_part(Cell::new(0, 0, 1), &rays(64), |cell| cell.z < 1);
        // All of the upper half, and below it what meets the ground, half a side down, only beyond FAR.
        let exact = 0.5 + 0.5 * (0.5 / FAR);
        assert!((open - exact).abs() < 0.005, "{open} {exact}");
    }

    #[test]
    fn a_neighbour_closes_a_sixth() {
        // Seen from the centre of a cube each face takes a sixth of the sphere.
        let below = Cell::new(0, 0, 99);
        let open = open_part(HIGH, &rays(8), |cell| cell == below);
        assert!((open - 5.0 / 6.0).abs() < 1e-9, "{open}");
    }

    #[test]
    fn a_far_block_closes_its_solid_angle() {
        // A square of side 1 at distance 1.5: 4 asin(1 / (1 + 4 d^2)) of 4 pi.
        let two_up = Cell::new(0, 0, 102);
        let open = open_part(HIGH, &rays(64), |cell| cell == two_up);
        let closed = (1.0 / (1.0 + 4.0 * 1.5f64 * 1.5)).asin() / std::f64::consts::PI;
        assert!((1.0 - open - closed).abs() < 0.002, "{open} {closed}");
    }
}
