//! Lists that usually have one element.
use serde::{Deserialize, Serialize};

/// List that stores a single element without an allocation.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) enum InlineVec<T> {
    #[default]
    None,
    One(T),
    Many(Box<Several<T>>),
}

/// Boxed list. Lists are rare, so the box keeps the other variants small.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Several<T>(Vec<T>);

impl<T> InlineVec<T> {
    #[inline]
    pub fn as_slice(&self) -> &[T] {
        match self {
            InlineVec::None => &[],
            InlineVec::One(value) => std::slice::from_ref(value),
            InlineVec::Many(values) => &values.0,
        }
    }

    #[inline]
    pub fn insert(&mut self, at: usize, value: T) {
        match self {
            InlineVec::None => *self = InlineVec::One(value),
            InlineVec::One(_) => {
                let mut values: Vec<T> = self.remove(0).into_iter().collect();
                values.insert(at, value);
                *self = InlineVec::Many(Box::new(Several(values)));
            }
            InlineVec::Many(values) => values.0.insert(at, value),
        }
    }

    /// Removes the value at an index. Returns `None` beyond the end of the list.
    #[inline]
    pub fn remove(&mut self, at: usize) -> Option<T> {
        match self {
            InlineVec::Many(values) => (at < values.0.len()).then(|| values.0.remove(at)),
            _ => match std::mem::take(self) {
                InlineVec::One(value) => Some(value),
                _ => None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inline_vec_is_a_list() {
        let (mut inline, mut list) = (InlineVec::None, Vec::new());
        for (value, at) in [0, 0, 2, 1, 0].into_iter().enumerate() {
            inline.insert(at, value);
            list.insert(at, value);
            assert_eq!(inline.as_slice(), list);
        }
        for at in [4, 0, 1, 1, 0] {
            assert_eq!(inline.remove(at), Some(list.remove(at)));
            assert_eq!(inline.as_slice(), list);
        }
        assert_eq!(inline.remove(0), None);
        inline.insert(0, 7);
        assert_eq!((inline.remove(0), inline.as_slice()), (Some(7), &[][..]));
    }
}
