//! The cells of a target by number, with their neighbours.
use stochc_ir::{Cell, Face};

use crate::Target;
use crate::grid::{Grid, shifted};

/// No site.
pub const NONE: u32 = u32::MAX;

/// The cells around one, itself included: bit (dx + 1) + 3 (dy + 1) + 9 (dz + 1).
pub type Window = u32;

/// The bit of the cell in the middle of its window.
pub const MIDDLE: usize = 13;

/// The place of a cell some steps away, none of them longer than 1, in a window.
pub const fn place(dx: i32, dy: i32, dz: i32) -> usize {
    ((dx + 1) + 3 * (dy + 1) + 9 * (dz + 1)) as usize
}

/// The place of the cell across a face in a window.
pub const fn across(face: Face) -> usize {
    let [dx, dy, dz] = face.normal();
    place(dx, dy, dz)
}

/// A target's cells as numbers.
#[derive(Debug)]
pub struct Sites<'a> {
    /// What they are of.
    pub target: &'a Target,
    number: Grid<Number>,
    windows: Vec<[u32; 27]>,
}

/// The number of a site, or none.
#[derive(Clone, Copy, Debug)]
struct Number(u32);

impl Default for Number {
    fn default() -> Number {
        Number(NONE)
    }
}

impl<'a> Sites<'a> {
    /// The cells of a target, in their order.
    pub fn of(target: &'a Target) -> Sites<'a> {
        let cells = target.cells();
        let mut number = Grid::around(cells, 3);
        for (i, &cell) in cells.iter().enumerate() {
            number.set(cell, Number(i as u32));
        }
        let window = |&cell: &Cell| {
            let mut window = [NONE; 27];
            for dz in -1..=1 {
                for dy in -1..=1 {
                    for dx in -1..=1 {
                        let near = number.get(shifted(cell, dx, dy, dz));
                        window[place(dx, dy, dz)] = near.map_or(NONE, |near| near.0);
                    }
                }
            }
            window
        };
        let windows = cells.iter().map(window).collect();
        Sites {
            target,
            number,
            windows,
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.windows.len()
    }

    /// The cell of a site.
    pub fn cell(&self, site: u32) -> Cell {
        self.target.cells()[site as usize]
    }

    /// The site in a cell, or [`NONE`].
    pub fn at(&self, cell: Cell) -> u32 {
        self.number.get(cell).map_or(NONE, |number| number.0)
    }

    /// The site across a face, or [`NONE`].
    pub fn next(&self, site: u32, face: Face) -> u32 {
        self.windows[site as usize][across(face)]
    }

    /// The sites across the six faces.
    pub fn adjacent(&self, site: u32) -> impl Iterator<Item = u32> + '_ {
        let next = Face::ALL.into_iter().map(move |face| self.next(site, face));
        next.filter(|&next| next != NONE)
    }

    /// The sites that share a face, an edge or a corner with one.
    pub fn near(&self, site: u32) -> impl Iterator<Item = u32> + '_ {
        let window = self.windows[site as usize].iter().enumerate();
        let others = window.filter(|&(i, &near)| i != MIDDLE && near != NONE);
        others.map(|(_, &near)| near)
    }

    /// Which cells of a site's window `has`.
    pub fn window(&self, site: u32, has: impl Fn(u32) -> bool) -> Window {
        let window = self.windows[site as usize].iter().enumerate();
        let full = window.filter(|&(_, &near)| near != NONE && has(near));
        full.fold(0, |bits, (i, _)| bits | 1 << i)
    }

    /// Whether a block of the plate may capture it.
    pub fn is_on_seed(&self, site: u32) -> bool {
        self.target.is_on_seed(self.cell(site))
    }
}
