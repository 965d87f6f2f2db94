//! Tests the replay page against the accessibility rules of WCAG.
use std::path::PathBuf;

use serde_json::json;

use crate::browser::{Browser, browser};
use crate::folder::{PROGRAM, Results, SWARM};
use crate::page_under_test::Page;
use crate::skipped::skipped;

/// Returns the source of axe-core. Returns `None` with a note if it is missing and not required.
#[track_caller]
pub fn axe() -> Option<String> {
    let path = std::env::var_os("STOCHC_AXE").map(PathBuf::from);
    let script = path.and_then(|path| std::fs::read_to_string(path).ok());
    if script.is_none() {
        skipped("axe", "axe-core");
    }
    script
}

/// Checks that the open page breaks no rule. `how` describes the page in the message.
#[track_caller]
pub fn breaks_nothing(browser: &mut impl Page, axe: &str, how: &str) {
    browser.run(axe);
    let found = browser.value(
        "axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa'] }).then(
            ({ violations, passes }) => ({ passes: passes.length, violations: violations.map(({ id, nodes }) =>
                [id, ...nodes.map(({ html }) => html)]) }))",
    );
    assert_eq!(found["violations"], json!([]), "{how}");
    assert!(found["passes"].as_u64().unwrap() > 10, "{found}");
}

#[test]
fn nothing_breaks_wcag_aa() {
    let (Some(mut browser), Some(axe)) = (browser(&[]), axe()) else {
        return;
    };
    check(
        &mut browser,
        &axe,
        PROGRAM,
        ["#tick=9000&block=3", "#tick=4000"],
    );
    check(
        &mut browser,
        &axe,
        SWARM,
        ["#tick=300&block=20", "#tick=400"],
    );
}

/// Checks the replay page of a program on a wide and on a narrow screen, in both themes.
fn check(browser: &mut Browser, axe: &str, program: &str, [wide, narrow]: [&str; 2]) {
    let results = Results::from_records(program, "--record 0");
    let page = results.page(0);
    for theme in ["dark", "light"] {
        let requested = json!({ "features": [{ "name": "prefers-color-scheme", "value": theme }] });
        browser.call("Emulation.setEmulatedMedia", &requested);
        for (width, height, hash) in [(1440, 900, wide), (390, 844, narrow)] {
            browser.size(width, height);
            browser.open(&page, hash);
            browser.value("replay.settled().then(() => 1)");
            breaks_nothing(browser, axe, &format!("{theme}, {width} x {height}"));
        }
    }
}
