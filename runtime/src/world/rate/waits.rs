//! Waits that have been asked for: the same surroundings come again and again.
use std::hash::{Hash, Hasher};

use rustc_hash::FxHashMap;
use stochc_ir::Face;
use stochc_rates::{Neighbourhood, Rates, Wait, feature_cells};

use super::open_face_hazards::OpenFace;

/// Waits that are kept, at most.
const KEPT: usize = 1 << 16;

/// The waits of faces in a gas with as many free blocks as at the beginning.
#[derive(Clone, Debug)]
pub(super) struct RateModel<'r> {
    rates: &'r Rates,
    /// The cells around a face that matter, for faces of each direction.
    features: [Neighbourhood; 6],
    /// Above this one, all layers are alike.
    highest: i32,
    known: FxHashMap<Seen, Wait>,
}

/// All that a wait depends on, but for the number of free blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Seen {
    near: Neighbourhood,
    /// The layer, the direction of the face, its rivals, and whether it has been open since the first tick.
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
            // What is ahead of a face that looks down is different in the lowest one.
            highest: i32::try_from(rates.profile.len().max(2)).unwrap_or(i32::MAX),
            known: FxHashMap::default(),
        }
    }

    /// The factor of all rates when a part of the blocks is still free.
    pub fn of_free(&self, part: f64) -> f64 {
        self.rates.parameters.of_free(part)
    }

    /// The wait of a face.
    pub fn of(&mut self, face: &OpenFace) -> Wait {
        let near = face.near.within(self.features[face.way as usize]);
        let layer = face.cell.z.min(self.highest);
        let (rivals, is_cold) = (face.rivals, face.since == 0);
        let numbers = [face.way as u8, rivals.beside, rivals.across, rivals.around];
        let numbers = u64::from(u32::from_le_bytes(numbers));
        let others = u64::from(layer as u32) << 33 | u64::from(is_cold) << 32 | numbers;
        let seen = Seen { near, others };
        if let Some(known) = self.known.get(&seen) {
            return *known;
        }
        let rates = self.rates;
        let wait = rates.wait_among(face.cell, face.way, near, rivals, is_cold);
        if self.known.len() >= KEPT {
            self.known.clear();
        }
        self.known.insert(seen, wait);
        wait
    }
}
