//! The common scene of all engines. `c/scene.h` defines the same in C.
//!
//! Everything is in block units: block length 1, mass 1, tick 1.
use rapier3d::glamx::Vec3;

/// Acceleration of the wall per depth \[1 / tick^2\]: 25 N/m on 1 kg at 20 ms a tick.
pub const WALL: f32 = 0.01;
/// Rate of the linear drag \[1 / tick\]: 0.5/s at 20 ms a tick.
pub const DRAG: f64 = 0.01;
/// Restitution is 0.
pub const FRICTION: f32 = 0.2;

const SEED: u64 = 1;
/// Least distance of a centre from the ground and from the wall at the start, in block lengths.
const MARGIN: f64 = 1.0;
/// Block length in `hemisphere` \[m\].
const SIDE: f64 = 0.2;

/// Least spacing of the lattice, in block lengths.
const MIN_SPACING: f64 = 1.1;

/// Returns the radius of the hemisphere in block lengths: that of `hemisphere` for 300 blocks, at
/// the same density.
pub fn radius(blocks: u32) -> f64 {
    25.0 * (f64::from(blocks) / 300.0).cbrt()
}

/// Change of the velocities once per tick, in addition to contacts.
pub struct Push {
    blocks: u32,
    /// Greatest change of speed, in block lengths per tick.
    kick: f64,
    radius: f32,
    keep: f32,
}

impl Push {
    pub fn new(blocks: u32, kick: f64) -> Push {
        Push {
            blocks,
            kick,
            radius: radius(blocks) as f32,
            keep: (-DRAG).exp() as f32,
        }
    }

    /// Returns the velocity of a block, in block lengths per tick, after wall, kick and drag.
    pub fn apply(&self, tick: u64, block: u32, position: Vec3, mut velocity: Vec3) -> Vec3 {
        let distance = position.length();
        if distance > self.radius {
            velocity -= position * (WALL * (distance - self.radius) / distance);
        }
        (velocity + self.kick(tick, block)) * self.keep
    }

    /// Returns a kick with a uniform speed up to the greatest and an isotropic direction.
    fn kick(&self, tick: u64, block: u32) -> Vec3 {
        let place = 2 * (tick * u64::from(self.blocks) + u64::from(block));
        let (a, b) = (draw(place), draw(place + 1));
        let speed = (self.kick * unit(a >> 32)) as f32;
        let z = 2.0 * unit(a & 0xffff_ffff) - 1.0;
        let across = (1.0 - z * z).sqrt() as f32;
        let (sin, cos) = ((std::f64::consts::TAU * unit(b >> 32)) as f32).sin_cos();
        speed * Vec3::new(across * cos, across * sin, z as f32)
    }

    /// Returns a sum that differs if drivers do not draw the same kicks.
    pub fn digest(&self) -> f64 {
        let unit = Push::new(self.blocks, 1.0);
        let kicks = (0..self.blocks).map(|block| unit.kick(7, block));
        digest(kicks.map(|kick| kick.to_array().map(f64::from)))
    }
}

/// Returns a sum that differs if drivers do not have the same vectors in the same order.
pub fn digest(vectors: impl Iterator<Item = [f64; 3]>) -> f64 {
    let parts = vectors.enumerate().map(|(i, [x, y, z])| {
        let weight = 1.0 + (i % 7) as f64;
        weight * (x + 2.0 * y + 3.0 * z)
    });
    parts.sum()
}

/// Returns word number `place` of the sequence SplitMix64.
fn draw(place: u64) -> u64 {
    let mut z = SEED.wrapping_add(place.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Returns 32 bits as a number in (0, 1).
fn unit(bits: u64) -> f64 {
    (bits as f64 + 0.5) / 4_294_967_296.0
}

/// Returns the initial positions: the widest cubic lattice with room for all blocks, as in
/// `hemisphere`.
pub fn start(blocks: u32) -> Vec<[f64; 3]> {
    let count = blocks as usize;
    // Rounded by way of metres, as in the project. The bisection would end elsewhere for another
    // radius.
    let radius = SIDE * radius(blocks) / SIDE - MARGIN;
    let (mut fits, mut fails) = (MIN_SPACING, 2.0 * radius + 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (fits + fails);
        if lattice(radius, middle).len() >= count {
            fits = middle;
        } else {
            fails = middle;
        }
    }
    let sites = lattice(radius, fits);
    (0..count).map(|i| sites[i * sites.len() / count]).collect()
}

fn lattice(radius: f64, spacing: f64) -> Vec<[f64; 3]> {
    let reach = (radius / spacing) as i64 + 1;
    let at = |i: i64| (i as f64 + 0.5) * spacing;
    let mut sites = Vec::new();
    for k in 0..=reach {
        for j in -reach..reach {
            for i in -reach..reach {
                let [x, y, z] = [at(i), at(j), at(k)];
                if z >= MARGIN && (x * x + y * y + z * z).sqrt() <= radius {
                    sites.push([x, y, z]);
                }
            }
        }
    }
    sites
}
