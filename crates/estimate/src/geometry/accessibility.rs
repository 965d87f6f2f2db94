//! Accessible fraction of a magnetized face's surroundings.
use std::cell::RefCell;
use std::sync::LazyLock;

use rustc_hash::FxHashMap;
use stochc_ir::{Cell, Face};

use crate::geometry::neighbourhood::{CELLS, Neighbourhood, SIGHT, all, index};

/// Number of grid points across the sphere around a face.
const ACROSS: usize = 16;

/// Number of grid points in the sphere.
const POINTS: usize = 2176;

/// Number of words of a bit set of points, a multiple of [`AT_ONCE`].
const WORDS: usize = POINTS.div_ceil(64).next_multiple_of(AT_ONCE);

/// Number of words processed together.
const AT_ONCE: usize = 12;

/// Radius of the sphere around the centre of the face \[block lengths\].
pub(crate) const RADIUS: f64 = 1.35;

/// Smallest distance of an unobstructed point from a block's surface \[block lengths\].
const CLEARANCE: f64 = 0.35;

/// Bit set of points.
type Points = [u64; WORDS];

/// Offsets of the cells that may block a face of one direction, relative to its open cell. Each
/// cell has the set of points that it blocks.
type Blockers = Vec<([i32; 3], Points)>;

/// Capacity of the cache.
const MAX_CACHED: usize = 1 << 16;

thread_local! {
    /// Cache of results, because the same surroundings occur often.
    static KNOWN: RefCell<FxHashMap<(Face, Neighbourhood), f64>> = RefCell::default();
}

/// Returns the fraction of the sphere around a face that blocks and ground leave open, from 0 to 1.
///
/// `direction` is the direction from the capturing block to the open cell, which is the centre of
/// `around`.
pub(crate) fn unobstructed(direction: Face, around: Neighbourhood) -> f64 {
    let around = around.within(in_reach(direction));
    KNOWN.with_borrow_mut(|known| {
        if known.len() >= MAX_CACHED {
            known.clear();
        }
        *(known.entry((direction, around))).or_insert_with(|| left_open(direction, around))
    })
}

fn left_open(direction: Face, around: Neighbourhood) -> f64 {
    let mut blocked: Points = [0; WORDS];
    let (blockers, numbers) = (&BLOCKERS[direction as usize], &NUMBERS[direction as usize]);
    let (all_words, _) = blocked.as_chunks_mut::<AT_ONCE>();
    for (part, words) in all_words.iter_mut().enumerate() {
        // Kept in registers.
        let mut found = [0; AT_ONCE];
        for index in around.indices() {
            let (_, points) = &blockers[usize::from(numbers[index])];
            let (more, _) = points.as_chunks::<AT_ONCE>();
            for (word, more) in found.iter_mut().zip(&more[part]) {
                *word |= more;
            }
        }
        *words = found;
    }
    let count: u32 = blocked.iter().map(|word| word.count_ones()).sum();
    1.0 - f64::from(count) / POINTS as f64
}

/// Returns whether a block in the cell `other` can affect the waiting time of a face. The face is
/// open to the cell `open`.
pub fn sees(open: Cell, other: Cell) -> bool {
    let near = |a: i32, b: i32| a.abs_diff(b) <= SIGHT.unsigned_abs();
    near(open.x, other.x) && near(open.y, other.y) && near(open.z, other.z)
}

/// Returns the offsets of the cells that can affect a face of a direction, relative to its open
/// cell.
pub fn offsets(direction: Face) -> impl Iterator<Item = [i32; 3]> {
    BLOCKERS[direction as usize]
        .iter()
        .map(|(offset, _)| *offset)
}

/// Returns the cells of a neighbourhood that can block a face of a direction.
pub(crate) fn in_reach(direction: Face) -> Neighbourhood {
    IN_REACH[direction as usize]
}

static IN_REACH: LazyLock<[Neighbourhood; 6]> =
    LazyLock::new(|| Face::ALL.map(|direction| Neighbourhood::from_cells(offsets(direction))));

