//! Initial scaffolds that limit the length of capture chains.
use rand::RngExt as _;
use rand::seq::IndexedRandom as _;
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashSet;
use stochc_ir::{Cell, Face};

use super::guides::places_beside;
use super::places::{GrowthSchedule, supports};
use crate::Target;
use crate::scaffold::{MastSegment, Scaffolding};

/// Cost of a new mast \[captures\].
const NEW: f32 = 1.0;

/// Cost of a mast for each other mast that is diagonal to it \[captures\]. The two masts take
/// turns.
const ACROSS: f32 = 1.5;

/// Duration of capturing a mast block next to another mast \[captures\].
const GUIDED: f32 = 0.7;

/// Amplitude of the random cost of a position \[captures\].
const CHANCE: f32 = 2.0;

impl GrowthSchedule {
    /// Returns scaffolds with segments that begin at the far ends of the target. Each segment has
    /// at most the length that its mast allows. Mast positions are partly random.
    ///
    /// Cells at most `limit` captures from the plate need no mast. If `have_guides` is set, each
    /// mast with space gets a guide.
    pub fn balanced(
        &self,
        target: &Target,
        limit: usize,
        have_guides: bool,
        rng: &mut ChaCha8Rng,
    ) -> Scaffolding {
        let effort = |at: Cell| {
            if have_guides && places_beside(target, at).next().is_some() {
                GUIDED * at.z as f32
            } else {
                at.z as f32
            }
        };
        let mut scaffolding = Scaffolding::default();
        let mut held: FxHashSet<Cell> = FxHashSet::default();
        for &(first, depth) in &self.far_first() {
            if depth <= limit {
                break;
            }
            if held.contains(&first) {
                continue;
            }
            let places: Vec<(Cell, Face)> = supports(target, first)
                .filter(|(at, _)| effort(*at) < limit as f32)
                .collect();
            let price = |&(at, _): &(Cell, Face)| {
                let foot = (at.x, at.y);
                let masts = scaffolding.masts();
                let known = masts.iter().find(|(it, _)| *it == foot);
                let across = masts.iter().filter(|(other, _)| {
                    (other.0 - foot.0).abs() == 1 && (other.1 - foot.1).abs() == 1
                });
                let new = if known.is_some() { 0.0 } else { NEW };
                effort(at) + new + ACROSS * across.count() as f32
            };
            let priced = places
                .iter()
                .map(|place| (price(place) + CHANCE * rng.random::<f32>(), *place));
            let cheapest = priced.min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, (at, direction))) = cheapest else {
                continue;
            };
            let mut cells = Vec::new();
            let mut next = Some(first);
            while let Some(cell) = next.filter(|cell| !held.contains(cell)) {
                let is_far =
                    self.depth(cell) > limit && effort(at) + (cells.len() as f32) < limit as f32;
                if !is_far {
                    break;
                }
                cells.push(cell);
                next = self.holder(cell);
            }
            // Cells attached to the plate need no mast.
            let Some(join) = next else { continue };
            held.extend(&cells);
            scaffolding.segments.push(MastSegment {
                foot: (at.x, at.y),
                height: at.z,
                direction,
                cells,
                join,
            });
        }
        if have_guides {
            scaffolding.all_guided(target, rng)
        } else {
            scaffolding
        }
    }

    /// Returns the scaffolds with an additional segment at a random cell of `near`. If `near` is
    /// empty, uses a cell of the target. Returns `None` if none was found.
    pub fn extended(
        &self,
        target: &Target,
        scaffolding: &Scaffolding,
        near: &[Cell],
        rng: &mut ChaCha8Rng,
    ) -> Option<Scaffolding> {
        const DRAWS: usize = 20;
        (0..DRAWS).find_map(|_| {
            let cells = if near.is_empty() {
                target.cells()
            } else {
                near
            };
            let first = *cells.choose(rng)?;
            let places: Vec<(Cell, Face)> = supports(target, first).collect();
            let &(at, direction) = places.choose(rng)?;
            let mut longer = self.extensions(at, direction, first, scaffolding);
            match longer.len() {
                0 => None,
                count => Some(longer.swap_remove(rng.random_range(0..count))),
            }
        })
    }
}
