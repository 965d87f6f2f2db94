//! States as 128-bit numbers.
use std::hash::{DefaultHasher, Hash, Hasher};

/// The fingerprint of a value.
///
/// Two of n states share one with a probability of about n^2 / 2^129: for ten million states,
/// 10^-25. The standard hasher without a random key gives the same in every run of one build; only
/// whether two are equal matters.
pub(super) fn fingerprint(value: &impl Hash) -> u128 {
    let mut hasher = DoubleHasher(DefaultHasher::new(), DefaultHasher::new());
    hasher.1.write_u8(1);
    value.hash(&mut hasher);
    (u128::from(hasher.0.finish()) << 64) | u128::from(hasher.1.finish())
}

/// Two hashers that start differently.
struct DoubleHasher(DefaultHasher, DefaultHasher);

impl Hasher for DoubleHasher {
    fn write(&mut self, bytes: &[u8]) {
        self.0.write(bytes);
        self.1.write(bytes);
    }

    fn finish(&self) -> u64 {
        self.0.finish()
    }
}
