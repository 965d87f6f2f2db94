//! What is said several times, a step apart, is said once, in a loop.
use std::fmt::Write as _;

use rustc_hash::FxHashMap;
use stochc_ir::Cell;

use super::statement::Statement;

/// A statement, and where it is repeated.
#[derive(Debug)]
pub struct Repeated<'a> {
    /// The one nearest to the origin.
    pub first: &'a Statement,
    /// The others.
    pub nest: LoopNest,
}

/// Loops inside each other, around something that begins at a cell.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct LoopNest {
    base: Cell,
    /// Along x, y and z.
    loops: [Option<Loop>; 3],
}

/// Places along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Loop {
    /// From one to the next.
    step: i32,
    /// How many there are.
    count: i32,
}

/// Places that are worth a loop.
const LEAST: usize = 3;

const COUNTERS: [&str; 3] = ["x", "y", "z"];

impl LoopNest {
    fn of(base: Cell) -> LoopNest {
        LoopNest {
            base,
            loops: [None; 3],
        }
    }

    /// Whether there is more than one.
    pub fn is_loop(&self) -> bool {
        self.loops.iter().any(Option::is_some)
    }

    fn coordinate(&self, axis: usize) -> i32 {
        <[i32; 3]>::from(self.base)[axis]
    }

    /// Writes the loops around what is written with the indices of one round.
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

/// The indices of a cell in a round of loops.
pub struct Indices<'a> {
    nest: &'a LoopNest,
}

impl Indices<'_> {
    /// So many cells east of the base.
    pub fn x(&self, steps: i32) -> String {
        self.along(0, steps)
    }

    /// So many cells north of the base.
    pub fn y(&self, steps: i32) -> String {
        self.along(1, steps)
    }

    /// So many cells above the base.
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

    /// The indices of a block, or of a row of them from the first to the last.
    pub fn block(&self, first: Cell, last: Cell) -> String {
        let (first, last) = (<[i32; 3]>::from(first), <[i32; 3]>::from(last));
        let index = |axis: usize| match first[axis] == last[axis] {
            true => self.along(axis, first[axis]),
            false => {
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

/// The seats of the seeds that statements need.
pub fn seats(statements: &[Statement]) -> Vec<LoopNest> {
    let seeds = statements.iter().filter_map(Statement::seed);
    let mut nests: Vec<LoopNest> = seeds
        .map(|(x, y)| LoopNest::of(Cell::new(x, y, 0)))
        .collect();
    nests.sort_by_key(|nest| (nest.base.y, nest.base.x));
    for axis in 0..2 {
        let mut is_gone = vec![false; nests.len()];
        for run in runs(axis, nests.iter().map(|nest| (0, nest))) {
            nests[run[0]] = joined(axis, &run, |i| &nests[i]);
            run[1..].iter().for_each(|&other| is_gone[other] = true);
        }
        nests = remaining(nests, &is_gone);
    }
    nests
}

/// Equal statements, at the places of a nest.
struct RepeatedItem {
    /// Where they are written.
    at: usize,
    /// Equal ones have one number.
    kind: usize,
    nest: LoopNest,
    members: Vec<usize>,
}

/// Statements with equal ones in loops, each where its first one was.
pub fn repeated(statements: &[Statement]) -> Vec<Repeated<'_>> {
    let mut kinds = FxHashMap::default();
    let items = statements.iter().enumerate().map(|(at, statement)| {
        let next = kinds.len();
        RepeatedItem {
            at,
            kind: *kinds.entry(statement.signature()).or_insert(next),
            nest: LoopNest::of(statement.base()),
            members: vec![at],
        }
    });
    let mut items: Vec<RepeatedItem> = items.collect();
    for axis in 0..3 {
        let mut is_gone = vec![false; items.len()];
        for run in runs(axis, items.iter().map(|item| (item.kind, &item.nest))) {
            let at = run
                .iter()
                .map(|&i| items[i].at)
                .min()
                .expect("a run has members");
            let members: Vec<usize> = run.iter().flat_map(|&i| items[i].members.clone()).collect();
            // Captures of one parent stay in their order: none moves before the one it follows.
            let may_move = |&i: &usize| statements[i].follows.is_none_or(|before| before < at);
            if members.iter().all(may_move) {
                let nest = joined(axis, &run, |i| &items[i].nest);
                let kind = items[run[0]].kind;
                items[run[0]] = RepeatedItem {
                    at,
                    kind,
                    nest,
                    members,
                };
                run[1..].iter().for_each(|&other| is_gone[other] = true);
            }
        }
        items = remaining(items, &is_gone);
    }
    items.sort_by_key(|item| item.at);
    let repeated = items.into_iter().map(|RepeatedItem { nest, members, .. }| {
        let first = members.iter().find(|&&i| statements[i].base() == nest.base);
        Repeated {
            first: &statements[*first.expect("a nest begins at one of its members")],
            nest,
        }
    });
    repeated.collect()
}

/// Nests of equal kinds, equally far apart along an axis, often enough for a loop: their places, from the lowest.
fn runs<'a>(axis: usize, nests: impl Iterator<Item = (usize, &'a LoopNest)>) -> Vec<Vec<usize>> {
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
            if end - from >= LEAST {
                runs.push(places[from..end].iter().map(|&(_, i)| i).collect());
                from = end;
            } else {
                from += 1;
            }
        }
    }
    runs
}

/// One nest for all of a run.
fn joined<'a>(axis: usize, run: &[usize], nest: impl Fn(usize) -> &'a LoopNest) -> LoopNest {
    let mut joined = nest(run[0]).clone();
    joined.loops[axis] = Some(Loop {
        step: nest(run[1]).coordinate(axis) - joined.coordinate(axis),
        count: run.len() as i32,
    });
    joined
}

fn remaining<T>(items: Vec<T>, is_gone: &[bool]) -> Vec<T> {
    let items = items.into_iter().zip(is_gone);
    items
        .filter(|(_, is_gone)| !**is_gone)
        .map(|(item, _)| item)
        .collect()
}
