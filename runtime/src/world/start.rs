//! Where the free blocks are at tick 0.
use nalgebra::Vector3;
use stochc_compiler::scene::{Arrangement, Scene};

use super::terms::Terms;
use super::{BodyState, SceneError};

/// Least distance of a centre from the ground and from the shell \[side\].
const MARGIN: f64 = 1.0;

/// Least spacing of the lattice \[side\]: below it, blocks would touch.
const LEAST_SPACING: f64 = 1.1;

/// The free blocks of a scene at tick 0.
pub(super) fn blocks(scene: &Scene) -> Result<Vec<BodyState>, SceneError> {
    let terms = Terms::new(scene)?;
    uniform(&terms, scene.free.arrangement, scene.free.count)
}

/// `count` blocks at rest, their axes along the structure's.
fn uniform(
    terms: &Terms,
    arrangement: Arrangement,
    count: u32,
) -> Result<Vec<BodyState>, SceneError> {
    let Arrangement::Uniform = arrangement;
    if count == 0 {
        return Ok(Vec::new());
    }
    let Some(hemisphere) = terms.hemisphere else {
        return Err(SceneError::NoEnclosure { count });
    };
    let radius = hemisphere.radius - MARGIN;
    let most = lattice(radius, LEAST_SPACING).len();
    if most < count as usize {
        return Err(SceneError::DoesNotFit {
            count,
            fits: most as u32,
        });
    }
    // The number of sites is not quite monotonic in the spacing, so that the bisection finds one
    // of several nearly equal solutions; always the same one.
    let (mut fits, mut fails) = (LEAST_SPACING, 2.0 * radius + 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (fits + fails);
        if lattice(radius, middle).len() >= count as usize {
            fits = middle;
        } else {
            fails = middle;
        }
    }
    let sites = lattice(radius, fits);
    // Surplus sites are left out evenly.
    let chosen = (0..count as usize).map(|i| sites[i * sites.len() / count as usize]);
    Ok(chosen.map(BodyState::at_rest).collect())
}

/// The sites of a cubic lattice in the half ball, symmetric about the vertical axis, in the order
/// of z, y, x.
fn lattice(radius: f64, spacing: f64) -> Vec<Vector3<f64>> {
    let reach = (radius / spacing) as i64 + 1;
    let mut sites = Vec::new();
    for k in 0..=reach {
        for j in -reach..reach {
            for i in -reach..reach {
                let site = Vector3::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5) * spacing;
                if site.z >= MARGIN && site.norm() <= radius {
                    sites.push(site);
                }
            }
        }
    }
    sites
}
