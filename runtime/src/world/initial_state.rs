//! Where the free blocks are at tick 0.
use nalgebra::Vector3;
use stochc_ir::scene::{Arrangement, Scene};
use stochc_ir::table::Plate;

use super::parameters::{Shell, WorldParameters};
use super::{BodyState, SceneError};

/// Least distance of a centre from the ground and from the shell \[side\].
const MARGIN: f64 = 1.0;

/// Least spacing of the lattice \[side\]: below it, blocks would touch.
const LEAST_SPACING: f64 = 1.1;

/// The free blocks of a scene at tick 0.
pub(super) fn blocks(scene: &Scene, plate: &Plate) -> Result<Vec<BodyState>, SceneError> {
    let parameters = WorldParameters::new(scene, plate)?;
    let count = scene.free.count;
    if count == 0 {
        return Ok(Vec::new());
    }
    let Some(shell) = parameters.shell else {
        return Err(SceneError::NoEnclosure { count });
    };
    match scene.free.arrangement {
        Arrangement::Uniform => uniform(shell, count),
        Arrangement::Ring { radius } => ring(shell, count, radius / scene.block.side),
    }
}

/// `count` blocks at rest on a level circle halfway up, their axes along the structure's, the first in
/// the east.
fn ring(shell: Shell, count: u32, radius: f64) -> Result<Vec<BodyState>, SceneError> {
    let height = shell.halfway();
    let angle = std::f64::consts::TAU / f64::from(count);
    let up = height - shell.height;
    let apart = 2.0 * radius * libm::sin(angle / 2.0);
    let touches = count > 1 && (apart < LEAST_SPACING * std::f64::consts::SQRT_2);
    if touches || radius.hypot(up) > shell.radius || height < MARGIN {
        return Err(SceneError::NoRoomOnRing { count });
    }
    let place = |i: u32| {
        let (sin, cos) = libm::sincos(angle * f64::from(i));
        Vector3::new(radius * cos, radius * sin, height)
    };
    Ok((0..count).map(place).map(BodyState::at_rest).collect())
}

/// `count` blocks at rest, their axes along the structure's.
fn uniform(shell: Shell, count: u32) -> Result<Vec<BodyState>, SceneError> {
    let radius = shell.radius - MARGIN;
    let low = MARGIN - shell.height;
    let lattice = |radius, spacing| lattice(radius, spacing, low, shell.height);
    if !is_roomy(radius, count) {
        let most = lattice(radius, LEAST_SPACING).take(count as usize).count();
        if most < count as usize {
            return Err(SceneError::DoesNotFit {
                count,
                fits: most as u32,
            });
        }
    }
    let fits_all =
        |spacing| lattice(radius, spacing).take(count as usize).count() == count as usize;
    // The number of sites is not quite monotonic in the spacing, so that the bisection finds one
    // of several nearly equal solutions; always the same one.
    let (mut fits, mut fails) = (LEAST_SPACING, 2.0 * radius + 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (fits + fails);
        if fits_all(middle) {
            fits = middle;
        } else {
            fails = middle;
        }
    }
    let sites: Vec<_> = lattice(radius, fits).collect();
    // Surplus sites are left out evenly.
    let chosen = (0..count as usize).map(|i| sites[i * sites.len() / count as usize]);
    Ok(chosen.map(BodyState::at_rest).collect())
}

/// Whether a box in the half ball alone has room for all, so that nothing need be counted: the sites of a wide
/// enclosure at the least spacing may be more than memory holds.
fn is_roomy(radius: f64, count: u32) -> bool {
    let along = |length: f64| (length / LEAST_SPACING - 1.0).max(0.0);
    along(radius).powi(2) * along(radius / 2.0 - MARGIN) > f64::from(count)
}

/// The sites of a cubic lattice in a ball over the ground, symmetric about the vertical axis, in the
/// order of z, y, x; `low` is the least height over the ball's centre, which is at `height`.
fn lattice(radius: f64, spacing: f64, low: f64, height: f64) -> impl Iterator<Item = Vector3<f64>> {
    let reach = (radius / spacing) as i64 + 1;
    let least = if low < 0.0 { -reach } else { 0 };
    let rows = (least..=reach).flat_map(move |k| (-reach..reach).map(move |j| (j, k)));
    rows.flat_map(move |(j, k)| (-reach..reach).map(move |i| [i, j, k]))
        .map(move |site| Vector3::from(site.map(|n| n as f64 + 0.5)) * spacing)
        .filter(move |site| site.z >= low && site.norm() <= radius)
        .map(move |site| site + Vector3::z() * height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stochc_compiler::scene::built_in;
    use stochc_ir::scene::Enclosure;

    fn start(radius: f64, count: u32) -> Result<Vec<BodyState>, SceneError> {
        let mut scene = built_in("hemisphere").expect("built in");
        scene.free.count = count;
        if let Some(Enclosure::Hemisphere { radius: own, .. }) = &mut scene.enclosure {
            *own = radius * scene.block.side;
        }
        let plate = Plate { width: 3, depth: 3 };
        blocks(&scene, &plate)
    }

    #[test]
    fn as_many_as_fit_do_and_one_more_does_not() {
        let Err(SceneError::DoesNotFit { fits, .. }) = start(9.0, 100_000) else {
            panic!("100,000 blocks do not fit into 9 sides");
        };
        assert_eq!(
            start(9.0, fits).map(|blocks| blocks.len()),
            Ok(fits as usize)
        );
        assert_eq!(
            start(9.0, fits + 1),
            Err(SceneError::DoesNotFit {
                count: fits + 1,
                fits
            })
        );
    }

    #[test]
    fn an_enclosure_as_wide_as_a_town_takes_no_more_memory_than_its_blocks() {
        let blocks = start(1e6, 300).expect("there is room");
        assert_eq!(blocks.len(), 300);
        let farthest = blocks.iter().map(|b| b.position.norm()).fold(0.0, f64::max);
        assert!((5e5..1e6).contains(&farthest), "{farthest}");
    }
}
