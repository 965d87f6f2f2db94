use super::sample::scene;
use crate::diagnostic::{Code, Diagnostic};

fn reported(clause: &str) -> Vec<Diagnostic> {
    let (scene, diagnostics) = scene(clause);
    assert_eq!(scene, None, "{clause}");
    diagnostics
}

/// Checks an anchor without content. It was once ignored, and the scene had no bond.
#[test]
fn reports_an_empty_anchor_clause() {
    let diagnostics = reported("bond attract { pull 1 N within 1cm  anchor }");
    let titles: Vec<_> = diagnostics.iter().map(|it| it.title.as_str()).collect();
    assert_eq!(
        titles,
        ["expected a measure of the anchoring distance, found nothing"]
    );
}

/// Checks fields after an unknown measure. They were once skipped too.
#[test]
fn reads_on_after_an_unknown_measure() {
    for anchor in ["anchor 1mm", "anchor middle 1mm tilt 20 deg"] {
        let diagnostics = reported(&format!("bond attract {{ {anchor}  pull 1 N within 1cm }}"));
        let codes: Vec<_> = diagnostics.iter().map(|it| it.code).collect();
        assert_eq!(codes, [Code::UnknownTerm], "{diagnostics:?}");
    }
}
