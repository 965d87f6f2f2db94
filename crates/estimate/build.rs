//! Provides the digest of the sources to the crate.
fn main() -> std::io::Result<()> {
    stochc_digest::emit()
}
