//! Reads arbitrary text as a manifest. A valid manifest must be equal after writing and reading.
use std::sync::LazyLock;

use stochc_results::Manifest;

static OTHER: LazyLock<Manifest> = LazyLock::new(super::ensemble);

/// Reads an input as a manifest. Panics if the result is wrong.
pub fn read(text: &str) {
    let Ok(manifest) = Manifest::from_json(text) else {
        return;
    };
    let written = manifest.to_json();
    let again = Manifest::from_json(&written).expect("written files can be read");
    assert_eq!(again.to_json(), written);
    assert_eq!(again.identity(), manifest.identity());
    assert!(manifest.total() > 0 && manifest.within_limits().is_ok());
    let _ = manifest.differences(&OTHER);
}
