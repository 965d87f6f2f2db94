//! Access paths of earlier searches.
//!
//! Blocks of many phases enter through the same opening. A path stays valid until one of its cells
//! is occupied. Later searches can end at a valid path.
use rustc_hash::FxHashMap;
use stochc_ir::Cell;

use super::moving_cube::MovingCube;

/// For a cube of one size, positions with a path to the outside in every order of the current
/// phase.
#[derive(Default)]
pub struct KnownPaths {
    /// Next position on the path, and the phase that proved it. The last position is its own
    /// successor.
    next: FxHashMap<Cell, (Cell, u32)>,
    phase: u32,
}

impl KnownPaths {
    /// Starts a phase. Other cells may be occupied in it.
    pub fn begin_phase(&mut self) {
        self.phase += 1;
    }

    /// Returns whether a known path leads out from a position. Removes the blocked parts of this
    /// path.
    pub fn leads_out(&mut self, at: Cell, search: &MovingCube, steps: &mut u64) -> bool {
        let mut walked = Vec::new();
        let mut here = at;
        let is_out = loop {
            match self.next.get(&here) {
                None => break false,
                Some(&(_, phase)) if phase == self.phase => break true,
                Some(&(next, _)) => {
                    *steps += 1;
                    if !is_passable(here, next, search) {
                        break false;
                    }
                    walked.push(here);
                    if next == here {
                        break true;
                    }
                    here = next;
                }
            }
        };
        if !is_out {
            // The path after the block may still be valid. The path to it is not.
            walked.push(here);
        }
        for place in walked {
            if is_out {
                if let Some(path) = self.next.get_mut(&place) {
                    path.1 = self.phase;
                }
            } else {
                self.next.remove(&place);
            }
        }
        is_out
    }

    /// Adds a position that is open to the sky.
    pub fn end(&mut self, at: Cell, search: &MovingCube) {
        if is_passable(at, at, search) {
            self.next.insert(at, (at, self.phase));
        }
    }

    /// Adds the positions of a found path that ends at `at`, backwards from `at`. Stops at the
    /// first impassable step. Adds nothing if no path out from `at` is known.
    pub fn keep(&mut self, at: Cell, found: &FxHashMap<Cell, Cell>, search: &MovingCube) {
        let mut here = at;
        while self.next.contains_key(&here)
            && let Some(&before) = found.get(&here)
            && before != here
            && is_passable(before, here, search)
        {
            self.next.insert(before, (here, self.phase));
            here = before;
        }
    }
}

/// Returns whether a cube can move from one position to the next, or from the last one to the sky.
/// Assumes that all captures of the phase have happened.
fn is_passable(here: Cell, next: Cell, search: &MovingCube) -> bool {
    let search = MovingCube {
        has: &|_| true,
        ..*search
    };
    if search.is_blocked(here) {
        return false;
    }
    // Steps go to a neighbour, straight up to the next ceiling, or to the sky.
    if next == here {
        return search.sees_sky(here);
    }
    !search.is_blocked(next)
        && (next.z <= here.z.saturating_add(1) || search.rises_to(here, next.z))
}
