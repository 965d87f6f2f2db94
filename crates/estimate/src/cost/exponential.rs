//! Draws from the exponential distribution.
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

/// Returns a draw from the exponential distribution of mean 1.
pub fn exponential(rng: &mut ChaCha8Rng) -> f64 {
    -libm::log1p(-rng.random::<f64>())
}
