//! Initial state of the free blocks, at tick 0.
use nalgebra::Vector3;
use stochc_ir::Cell;
use stochc_ir::scene::room::{MIN_SPACING, NoRoom, Obstacles};
use stochc_ir::scene::{Arrangement, Interior, Scene};
use stochc_ir::table::Plate;

use super::motion_limits::FARTHEST;
use super::parameters::WorldParameters;
use super::{BodyState, SceneError};

/// Returns the free blocks of a scene at tick 0, around a plate with these seeds.
pub(super) fn blocks(
    scene: &Scene,
    plate: &Plate,
    seeds: &[Cell],
) -> Result<Vec<BodyState>, SceneError> {
    let parameters = WorldParameters::new(scene, plate)?;
    let count = scene.free.count;
    if count == 0 {
        return Ok(Vec::new());
    }
    let Some(wall) = parameters.wall else {
        return Err(NoRoom::NoEnclosure { count }.into());
    };
    let (inside, arrangement) = (wall.interior, scene.free.arrangement);
    let obstacles = Obstacles::new(scene, plate, seeds);
    inside.has_room(count, arrangement, scene.block.side, &obstacles)?;
    let blocks: Vec<BodyState> = match arrangement {
        Arrangement::Uniform => uniform(inside, count, &obstacles),
        Arrangement::Ring { radius } => {
            let points = inside.ring(radius / scene.block.side, count);
            points.map(|it| BodyState::at_rest(it.into())).collect()
        }
    };
    let distances = blocks.iter().map(|block| block.position.norm());
    let farthest = distances.fold(0.0, f64::max);
    if farthest < FARTHEST {
        Ok(blocks)
    } else {
        Err(SceneError::TooFar { distance: farthest })
    }
}

/// Returns `count` blocks at rest on a regular lattice, aligned with the structure and apart from
/// `obstacles`.
fn uniform(inside: Interior, count: u32, obstacles: &Obstacles) -> Vec<BodyState> {
    let count = count as usize;
    let lattice = |spacing| obstacles.apart(inside.lattice(spacing));
    let fits_all = |spacing| lattice(spacing).take(count).count() == count;
    // The number of points is not quite monotonic in the spacing. Bisection finds one of several
    // nearly equal solutions, and always the same one.
    let (mut fits, mut fails) = (MIN_SPACING, inside.largest_spacing());
    for _ in 0..60 {
        let middle = 0.5 * (fits + fails);
        if fits_all(middle) {
            fits = middle;
        } else {
            fails = middle;
        }
    }
    let points: Vec<_> = lattice(fits).map(Vector3::from).collect();
    // Surplus points are omitted evenly.
    let chosen = (0..count).map(|i| points[i * points.len() / count]);
    chosen.map(BodyState::at_rest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stochc_compiler::scene::built_in;
    use stochc_ir::scene::Enclosure;

    fn start(radius: f64, count: u32) -> Result<Vec<BodyState>, SceneError> {
        let mut scene = built_in("hemisphere").expect("a built-in scene");
        scene.free.count = count;
        if let Some(Enclosure::Hemisphere { radius: own, .. }) = &mut scene.enclosure {
            *own = radius * scene.block.side;
        }
        let plate = Plate { width: 3, depth: 3 };
        blocks(&scene, &plate, &[])
    }

    #[test]
    fn places_as_many_blocks_as_fit() {
        let Err(SceneError::NoRoom(NoRoom::DoesNotFit { fits, .. })) = start(9.0, 100_000) else {
            panic!("100,000 blocks cannot fit in a radius of 9 block lengths");
        };
        assert_eq!(
            start(9.0, fits).map(|blocks| blocks.len()),
            Ok(fits as usize)
        );
        assert_eq!(
            start(9.0, fits + 1),
            Err(SceneError::NoRoom(NoRoom::DoesNotFit {
                count: fits + 1,
                fits
            }))
        );
    }

    #[test]
    fn memory_does_not_grow_with_the_enclosure() {
        let blocks = start(9e4, 300).expect("300 blocks fit");
        assert_eq!(blocks.len(), 300);
        let farthest = blocks.iter().map(|b| b.position.norm()).fold(0.0, f64::max);
        assert!((4.5e4..9e4).contains(&farthest), "{farthest}");
    }

    #[test]
    fn blocks_that_would_start_too_far_away_are_rejected() {
        for radius in [1e6, 1e30] {
            let found = start(radius, 300);
            let Err(SceneError::TooFar { distance }) = found else {
                panic!("{radius}: {found:?}");
            };
            assert!((0.5 * radius..=radius).contains(&distance), "{distance}");
        }
    }
}
