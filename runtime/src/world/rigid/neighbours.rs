//! Which blocks may touch: a list that holds until one of them has moved too far (Verlet 1967).
use nalgebra::Vector3;

use super::bodies::Bodies;
use crate::world::real::Real;

/// Farther apart than this \[side\], the centres of two cubes: they do not touch.
pub(super) const TOUCH: f64 = 1.732_050_9;

/// How much farther the list looks \[side\]. More means longer lists, less often made.
const SKIN: f64 = 2.0;

/// At most this many cells per block, so that a few blocks far out cost no memory.
const CELLS_PER_BLOCK: usize = 8;

/// Pairs of blocks that may touch.
#[derive(Clone, Debug)]
pub(super) struct Neighbours<R: Real> {
    /// Where each block was when the list was made.
    origin: [Vec<R>; 3],
    pairs: Vec<(u32, u32)>,
    skin: R,
    grid: Grid<R>,
}

/// The blocks sorted by cells of a regular grid.
#[derive(Clone, Debug)]
struct Grid<R: Real> {
    low: [R; 3],
    /// Edge of a cell \[side\].
    edge: R,
    size: [usize; 3],
    /// Where each cell begins in `blocks`, and where the last one ends.
    begins: Vec<u32>,
    blocks: Vec<Entry<R>>,
    /// The cell of each block by number.
    cell: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Entry<R> {
    position: [R; 3],
    id: u32,
}

impl<R: Real> Neighbours<R> {
    pub fn new(count: usize) -> Neighbours<R> {
        Neighbours {
            // Nowhere: the first look at it finds the list out of date.
            origin: std::array::from_fn(|_| vec![R::of(f64::from(f32::MAX)); count]),
            pairs: Vec::new(),
            skin: R::of(SKIN),
            grid: Grid {
                low: [R::zero(); 3],
                edge: R::one(),
                size: [0; 3],
                begins: Vec::new(),
                blocks: Vec::new(),
                cell: Vec::new(),
            },
        }
    }

    /// Where each block was when the list was made.
    pub fn origin(&self) -> &[Vec<R>; 3] {
        &self.origin
    }

    /// Square of the distance that a block may move before the list is out of date.
    pub fn slack(&self) -> R {
        let slack = self.skin * R::of(0.499);
        slack * slack
    }

    /// Whether any block has moved so far that the list is out of date.
    pub fn is_stale(&self, position: &[Vec<R>; 3]) -> bool {
        let slack = self.slack();
        let ([px, py, pz], [ox, oy, oz]) = (position, &self.origin);
        let count = ox.len();
        let (px, py, pz) = (&px[..count], &py[..count], &pz[..count]);
        let (oy, oz) = (&oy[..count], &oz[..count]);
        let mut stale = 0u32;
        for i in 0..count {
            let (x, y, z) = (px[i] - ox[i], py[i] - oy[i], pz[i] - oz[i]);
            // What is not a number has left.
            stale |= u32::from(!(x * x + y * y + z * z < slack));
        }
        stale != 0
    }

    /// Whether a block has moved so far that the list is out of date.
    pub fn has_left(&self, i: usize, now: Vector3<R>) -> bool {
        let [x, y, z] = &self.origin;
        let moved = now - Vector3::new(x[i], y[i], z[i]);
        // What is not a number has left.
        !(moved.norm_squared() < self.slack())
    }

    /// The pairs of blocks, at least one of them free, whose centres may be closer than [`TOUCH`].
    pub fn pairs(&self) -> &[(u32, u32)] {
        &self.pairs
    }

    /// Makes the list anew.
    pub fn renew(&mut self, bodies: &Bodies<R>) {
        for (origin, position) in self.origin.iter_mut().zip(&bodies.position) {
            origin.copy_from_slice(position);
        }
        self.grid.sort(bodies, R::of(TOUCH) + self.skin);
        self.pairs.clear();
        let reach = R::of(TOUCH) + self.skin;
        self.grid.close_pairs(reach * reach, |a, b| {
            if bodies.is_free(a as usize) || bodies.is_free(b as usize) {
                self.pairs.push((a, b));
            }
        });
    }

