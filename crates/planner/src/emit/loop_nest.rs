//! Nested loops, and the rules for writing repeated statements as loops.
use std::fmt::Write as _;

use rustc_hash::FxHashMap;
use stochc_ir::Cell;

/// Nested `for` loops around a statement. The first iteration begins at the cell `base`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct LoopNest {
    pub(super) base: Cell,
    /// Loops along x, y and z.
    loops: [Option<Loop>; 3],
}

/// Loop over equally spaced positions along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Loop {
    /// Distance between two positions.
    step: i32,
    count: i32,
}

/// Smallest number of repetitions that makes a loop.
pub(super) const MIN: usize = 3;

/// Loop variables along x, y and z.
pub(super) const COUNTERS: [&str; 3] = ["x", "y", "z"];

impl LoopNest {
    pub(super) fn new(base: Cell) -> LoopNest {
        LoopNest {
            base,
            loops: [None; 3],
        }
    }

    /// Returns whether there is more than one repetition.
    pub fn is_loop(&self) -> bool {
        self.loops.iter().any(Option::is_some)
    }

    fn coordinate(&self, axis: usize) -> i32 {
        <[i32; 3]>::from(self.base)[axis]
    }

    /// Writes the loops. `inner` writes the body of the loops with the indices of one iteration.
    pub fn write(&self, out: &mut String, inner: impl FnOnce(&mut String, &Indices<'_>)) {
        let loops = || (0..3).filter_map(|axis| Some((axis, self.loops[axis]?)));
        for (axis, it) in loops() {
            let low = self.coordinate(axis);
            let (first, last) = match it.step {
                1 => (low, low + it.count - 1),
                _ => (0, it.count - 1),
            };
            // Writing to a string cannot fail.
            let _ = writeln!(out, "for {} in {first}..{last} {{", COUNTERS[axis]);
        }
        inner(out, &Indices { nest: self });
        out.push('\n');
        out.extend(loops().map(|_| "}\n"));
    }
}

/// Indices of a cell in an iteration.
pub struct Indices<'a> {
    nest: &'a LoopNest,
}

impl Indices<'_> {
    /// Returns the source text of the x index that is `steps` cells east of the base.
    pub fn x(&self, steps: i32) -> String {
        self.along(0, steps)
    }

    /// Returns the source text of the y index that is `steps` cells north of the base.
    pub fn y(&self, steps: i32) -> String {
        self.along(1, steps)
    }

    /// Returns the source text of the z index that is `steps` cells above the base.
    pub fn z(&self, steps: i32) -> String {
        self.along(2, steps)
    }

    fn along(&self, axis: usize, steps: i32) -> String {
        let base = self.nest.coordinate(axis);
        let counter = COUNTERS[axis];
        let (product, rest) = match self.nest.loops[axis] {
            None => return (base + steps).to_string(),
            Some(Loop { step: 1, .. }) => (counter.to_owned(), steps),
            Some(Loop { step, .. }) => (format!("{step} * {counter}"), base + steps),
        };
        match rest {
            0 => product,
            1.. => format!("{product} + {rest}"),
            _ => format!("{product} - {}", -rest),
        }
    }

    /// Returns the indices of a block, or of a row of blocks from the first to the last.
    pub fn block(&self, first: Cell, last: Cell) -> String {
        let (first, last) = (<[i32; 3]>::from(first), <[i32; 3]>::from(last));
        let index = |axis: usize| {
            if first[axis] == last[axis] {
                self.along(axis, first[axis])
            } else {
                format!(
                    "{}..{}",
                    self.along(axis, first[axis]),
                    self.along(axis, last[axis])
                )
            }
        };
        format!("[{}, {}, {}]", index(0), index(1), index(2))
    }
}

/// Returns groups of equal nests at equal distances along an axis. A group contains indices of
/// `nests`, the lowest nest first. Every group is long enough for a loop.
pub(super) fn runs<'a>(
    axis: usize,
    nests: impl Iterator<Item = (usize, &'a LoopNest)>,
) -> Vec<Vec<usize>> {
    let mut groups: FxHashMap<(usize, LoopNest), usize> = FxHashMap::default();
    let mut members: Vec<Vec<(i32, usize)>> = Vec::new();
    for (i, (kind, nest)) in nests.enumerate() {
        let mut base = <[i32; 3]>::from(nest.base);
        let place = std::mem::take(&mut base[axis]);
        let elsewhere = LoopNest {
            base: base.into(),
            ..nest.clone()
        };
        let group = *groups.entry((kind, elsewhere)).or_insert(members.len());
        if group == members.len() {
            members.push(Vec::new());
        }
        members[group].push((place, i));
    }
    let mut runs = Vec::new();
    for mut places in members {
        places.sort_unstable();
        let mut from = 0;
        while from + 1 < places.len() {
            let step = |i: usize| places[i + 1].0 - places[i].0;
            let further = (from + 1..places.len() - 1).take_while(|&i| step(i) == step(from));
            let end = from + 2 + further.count();
            if end - from >= MIN {
                runs.push(places[from..end].iter().map(|&(_, i)| i).collect());
                from = end;
            } else {
                from += 1;
            }
        }
    }
    runs
}

/// Returns one nest that replaces a group of nests from [`runs`] by a loop along `axis`.
pub(super) fn joined<'a>(
    axis: usize,
    run: &[usize],
    nest: impl Fn(usize) -> &'a LoopNest,
) -> LoopNest {
    let mut joined = nest(run[0]).clone();
    joined.loops[axis] = Some(Loop {
        step: nest(run[1]).coordinate(axis) - joined.coordinate(axis),
        count: run.len() as i32,
    });
    joined
}
