//! Which blocks are near each other, looked up once for several substeps (Verlet 1967).
use super::bodies::Bodies;
use super::grid::{Grid, TOUCH};
use super::lanes::{LANES, Lane, Wide};

/// The blocks near each other and near places.
#[derive(Clone, Debug)]
pub(super) struct Neighbours<R: Lane> {
    grid: Grid<R>,
    /// So much farther apart than touching \[side\], pairs are on the list.
    skin: f64,
    pairs: Vec<(u32, u32)>,
    /// Where the blocks were when the list was made; empty: there is none.
    places: [Vec<R>; 3],
}

impl<R: Lane> Neighbours<R> {
    /// For blocks that mostly stay within `span` of the origin, and above `floor` \[side\].
    pub fn new(count: usize, span: f64, floor: f64, skin: f64) -> Neighbours<R> {
        Neighbours {
            grid: Grid::new(count, span, floor, TOUCH + skin),
            skin,
            pairs: Vec::new(),
            places: [const { Vec::new() }; 3],
        }
    }

    /// Takes in where the blocks are now; whether the list had to be made anew.
    pub fn follow(&mut self, bodies: &Bodies<R>) -> bool {
        if !self.places[0].is_empty() && self.holds(bodies) {
            return false;
        }
        self.grid.sort(bodies);
        if self.skin > 0.0 {
            for (kept, now) in self.places.iter_mut().zip(&bodies.position) {
                kept.clone_from(now);
            }
            self.grid.close_pairs(&mut self.pairs);
        }
        true
    }

    /// Whether no block has moved by half of the skin.
    fn holds(&self, bodies: &Bodies<R>) -> bool {
        let load = |x: &[R; LANES]| R::Wide::load(x);
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let now = bodies.position[axis].as_chunks::<LANES>().0;
            now.iter().zip(self.places[axis].as_chunks::<LANES>().0)
        });
        let mut farthest = R::Wide::splat(R::zero());
        for ((x, y), z) in x.zip(y).zip(z) {
            let way = [x, y, z].map(|(now, then)| load(now) - load(then));
            farthest = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).most(farthest);
        }
        let most = R::of(self.skin * self.skin / 4.0);
        farthest.store().iter().all(|&square| square < most)
    }

    /// Every pair of blocks that may touch, once, the lower number first, in rising order.
    pub fn close_pairs(&mut self, bodies: &Bodies<R>, pairs: &mut Vec<(u32, u32)>) {
        if self.skin == 0.0 {
            self.grid.close_pairs(pairs);
            return;
        }
        let touch = R::of(TOUCH * TOUCH);
        pairs.clear();
        pairs.extend(self.pairs.iter().filter(|&&(i, j)| {
            let way = bodies.centre(i as usize) - bodies.centre(j as usize);
            way.norm_squared() < touch
        }));
    }

    /// The blocks that may come within `reach` of a place before the list is made anew, in rising
    /// order.
    pub fn around(&self, centre: [R; 3], reach: R, found: &mut Vec<u32>) {
        self.grid
            .around(centre, reach + R::of(self.skin / 2.0), found);
    }
}
