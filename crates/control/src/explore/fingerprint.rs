//! Fingerprints of states as 128-bit numbers.
use std::hash::{DefaultHasher, Hash, Hasher};

/// Returns the fingerprint of a value.
///
/// The probability of a collision among n states is about n^2 / 2^129: 10^-25 for ten million. The
/// standard hasher without a random key is the same in every run of one build. Only equality
/// matters.
pub(super) fn fingerprint(value: &impl Hash) -> u128 {
    let mut hasher = DoubleHasher(DefaultHasher::new(), DefaultHasher::new());
    hasher.1.write_u8(1);
    value.hash(&mut hasher);
    (u128::from(hasher.0.finish()) << 64) | u128::from(hasher.1.finish())
}

/// Two hashers with different initial states.
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