    /// The blocks that may come closer than `reach` to `centre` while the list holds, in rising order.
    pub fn around(&self, centre: [R; 3], reach: R) -> Vec<u32> {
        let reach = reach + self.skin * R::of(0.5);
        let mut found = Vec::new();
        self.grid.within(centre, reach, |id| found.push(id));
        found.sort_unstable();
        found
    }
}

impl<R: Real> Grid<R> {
    fn sort(&mut self, bodies: &Bodies<R>, reach: R) {
        let count = bodies.count();
        let mut high = [R::zero(); 3];
        for axis in 0..3 {
            let (mut least, mut most) = (R::of(f64::from(f32::MAX)), R::of(f64::from(f32::MIN)));
            for &x in &bodies.position[axis] {
                least = if x < least { x } else { least };
                most = if x > most { x } else { most };
            }
            self.low[axis] = least;
            high[axis] = most;
        }
        self.edge = reach;
        let cells = |edge: R, axis: usize| {
            let span = ((high[axis] - self.low[axis]) / edge).double();
            if span > 0.0 { span as usize + 1 } else { 1 }
        };
        loop {
            self.size = [0, 1, 2].map(|axis| cells(self.edge, axis));
            let total = self.size.iter().try_fold(1usize, |n, &s| n.checked_mul(s));
            if total.is_some_and(|total| total <= count * CELLS_PER_BLOCK + 64) {
                break;
            }
            self.edge *= R::of(1.25);
        }
        let total = self.size.iter().product::<usize>();
        self.begins.clear();
        self.begins.resize(total + 1, 0);
        self.cell.clear();
        for i in 0..count {
            let cell = self.cell_of([0, 1, 2].map(|axis| bodies.position[axis][i]));
            self.cell.push(cell as u32);
            self.begins[cell + 1] += 1;
        }
        for cell in 0..total {
            self.begins[cell + 1] += self.begins[cell];
        }
        let nowhere = Entry {
            position: [R::zero(); 3],
            id: 0,
        };
        self.blocks.clear();
        self.blocks.resize(count, nowhere);
        let mut next = self.begins.clone();
        for i in 0..count {
            let at = &mut next[self.cell[i] as usize];
            self.blocks[*at as usize] = Entry {
                position: [0, 1, 2].map(|axis| bodies.position[axis][i]),
                id: i as u32,
            };
            *at += 1;
        }
    }

    fn cell_of(&self, position: [R; 3]) -> usize {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let offset = ((position[axis] - self.low[axis]) / self.edge).double();
            (offset.max(0.0) as usize).min(self.size[axis] - 1)
        });
        (z * self.size[1] + y) * self.size[0] + x
    }

    /// Every pair closer than the square root of `reach`, once.
    fn close_pairs(&self, reach: R, mut visit: impl FnMut(u32, u32)) {
        let [nx, ny, nz] = self.size;
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    let row = (z * ny + y) * nx;
                    let cell = row + x;
                    let own = self.begins[cell] as usize..self.begins[cell + 1] as usize;
                    if own.is_empty() {
                        continue;
                    }
                    let (left, right) = (x.saturating_sub(1), (x + 1).min(nx - 1));
                    // Half of the 26 cells around: the next one, the row behind, the layer above.
                    let mut rows = [(0, 0); 5];
                    rows[0] = (cell + 1, row + right);
                    let mut n = 1;
                    let mut add = |y: usize, z: usize| {
                        let row = (z * ny + y) * nx;
                        rows[n] = (row + left, row + right);
                        n += 1;
                    };
                    if y + 1 < ny {
                        add(y + 1, z);
                    }
                    if z + 1 < nz {
                        if y > 0 {
                            add(y - 1, z + 1);
                        }
                        add(y, z + 1);
                        if y + 1 < ny {
                            add(y + 1, z + 1);
                        }
                    }
                    for i in own.clone() {
                        let a = &self.blocks[i];
                        let mut look = |others: &[Entry<R>]| {
                            for b in others {
                                if a.distance(b) < reach {
                                    visit(a.id, b.id);
                                }
                            }
                        };
                        look(&self.blocks[i + 1..own.end]);
                        for &(first, last) in &rows[..n] {
                            if first <= last {
                                let from = self.begins[first] as usize;
                                look(&self.blocks[from..self.begins[last + 1] as usize]);
                            }
                        }
                    }
                }
            }
        }
    }

    /// Every block closer than `reach` to a place.
    fn within(&self, centre: [R; 3], reach: R, mut visit: impl FnMut(u32)) {
        if self.blocks.is_empty() {
            return;
        }
        let range = |axis: usize| {
            let at = |side: R| {
                let offset = ((centre[axis] + side - self.low[axis]) / self.edge).double();
                (offset.max(0.0) as usize).min(self.size[axis] - 1)
            };
            at(-reach)..=at(reach)
        };
        let here = Entry {
            position: centre,
            id: 0,
        };
        for z in range(2) {
            for y in range(1) {
                let row = (z * self.size[1] + y) * self.size[0];
                let first = self.begins[row + *range(0).start()] as usize;
                let last = self.begins[row + *range(0).end() + 1] as usize;
                for entry in &self.blocks[first..last] {
                    if entry.distance(&here) < reach * reach {
                        visit(entry.id);
                    }
                }
            }
        }
    }
}

impl<R: Real> Entry<R> {
    fn distance(&self, other: &Entry<R>) -> R {
        let [x, y, z] = [0, 1, 2].map(|axis| self.position[axis] - other.position[axis]);
        x * x + y * y + z * z
    }
}
