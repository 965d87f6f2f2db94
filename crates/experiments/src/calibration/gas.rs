//! Density profile of the free blocks in a scene without captures.
use std::ops::ControlFlow;

use stochc_ir::scene::Scene;
use stochc_ir::table::Plate;
use stochc_runtime::Settings;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{SceneError, SpatialWorld as _, World as _};

/// Number of ticks before the observation. After these ticks, the initial state at rest no longer
/// matters.
const WARM_UP: u64 = 500;

/// Duration of the observation \[ticks\]. The relative error of a layer's density is then about 2
/// %; with 4000 ticks it would be 7 %.
const TICKS: u64 = 40_000;
/// Interval between two observations \[ticks\].
const EVERY: u64 = 5;

/// Half-width of the observed column above the plate \[block lengths\].
const HALF_WIDTH: f64 = 6.0;

/// Largest number of observed layers of one block length.
const LAYERS: usize = 64;

/// Returns the density of free blocks in each layer above the plate, relative to the mean of the
/// layers. `watch` receives the fraction of the observation that is done. Returns `None` if
/// `watch` stops the observation.
///
/// # Errors
///
/// If the scene cannot be set up.
pub fn profile(
    scene: &Scene,
    settings: &Settings,
    seed: u64,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Option<Vec<f64>>, SceneError> {
    let plate = Plate { width: 3, depth: 3 };
    let mut world = RigidWorld::new(scene, &plate, settings, seed, 0)?;
    let mut layers = vec![0_u64; LAYERS];
    let mut dockings = Vec::new();
    while world.tick() < WARM_UP + TICKS {
        let share = world.tick() as f64 / (WARM_UP + TICKS) as f64;
        if watch(share).is_break() {
            return Ok(None);
        }
        if world.step(&mut dockings).is_err() {
            break;
        }
        if world.tick() > WARM_UP && world.tick().is_multiple_of(EVERY) {
            for block in 0..world.count() {
                let at = world.state(block).position;
                let inside = at.x.abs() < HALF_WIDTH && at.y.abs() < HALF_WIDTH && at.z >= 0.0;
                if let Some(layer) = layers.get_mut(at.z as usize).filter(|_| inside) {
                    *layer += 1;
                }
            }
        }
    }
    let highest = layers
        .iter()
        .rposition(|count| *count > 0)
        .map_or(1, |last| last + 1);
    layers.truncate(highest);
    let mean = layers.iter().sum::<u64>() as f64 / highest as f64;
    let relative = layers.iter().map(|count| *count as f64 / mean.max(1.0));
    Ok(Some(relative.collect()))
}
