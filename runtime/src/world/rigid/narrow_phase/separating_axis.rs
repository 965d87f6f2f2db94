//! Separating-axis test of two boxes, for several pairs at once.
//!
//! Most nearby pairs do not touch, and the separating axis is hard to predict.
//!
//! # Source
//!
//! S. Gottschalk, M. C. Lin and D. Manocha (1996).
use super::cuboid::Cuboid;
use crate::world::rigid::simd::{ABREAST, Lane, Wide, first, sum, transposed};

/// Sine of the angle below which edges count as parallel.
const PARALLEL: f64 = 1e-3;

/// Margin of overlap for preferring a face contact to a contact of edges \[block lengths\]. Several
/// contact points are more stable than one.
const PREFER_FACE: f64 = 1e-3;

/// Direction of the least overlap of two boxes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Direction {
    /// Normal of a face of the first or second box.
    Face { first: bool, axis: usize },
    /// Direction perpendicular to one edge of the first box and one edge of the second box.
    Edges { own: usize, other: usize },
}

#[derive(Clone, Copy, Debug)]
pub(super) struct LeastOverlap<R> {
    pub direction: Direction,
    pub depth: R,
}

/// One vector per pair of boxes.
type LaneVector<R> = [<R as Lane>::Quad; 3];
type LaneMatrix<R> = [LaneVector<R>; 3];

/// Boxes of several pairs: one box of each pair.
struct Boxes<R: Lane> {
    axes: LaneMatrix<R>,
    half: LaneVector<R>,
}

struct SeparatingAxisSearch<R: Lane> {
    /// Mask of the pairs that no axis separates so far.
    meet: R::Quad,
    /// Least depth so far.
    depth: R::Quad,
    /// Index of the axis with the least depth.
    axis: R::Quad,
}

/// Returns the least overlap of the first `count` pairs of boxes, or `None` for separate boxes.
pub(super) fn least_overlaps<'a, R: Lane>(
    pairs: &[(Cuboid<'a, R>, Cuboid<'a, R>); ABREAST],
    count: usize,
) -> [Option<LeastOverlap<R>>; ABREAST] {
    let (a, b) = (gather(pairs, |pair| &pair.0), gather(pairs, |pair| &pair.1));
    let offset = vector(pairs, |(a, b)| b.centre - a.centre);
    let dot = |u: &LaneVector<R>, v: &LaneVector<R>| sum([0, 1, 2].map(|i| u[i] * v[i]));
    let in_a = [0, 1, 2].map(|i| dot(&a.axes[i], &offset));
    let turn: LaneMatrix<R> = [0, 1, 2].map(|i| [0, 1, 2].map(|j| dot(&a.axes[i], &b.axes[j])));
    let column = |of: &LaneMatrix<R>, j: usize| [0, 1, 2].map(|i| of[i][j]);
    let in_b = [0, 1, 2].map(|j| dot(&column(&turn, j), &in_a));
    let size = turn.map(|row| row.map(Wide::abs));
    let mut search = SeparatingAxisSearch::<R>::new(count);
    for axis in 0..3 {
        let reach = a.half[axis] + dot(&size[axis], &b.half);
        search.face(axis, reach - in_a[axis].abs());
    }
    for (axis, apart) in in_b.into_iter().enumerate() {
        let reach = b.half[axis] + dot(&column(&size, axis), &a.half);
        search.face(3 + axis, reach - apart.abs());
    }
    if search.meet.bits() == 0 {
        return [None; ABREAST];
    }
    let face = search.depth - R::Quad::splat(R::from_double(PREFER_FACE));
    let skew = R::Quad::splat(R::from_double(PARALLEL * PARALLEL));
    for own in 0..3 {
        let (own1, own2) = ((own + 1) % 3, (own + 2) % 3);
        for other in 0..3 {
            let (other1, other2) = ((other + 1) % 3, (other + 2) % 3);
            // Cross product of the two edges, in the frame of `a`.
            let square = R::Quad::splat(R::one()) - turn[own][other] * turn[own][other];
            let reach = a.half[own1] * size[own2][other]
                + a.half[own2] * size[own1][other]
                + b.half[other1] * size[own][other2]
                + b.half[other2] * size[own][other1];
            let apart = in_a[own2] * turn[own1][other] - in_a[own1] * turn[own2][other];
            let overlap = reach - apart.abs();
            search.edges(3 * own + other, overlap, square, skew.above(square), face);
        }
    }
    search.found()
}

impl<R: Lane> SeparatingAxisSearch<R> {
    fn new(pairs: usize) -> SeparatingAxisSearch<R> {
        SeparatingAxisSearch {
            meet: first::<R>(pairs),
            depth: R::Quad::splat(R::from_double(f64::from(f32::MAX))),
            axis: R::Quad::splat(R::zero()),
        }
    }

    #[inline(always)]
    fn face(&mut self, number: usize, overlap: R::Quad) {
        self.meet = self.meet & overlap.above(R::Quad::splat(R::zero()));
        self.keep(number, overlap, self.depth.above(overlap));
    }

    #[inline(always)]
    fn edges(
        &mut self,
        number: usize,
        overlap: R::Quad,
        square: R::Quad,
        parallel: R::Quad,
        face: R::Quad,
    ) {
        let zero = R::Quad::splat(R::zero());
        let overlap = parallel.choose(
            R::Quad::splat(R::from_double(f64::from(f32::MAX))),
            overlap / square.maximum(zero).sqrt(),
        );
        self.meet = self.meet & overlap.above(zero);
        let least = self.depth.above(overlap) & face.above(overlap);
        self.keep(6 + number, overlap, least);
    }

    #[inline(always)]
    fn keep(&mut self, number: usize, overlap: R::Quad, least: R::Quad) {
        self.depth = least.choose(overlap, self.depth);
        self.axis = least.choose(R::Quad::splat(R::from_integer(number as i32)), self.axis);
    }

    fn found(&self) -> [Option<LeastOverlap<R>>; ABREAST] {
        let meet = self.meet.bits();
        let (depth, axis) = (self.depth.store(), self.axis.store());
        std::array::from_fn(|lane| {
            (meet >> lane & 1 == 1).then(|| {
                let number = axis[lane].round_small() as usize;
                let direction = match number {
                    0..6 => Direction::Face {
                        first: number < 3,
                        axis: number % 3,
                    },
                    _ => Direction::Edges {
                        own: (number - 6) / 3,
                        other: number % 3,
                    },
                };
                let depth = depth[lane];
                LeastOverlap { direction, depth }
            })
        })
    }
}

#[inline(always)]
fn gather<'a, R: Lane>(
    pairs: &[(Cuboid<'a, R>, Cuboid<'a, R>); ABREAST],
    which: impl for<'b> Fn(&'b (Cuboid<'a, R>, Cuboid<'a, R>)) -> &'b Cuboid<'a, R>,
) -> Boxes<R> {
    let axis = |axis: usize| vector(pairs, |pair| which(pair).axis(axis));
    Boxes {
        axes: [axis(0), axis(1), axis(2)],
        half: vector(pairs, |pair| which(pair).half),
    }
}

/// Returns a vector of every pair, chosen by `of`.
#[inline(always)]
fn vector<'a, R: Lane>(
    [a, b, c, d]: &[(Cuboid<'a, R>, Cuboid<'a, R>); ABREAST],
    of: impl Fn(&(Cuboid<'a, R>, Cuboid<'a, R>)) -> nalgebra::Vector3<R>,
) -> LaneVector<R> {
    transposed([of(a).into(), of(b).into(), of(c).into(), of(d).into()])
}
