//! The common scene of all engines. `c/scene.h` defines the same in C.
//!
//! All quantities are in block units: block length 1, mass 1, tick 1.
use rapier3d::glamx::Vec3;

/// Acceleration by the wall per depth \[1 / tick^2\]. It corresponds to 25 N/m on 1 kg, with ticks
/// of 20 ms.
pub const WALL: f32 = 0.01;
/// Rate of the linear drag \[1 / tick\]. It corresponds to 0.5/s, with ticks of 20 ms.
pub const DRAG: f64 = 0.01;
/// Coefficient of friction. The restitution is 0.
pub const FRICTION: f32 = 0.2;

const SEED: u64 = 1;
/// Smallest initial distance of a centre from the ground and the wall \[block lengths\].
const MARGIN: f64 = 1.0;
/// Block length in `hemisphere` \[m\].
const SIDE: f64 = 0.2;

/// Smallest spacing of the initial lattice \[block lengths\].
const MIN_SPACING: f64 = 1.1;

/// Returns the radius of the hemisphere \[block lengths\]. The density equals the density of
/// `hemisphere`, which has 300 blocks.
pub fn radius(blocks: u32) -> f64 {
    25.0 * (f64::from(blocks) / 300.0).cbrt()
}

/// Changes of velocity by the wall, random impulses and drag, once per tick. Excludes contacts.
pub struct Push {
    blocks: u32,
    /// Largest change of speed by a random impulse \[block lengths / tick\].
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

    /// Returns the velocity of a block after wall, random impulse and drag \[block lengths /
    /// tick\].
    pub fn apply(&self, tick: u64, block: u32, position: Vec3, mut velocity: Vec3) -> Vec3 {
        let distance = position.length();
        if distance > self.radius {
            velocity -= position * (WALL * (distance - self.radius) / distance);
        }
        (velocity + self.kick(tick, block)) * self.keep
    }

    /// Returns a random impulse with a uniform speed up to the largest, in an isotropic direction.
    fn kick(&self, tick: u64, block: u32) -> Vec3 {
        let place = 2 * (tick * u64::from(self.blocks) + u64::from(block));
        let (a, b) = (draw(place), draw(place + 1));
        let speed = (self.kick * unit(a >> 32)) as f32;
        let z = 2.0 * unit(a & 0xffff_ffff) - 1.0;
        let across = (1.0 - z * z).sqrt() as f32;
        let (sin, cos) = ((std::f64::consts::TAU * unit(b >> 32)) as f32).sin_cos();
        speed * Vec3::new(across * cos, across * sin, z as f32)
    }

    /// Returns a digest of the random impulses. Drivers with different impulses have different
    /// digests.
    pub fn digest(&self) -> f64 {
        let unit = Push::new(self.blocks, 1.0);
        let kicks = (0..self.blocks).map(|block| unit.kick(7, block));
        digest(kicks.map(|kick| kick.to_array().map(f64::from)))
    }
}

/// Returns a digest of vectors. Drivers with other vectors, or another order, have different
/// digests.
pub fn digest(vectors: impl Iterator<Item = [f64; 3]>) -> f64 {
    let parts = vectors.enumerate().map(|(i, [x, y, z])| {
        let weight = 1.0 + (i % 7) as f64;
        weight * (x + 2.0 * y + 3.0 * z)
    });
    parts.sum()
}

/// Returns the word with index `place` in the sequence of SplitMix64.
fn draw(place: u64) -> u64 {
    let mut z = SEED.wrapping_add(place.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Returns a number in (0, 1) from 32 bits.
fn unit(bits: u64) -> f64 {
    (bits as f64 + 0.5) / 4_294_967_296.0
}

/// Returns the initial positions of the blocks: on the widest cubic lattice with room for all, as
/// in `hemisphere`.
pub fn start(blocks: u32) -> Vec<[f64; 3]> {
    let count = blocks as usize;
    // Round in metres, as the project does. Otherwise, the bisection would end at another spacing.
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