static BLOCKERS: LazyLock<[Blockers; 6]> = LazyLock::new(|| {
    let blocked = blocked_from_east();
    Face::ALL.map(|direction| blockers(direction, &blocked))
});

/// For each direction and each cell of a neighbourhood, the index of the cell in [`BLOCKERS`].
static NUMBERS: LazyLock<[[u8; CELLS]; 6]> = LazyLock::new(|| {
    Face::ALL.map(|direction| {
        let mut numbers = [0; CELLS];
        for (number, offset) in (0..).zip(offsets(direction)) {
            numbers[index(offset)] = number;
        }
        numbers
    })
});

/// Returns the set of points that each cell of a neighbourhood blocks, for the direction east.
fn blocked_from_east() -> Vec<Points> {
    let mut blocked = vec![[0; WORDS]; CELLS];
    for (number, point) in points(Face::East).into_iter().enumerate() {
        for offset in near(point).filter(|offset| distance(point, *offset) < CLEARANCE) {
            blocked[index(offset)][number / 64] |= 1 << (number % 64);
        }
    }
    blocked
}

/// Returns the cells that may block a face. `blocked` are the points that each cell blocks for the
/// direction east. The grid of points is the same for all directions, turned.
fn blockers(direction: Face, blocked: &[Points]) -> Blockers {
    let (axis, sign) = axis(direction);
    let turned = |offset: [i32; 3]| {
        let [along, u, v] = [axis, axis + 1, axis + 2].map(|axis| offset[axis % 3]);
        [sign as i32 * along, u, v]
    };
    let mut found: Blockers = all()
        .map(|offset| (offset, blocked[index(turned(offset))]))
        .filter(|(_, points)| points.iter().any(|word| *word != 0))
        .collect();
    // Nearest first, since they block most.
    found.sort_by_key(|(offset, _)| offset.iter().map(|part| part * part).sum::<i32>());
    found
}

/// Returns the cells of a neighbourhood whose cubes lie within [`CLEARANCE`] of a point along each
/// axis. This is much faster than the distance from every cell.
fn near(point: [f64; 3]) -> impl Iterator<Item = [i32; 3]> {
    let reach = 0.5 + CLEARANCE;
    let [x, y, z] = point.map(|at| {
        let (first, last) = ((at - reach).ceil() as i32, (at + reach).floor() as i32);
        first.max(-SIGHT)..=last.min(SIGHT)
    });
    x.flat_map(move |x| {
        let z = z.clone();
        y.clone()
            .flat_map(move |y| z.clone().map(move |z| [x, y, z]))
    })
}

/// Returns the distance of a point from the cube in a cell. Both are given relative to the centre
/// of the open cell.
fn distance(point: [f64; 3], cell: [i32; 3]) -> f64 {
    let outside = |axis: usize| ((point[axis] - f64::from(cell[axis])).abs() - 0.5).max(0.0);
    let squares: f64 = (0..3).map(|axis| outside(axis) * outside(axis)).sum();
    libm::sqrt(squares)
}

/// Returns the points of a cubic grid in the sphere, relative to the centre of the open cell. The
/// grid is invariant under quarter turns, so rotated surroundings give equal results.
fn points(direction: Face) -> Vec<[f64; 3]> {
    let (axis, sign) = axis(direction);
    let step = 2.0 * RADIUS / ACROSS as f64;
    let at = |i: usize| (i as f64 + 0.5) * step - RADIUS;
    let mut points = Vec::new();
    for (i, j, k) in
        (0..ACROSS).flat_map(|i| (0..ACROSS).flat_map(move |j| (0..ACROSS).map(move |k| (i, j, k))))
    {
        let [along, u, v] = [at(i), at(j), at(k)];
        if along * along + u * u + v * v < RADIUS * RADIUS {
            let mut point = [0.0; 3];
            point[axis] = sign * (along - 0.5);
            point[(axis + 1) % 3] = u;
            point[(axis + 2) % 3] = v;
            points.push(point);
        }
    }
    points
}

