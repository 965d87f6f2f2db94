//! Numbered cells of a target, called sites, with their neighbours.
use rustc_hash::FxHashMap;
use stochc_ir::{Cell, Face, offsets_within};

use crate::Target;
use crate::space::grid::{Grid, shifted};

/// Value for a missing site.
pub const NONE: u32 = u32::MAX;

/// Set of cells in a window of 3 x 3 x 3: bit (dx + 1) + 3 (dy + 1) + 9 (dz + 1).
pub type NeighbourMask = u32;

/// Index of the centre of a window.
pub const MIDDLE: usize = 13;

/// Returns the index of a cell in a window. Offsets are at most 1.
pub const fn place(dx: i32, dy: i32, dz: i32) -> usize {
    ((dx + 1) + 3 * (dy + 1) + 9 * (dz + 1)) as usize
}

/// Returns the index of the cell across a face in a window.
pub const fn across(face: Face) -> usize {
    let [dx, dy, dz] = face.normal();
    place(dx, dy, dz)
}

/// Cells of a window that share only an edge with the centre, each with the two common neighbours.
const DIAGONAL: [(usize, [usize; 2]); 12] = {
    const AXES: [[i32; 3]; 3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let mut diagonal = [(0, [0; 2]); 12];
    let mut i = 0;
    while i < 12 {
        let (u, v) = (AXES[i / 4], AXES[(i / 4 + 1) % 3]);
        let (a, b) = (2 * (i as i32 % 2) - 1, 2 * (i as i32 / 2 % 2) - 1);
        diagonal[i] = (
            place(
                a * u[0] + b * v[0],
                a * u[1] + b * v[1],
                a * u[2] + b * v[2],
            ),
            [
                place(a * u[0], a * u[1], a * u[2]),
                place(b * v[0], b * v[1], b * v[2]),
            ],
        );
        i += 1;
    }
    diagonal
};

/// Numbered cells of a target.
#[derive(Debug)]
pub struct Sites<'a> {
    pub target: &'a Target,
    number: Grid<Number>,
    windows: Vec<[u32; 27]>,
    /// Sites with existing blocks. The value states whether the block can capture.
    existing: FxHashMap<u32, bool>,
}

/// Number of a site, or [`NONE`] for a missing site.
#[derive(Clone, Copy, Debug)]
struct Number(u32);

impl Default for Number {
    fn default() -> Number {
        Number(NONE)
    }
}

impl<'a> Sites<'a> {
    /// Numbers the cells of a target in order.
    pub fn new(target: &'a Target) -> Sites<'a> {
        let cells = target.cells();
        let mut number = Grid::around(cells, 3);
        for (i, &cell) in cells.iter().enumerate() {
            number.set(cell, Number(i as u32));
        }
        let window = |&cell: &Cell| {
            let mut window = [NONE; 27];
            for [dx, dy, dz] in offsets_within(1) {
                let near = number.get(shifted(cell, dx, dy, dz));
                window[place(dx, dy, dz)] = near.map_or(NONE, |near| near.0);
            }
            window
        };
        let windows = cells.iter().map(window).collect();
        let existing = target.existing().iter().filter_map(|block| {
            let site = number.get(block.cell)?.0;
            Some((site, block.can_capture))
        });
        Sites {
            target,
            existing: existing.collect(),
            number,
            windows,
        }
    }

    /// Returns the sites with existing blocks, each with the direction from its parent.
    pub fn existing(&self) -> impl Iterator<Item = (u32, Face)> + '_ {
        let blocks = self.target.existing().iter();
        blocks.map(|block| (self.at(block.cell), block.direction))
    }

    pub fn existing_count(&self) -> usize {
        self.existing.len()
    }

    pub fn is_existing(&self, site: u32) -> bool {
        !self.existing.is_empty() && self.existing.contains_key(&site)
    }

    /// Returns whether the block of a site cannot hold other blocks.
    pub fn is_inert(&self, site: u32) -> bool {
        !self.existing.is_empty() && self.existing.get(&site) == Some(&false)
    }

    /// Returns whether a site is directly above a seed, or has an existing block.
    pub fn is_root(&self, site: u32) -> bool {
        self.is_on_seed(site) || self.is_existing(site)
    }

    /// Returns whether a standing block or the plate can capture a site by a face along an axis.
    pub fn is_held_along(&self, site: u32, axis: Face, stands: &impl Fn(u32) -> bool) -> bool {
        let holds = |direction: Face| match self.next(site, direction.opposite()) {
            NONE => direction == Face::Up && self.is_on_seed(site),
            parent => stands(parent) && !self.is_inert(parent),
        };
        holds(axis) || holds(axis.opposite())
    }

    pub fn len(&self) -> usize {
        self.windows.len()
    }

    pub fn cell(&self, site: u32) -> Cell {
        self.target.cells()[site as usize]
    }

    /// Returns the site in a cell, or [`NONE`].
    pub fn at(&self, cell: Cell) -> u32 {
        self.number.get(cell).map_or(NONE, |number| number.0)
    }

    /// Returns the site across a face, or [`NONE`].
    pub fn next(&self, site: u32, face: Face) -> u32 {
        self.windows[site as usize][across(face)]
    }

    /// Returns the sites across the six faces.
    pub fn adjacent(&self, site: u32) -> impl Iterator<Item = u32> + '_ {
        let next = Face::ALL.into_iter().map(move |face| self.next(site, face));
        next.filter(|&next| next != NONE)
    }

    /// Returns the sites that share a face, an edge or a corner with a site.
    pub fn near(&self, site: u32) -> impl Iterator<Item = u32> + '_ {
        let window = self.windows[site as usize].iter().enumerate();
        let others = window.filter(|&(i, &near)| i != MIDDLE && near != NONE);
        others.map(|(_, &near)| near)
    }

    /// Returns the squares of four cells that contain a site. Each result has the two sites
    /// adjacent to the site, then the diagonal one. [`NONE`] stands for a missing site.
    pub fn squares(&self, site: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        let window = &self.windows[site as usize];
        let squares = DIAGONAL.iter();
        squares.map(|&(across, [one, two])| [window[one], window[two], window[across]])
    }

    /// Returns the cells of a site's window whose sites fulfil `has`.
    pub fn window(&self, site: u32, has: impl Fn(u32) -> bool) -> NeighbourMask {
        let window = self.windows[site as usize].iter().enumerate();
        let full = window.filter(|&(_, &near)| near != NONE && has(near));
        full.fold(0, |bits, (i, _)| bits | 1 << i)
    }

    /// Returns whether a block of the plate may capture a site.
    pub fn is_on_seed(&self, site: u32) -> bool {
        self.target.is_on_seed(self.cell(site))
    }
}
