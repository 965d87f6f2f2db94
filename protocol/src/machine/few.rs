//! Lists that mostly have one entry.
use serde::{Deserialize, Serialize};

/// Values, of which one takes no memory of its own.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) enum Few<T> {
    #[default]
    None,
    One(T),
    Many(Box<Several<T>>),
}

/// Of another type than a list, so that it may be boxed: all that have it pay for its size, and few have it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Several<T>(Vec<T>);

impl<T> Few<T> {
    #[inline]
    pub fn as_slice(&self) -> &[T] {
        match self {
            Few::None => &[],
            Few::One(value) => std::slice::from_ref(value),
            Few::Many(values) => &values.0,
        }
    }

    /// Puts a value behind so many others.
    #[inline]
    pub fn insert(&mut self, at: usize, value: T) {
        match self {
            Few::None => *self = Few::One(value),
            _ => self.insert_beside(at, value),
        }
    }

    fn insert_beside(&mut self, at: usize, value: T) {
        match std::mem::take(self) {
            Few::None => *self = Few::One(value),
            Few::One(first) => {
                let mut values = vec![first];
                values.insert(at, value);
                *self = Few::Many(Box::new(Several(values)));
            }
            Few::Many(mut values) => {
                values.0.insert(at, value);
                *self = Few::Many(values);
            }
        }
    }

    /// Takes out the value behind so many others.
    #[inline]
    pub fn remove(&mut self, at: usize) -> Option<T> {
        match self {
            Few::Many(values) => (at < values.0.len()).then(|| values.0.remove(at)),
            _ => match std::mem::take(self) {
                Few::One(value) => Some(value),
                _ => None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_a_list() {
        let (mut few, mut list) = (Few::None, Vec::new());
        for (value, at) in [0, 0, 2, 1, 0].into_iter().enumerate() {
            few.insert(at, value);
            list.insert(at, value);
            assert_eq!(few.as_slice(), list);
        }
        for at in [4, 0, 1, 1, 0] {
            assert_eq!(few.remove(at), Some(list.remove(at)));
            assert_eq!(few.as_slice(), list);
        }
        assert_eq!(few.remove(0), None);
        few.insert(0, 7);
        assert_eq!((few.remove(0), few.as_slice()), (Some(7), &[][..]));
    }
}
