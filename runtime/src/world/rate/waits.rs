//! Cache of waiting times. Equal surroundings occur often.
use std::hash::{Hash, Hasher};

use rustc_hash::FxHashMap;
use stochc_estimate::{Neighbourhood, Rates, Wait, feature_cells};
use stochc_ir::Face;

use super::open_face_hazards::OpenFace;

const MAX_CACHED: usize = 1 << 16;

/// Rate model for the number of blocks that were free at the start. Stores known waiting times.
#[derive(Clone, Debug)]
pub(super) struct RateModel<'r> {
    rates: &'r Rates,
    /// Cells that affect the waiting time of a face, by direction of the face.
    features: [Neighbourhood; 6],
    /// Layer above which all layers are equivalent.
    highest: i32,
    known: FxHashMap<Seen, Wait>,
}

/// Cache key of a waiting time. Contains everything that the waiting time depends on, except the
/// number of free blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Seen {
    near: Neighbourhood,
    /// Packed layer, face direction, rivals, and whether the face has been open since the first
    /// tick.
    others: u64,
}

impl Hash for Seen {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.near.hash(state);
        state.write_u64(self.others);
    }
}

impl<'r> RateModel<'r> {
    pub fn new(rates: &'r Rates) -> RateModel<'r> {
        RateModel {
            rates,
            features: Face::ALL.map(feature_cells),
            // In the lowest layer, a face that points down has different surroundings.
            highest: i32::try_from(rates.profile.len().max(2)).unwrap_or(i32::MAX),
            known: FxHashMap::default(),
        }
    }

    /// Returns the factor that scales all rates if the fraction `part` of the blocks is free.
    pub fn of_free(&self, part: f64) -> f64 {
        self.rates.parameters.of_free(part)
    }

    pub fn wait(&mut self, face: &OpenFace) -> Wait {
        let near = face.near.within(self.features[face.direction as usize]);
        let layer = face.cell.z.min(self.highest);
        let (rivals, is_cold) = (face.rivals, face.since == 0);
        let numbers = [
            face.direction as u8,
            rivals.adjacent,
            rivals.across,
            rivals.around,
        ];
        let numbers = u64::from(u32::from_le_bytes(numbers));
        let others = u64::from(layer as u32) << 33 | u64::from(is_cold) << 32 | numbers;
        let seen = Seen { near, others };
        if let Some(known) = self.known.get(&seen) {
            return *known;
        }
        let rates = self.rates;
        let wait = rates.wait_among(face.cell, face.direction, near, rivals, is_cold);
        if self.known.len() >= MAX_CACHED {
            self.known.clear();
        }
        self.known.insert(seen, wait);
        wait
    }
}