/// Returns the axis of a direction, and its sign.
fn axis(direction: Face) -> (usize, f64) {
    match direction {
        Face::East => (0, 1.0),
        Face::West => (0, -1.0),
        Face::North => (1, 1.0),
        Face::South => (1, -1.0),
        Face::Up => (2, 1.0),
        Face::Down => (2, -1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HIGH: Cell = Cell::new(0, 0, 50);

    fn with(cell: Cell, direction: Face, full: &[Cell]) -> f64 {
        unobstructed(
            direction,
            Neighbourhood::new(cell, |cell| full.contains(&cell)),
        )
    }

    #[test]
    fn the_sphere_has_the_counted_points() {
        assert_eq!(points(Face::Up).len(), POINTS);
    }

    #[test]
    fn only_near_cells_are_within_the_clearance() {
        for point in Face::ALL.into_iter().flat_map(points) {
            let is_close = |offset: &[i32; 3]| distance(point, *offset) < CLEARANCE;
            assert!(all().filter(is_close).eq(near(point).filter(is_close)));
        }
    }

    #[test]
    fn each_cell_blocks_the_points_within_the_clearance() {
        for direction in Face::ALL {
            for (number, point) in points(direction).into_iter().enumerate() {
                for (offset, points) in &BLOCKERS[direction as usize] {
                    let is_blocked = points[number / 64] >> (number % 64) & 1 == 1;
                    assert_eq!(is_blocked, distance(point, *offset) < CLEARANCE);
                }
            }
        }
    }

    #[test]
    fn an_empty_neighbourhood_is_fully_open() {
        assert_eq!(with(HIGH, Face::Up, &[]), 1.0);
    }

    #[test]
    fn the_block_that_captures_takes_its_own_volume_with_the_clearance() {
        let below = HIGH.across(Face::Down).expect("there is one");
        let open = with(HIGH, Face::Up, &[below]);
        // By a fine grid over the sphere.
        let n = 120;
        let (mut inside, mut blocked) = (0, 0);
        for i in 0..n * n * n {
            let at = |i: usize| ((i % n) as f64 + 0.5) / n as f64 * 2.0 * RADIUS - RADIUS;
            let point = [at(i), at(i / n), at(i / n / n)];
            if point.iter().map(|part| part * part).sum::<f64>() < RADIUS * RADIUS {
                inside += 1;
                let seen = [point[0], point[1], point[2] - 0.5];
                blocked += usize::from(distance(seen, [0, 0, -1]) < CLEARANCE);
            }
        }
        let exact = 1.0 - blocked as f64 / inside as f64;
        assert!((open - exact).abs() < 0.02, "{open} {exact}");
    }

    #[test]
    fn accessibility_is_isotropic() {
        // A wall to one side of the open cell, for every face and each of its four sides.
        let mut seen = Vec::new();
        for direction in Face::ALL {
            let parent = HIGH.across(direction.opposite()).expect("there is one");
            for side in Face::ALL {
                if side != direction && side != direction.opposite() {
                    let wall = HIGH.across(side).expect("there is one");
                    seen.push(with(HIGH, direction, &[parent, wall]));
                }
            }
        }
        assert_eq!(seen.len(), 24);
        assert!(seen.iter().all(|open| *open == seen[0]), "{seen:?}");
    }

    #[test]
    fn more_blocks_never_increase_accessibility() {
        let parent = HIGH.across(Face::Down).expect("there is one");
        let mut full = vec![parent];
        let mut open = with(HIGH, Face::Up, &full);
        for offset in offsets(Face::Up) {
            full.push(Cell::new(offset[0], offset[1], 50 + offset[2]));
            let less = with(HIGH, Face::Up, &full);
            assert!(less <= open);
            open = less;
        }
        assert!(open < 0.05, "{open}");
    }
}
