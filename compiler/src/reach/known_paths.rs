//! Ways out that were found before.
//!
//! Phase after phase, blocks come in by the same door. A way that was found is kept as long as nothing stands
//! in it, so that the next search ends where it meets one.
use rustc_hash::FxHashMap;
use stochc_ir::Cell;

use super::moving_cube::MovingCube;

/// Places from which a cube of one size gets out, whatever the captures of the phase at hand do.
#[derive(Default)]
pub struct KnownPaths {
    /// The next place on the way, itself at the end of it; and the phase for which that was shown.
    next: FxHashMap<Cell, (Cell, u32)>,
    phase: u32,
}

impl KnownPaths {
    /// What stands may be different from now on.
    pub fn begin_phase(&mut self) {
        self.phase += 1;
    }

    /// Whether a known way leads out from a place; what is blocked by now is forgotten.
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
            // What lies behind the block may be good still; what leads to it is not.
            walked.push(here);
        }
        for place in walked {
            if is_out {
                if let Some(way) = self.next.get_mut(&place) {
                    way.1 = self.phase;
                }
            } else {
                self.next.remove(&place);
            }
        }
        is_out
    }

    /// A place that sees the sky.
    pub fn end(&mut self, at: Cell, search: &MovingCube) {
        if is_passable(at, at, search) {
            self.next.insert(at, (at, self.phase));
        }
    }

    /// Keeps the part of a way that leads on to `at`, from where a way out is known.
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

/// Whether a cube gets from one place to the next, or to the sky from the last, when all captures of
/// the phase have happened.
fn is_passable(here: Cell, next: Cell, search: &MovingCube) -> bool {
    let search = MovingCube {
        has: &|_| true,
        ..*search
    };
    if search.is_blocked(here) {
        return false;
    }
    // Steps are to a neighbour, straight up to the next ceiling, or to the sky.
    if next == here {
        return search.sees_sky(here);
    }
    !search.is_blocked(next)
        && (next.z <= here.z.saturating_add(1) || search.rises_to(here, next.z))
}
