//! Faces available for unplanned captures, in the order of their cells.
use serde::{Deserialize, Serialize};
use stochc_ir::{Cell, Face};

use crate::world::lattice::faces;

/// Largest number of blocks in a chunk of the list.
const MAX: usize = 256;

/// Exposed faces sorted by cell. The list is in chunks of blocks, each with its number of faces.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct ExposedFaces {
    runs: Vec<(u32, Vec<Exposed>)>,
}

/// Exposed faces of one block, one bit each.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Exposed {
    cell: Cell,
    body: u32,
    faces: u8,
}

impl ExposedFaces {
    pub fn len(&self) -> u32 {
        self.runs.iter().map(|(faces, _)| faces).sum()
    }

    /// Sets the exposed faces of the block in a cell. `body` is ignored if `faces` is empty.
    pub fn set(&mut self, cell: Cell, body: u32, faces: u8) {
        let later = (self.runs)
            .partition_point(|(_, run)| run.first().is_some_and(|first| first.cell <= cell));
        let at = later.saturating_sub(1);
        if self.runs.is_empty() {
            self.runs.push((0, Vec::new()));
        }
        let (count, run) = &mut self.runs[at];
        let index = run.binary_search_by_key(&cell, |exposed| exposed.cell);
        let exposed = Exposed { cell, body, faces };
        let before = match index {
            Ok(index) => std::mem::replace(&mut run[index], exposed)
                .faces
                .count_ones(),
            Err(index) => {
                run.insert(index, exposed);
                0
            }
        };
        *count = *count - before + faces.count_ones();
        if faces == 0
            && let Ok(index) | Err(index) = index
        {
            run.remove(index);
        }
        if run.is_empty() {
            self.runs.remove(at);
        } else if run.len() > MAX {
            let second = run.split_off(MAX / 2);
            let faces = second
                .iter()
                .map(|exposed| exposed.faces.count_ones())
                .sum();
            *count -= faces;
            self.runs.insert(at + 1, (faces, second));
        }
    }

    /// Returns the face with this rank, or `None` if there are fewer faces.
    pub fn select(&self, mut rank: u32) -> Option<(u32, Face)> {
        let (_, run) = self.runs.iter().find(|(faces, _)| {
            let is_here = rank < *faces;
            rank -= if is_here { 0 } else { *faces };
            is_here
        })?;
        let mut faces = run
            .iter()
            .flat_map(|exposed| faces(exposed.faces).map(|face| (exposed.body, face)));
        faces.nth(rank as usize)
    }
}
