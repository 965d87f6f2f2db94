//! Names with the same word, such as `T[1..3]` and `T[7]`.
use stochc_grammar::Symbols;
use stochc_text::listed;

use crate::expanded::{NameKey, Roles};

/// Largest number of names that are listed. Ranges count once.
const MAX: usize = 4;

/// Existing names that share a word and differ in their indices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Members {
    word: String,
    /// Text of the names, with ranges instead of single indices.
    names: String,
    is_single: bool,
}

impl Members {
    /// Lists the existing names. `noun` is the word for one of them.
    pub fn describe(&self, noun: &str) -> String {
        let Members { word, names, .. } = self;
        if self.is_single {
            format!("the only {noun} named `{word}` is {names}")
        } else {
            format!("the {noun}s named `{word}` are {names}")
        }
    }
}

/// Returns the names among `keys` with the same word and instance as `requested`. Returns `None` if
/// there are none.
pub(crate) fn members(
    requested: NameKey,
    keys: impl Iterator<Item = NameKey>,
    roles: &Roles,
    symbols: &Symbols,
) -> Option<Members> {
    let mut boxes: Vec<IndexBounds> = keys
        .filter(|key| key.scope == requested.scope && key.word == requested.word)
        .map(IndexBounds::new)
        .collect();
    boxes.sort_unstable();
    boxes.dedup();
    // Names with the same number of indices are the likeliest.
    let arity = |arity: u8| move |one: &IndexBounds| one.arity == arity;
    if boxes.iter().any(arity(requested.arity)) {
        boxes.retain(arity(requested.arity));
    }
    let is_single = boxes.len() == 1;
    for dimension in (0..NameKey::MAX_INDICES).rev() {
        boxes = joined(boxes, dimension);
    }
    let bare = NameKey {
        arity: 0,
        ..requested
    };
    let word = roles.name_of(bare, symbols);
    let names: Vec<String> = (boxes.iter().take(MAX))
        .map(|one| format!("`{word}{}`", one.indices()))
        .collect();
    (!names.is_empty()).then(|| Members {
        names: listed(&names, boxes.len()),
        word,
        is_single,
    })
}

/// Set of names: each index lies between two bounds, both included.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct IndexBounds {
    arity: u8,
    bounds: [(i32, i32); NameKey::MAX_INDICES],
}

impl IndexBounds {
    fn new(key: NameKey) -> IndexBounds {
        IndexBounds {
            arity: key.arity,
            bounds: key.index.map(|index| (index, index)),
        }
    }

    fn indices(&self) -> String {
        let bounds = &self.bounds[..usize::from(self.arity)];
        let index = |&(first, last): &(i32, i32)| {
            if first == last {
                first.to_string()
            } else {
                format!("{first}..{last}")
            }
        };
        match bounds {
            [] => String::new(),
            bounds => format!(
                "[{}]",
                bounds.iter().map(index).collect::<Vec<_>>().join(", ")
            ),
        }
    }
}

/// Joins sets of names whose bounds are adjacent along one index and equal along all others.
fn joined(mut boxes: Vec<IndexBounds>, dimension: usize) -> Vec<IndexBounds> {
    let others = |one: &IndexBounds| {
        let mut rest = one.bounds;
        rest[dimension] = (0, 0);
        (one.arity, rest)
    };
    boxes.sort_unstable_by_key(|one| (others(one), one.bounds[dimension]));
    let mut out: Vec<IndexBounds> = Vec::new();
    for one in boxes {
        match out.last_mut() {
            Some(last)
                if others(last) == others(&one)
                    && last.bounds[dimension].1.checked_add(1) == Some(one.bounds[dimension].0) =>
            {
                last.bounds[dimension].1 = one.bounds[dimension].1;
            }
            _ => out.push(one),
        }
    }
    out.sort_unstable();
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(requested: &[i32], known: &[&[i32]]) -> Option<String> {
        let mut symbols = Symbols::default();
        let word = symbols.intern("T");
        let key = |indices: &[i32]| {
            let mut index = [0; NameKey::MAX_INDICES];
            index[..indices.len()].copy_from_slice(indices);
            NameKey {
                scope: 0,
                word,
                arity: indices.len() as u8,
                index,
            }
        };
        let keys = known.iter().map(|indices| key(indices));
        let members = members(key(requested), keys, &Roles::default(), &symbols);
        members.map(|members| members.names)
    }

    #[test]
    fn consecutive_indices_are_one_range() {
        let some = |text: &str| Some(text.to_owned());
        assert_eq!(shown(&[4], &[&[1], &[2], &[3]]), some("`T[1..3]`"));
        assert_eq!(
            shown(&[4], &[&[7], &[3], &[1], &[2]]),
            some("`T[1..3]` and `T[7]`")
        );
        assert_eq!(
            shown(&[2, 0], &[&[0, 0], &[0, 1], &[1, 0], &[1, 1]]),
            some("`T[0..1, 0..1]`")
        );
        assert_eq!(
            shown(&[2, 0], &[&[0, 0], &[0, 1], &[1, 0]]),
            some("`T[0, 0..1]` and `T[1, 0]`")
        );
        assert_eq!(shown(&[1], &[]), None);
    }

    #[test]
    fn lists_other_numbers_of_indices_if_nothing_better_exists() {
        let some = |text: &str| Some(text.to_owned());
        assert_eq!(shown(&[], &[&[1], &[2]]), some("`T[1..2]`"));
        assert_eq!(shown(&[1], &[&[]]), some("`T`"));
        assert_eq!(shown(&[1], &[&[], &[2]]), some("`T[2]`"));
    }

    #[test]
    fn long_lists_are_counted() {
        let known: Vec<[i32; 1]> = (0..20).map(|i| [2 * i]).collect();
        let known: Vec<&[i32]> = known.iter().map(|key| &key[..]).collect();
        assert_eq!(
            shown(&[1], &known).as_deref(),
            Some("`T[0]`, `T[2]`, `T[4]`, `T[6]` and 16 more")
        );
    }
}
