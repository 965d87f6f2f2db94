//! Tells the crate what its sources are.
fn main() -> std::io::Result<()> {
    stochc_digest::emit()
}
