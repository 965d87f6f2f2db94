//! Tests that a page reports why it cannot show its recording.
use std::fs;
use std::path::Path;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::browser::browser;
use crate::folder::Results;
use crate::page_under_test::Page;

/// Returns the message that the page shows instead of the arena.
fn message(browser: &mut impl Page, page: &Path, text: &str) -> String {
    fs::write(page, text).unwrap();
    browser.open(page, "");
    let shown = browser.value(
        "(at => at && !at.hidden && at.getBoundingClientRect().width > 100 ? at.textContent : '')(document.getElementById('message'))",
    );
    shown.as_str().unwrap().to_owned()
}

#[test]
fn errors_of_a_page_are_reported() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    check(&mut browser);
}

/// Checks pages of other versions, corrupted pages, and truncated pages.
pub fn check(browser: &mut impl Page) {
    let results = Results::from_records("tests/fixtures/dense.sa", "--record 0");
    let page = results.page(0);
    let text = fs::read_to_string(&page).unwrap();
    let start = text.find("id=\"recording\">").unwrap() + "id=\"recording\">".len();
    let end = start + text[start..].find('<').unwrap();
    let bytes = STANDARD.decode(&text[start..end]).unwrap();
    let with = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = bytes.clone();
        change(&mut bytes);
        format!(
            "{}{}{}",
            &text[..start],
            STANDARD.encode(bytes),
            &text[end..]
        )
    };
    assert_eq!(message(browser, &page, &text), "");
    for (text, reason) in [
        (with(&|bytes| bytes[8] = 7), "version 7"),
        (
            with(&|bytes| bytes.truncate(bytes.len() / 2)),
            "is incomplete",
        ),
        (
            with(&|bytes| bytes.truncate(bytes.len() - 3)),
            "is incomplete",
        ),
        (with(&|bytes| bytes.clear()), "is incomplete"),
        (with(&|bytes| bytes[0] = b'x'), "no recording"),
        // The page was copied incompletely: up to the recording, to a point before it, or to a
        // point within the script.
        (
            text[..start + 1000].to_owned(),
            "end of this page is missing",
        ),
        (text[..start - 40].to_owned(), "end of this page is missing"),
        (
            text[..text.find("class Painter").unwrap()].to_owned(),
            "is incomplete",
        ),
        (
            text[..text.find("<aside>").unwrap()].to_owned(),
            "is incomplete",
        ),
    ] {
        let outcome = message(browser, &page, &text);
        assert!(outcome.contains(reason), "{reason}: {outcome}");
    }
    // A byte in the packed positions is wrong, which only the checksum detects.
    let outcome = message(
        browser,
        &page,
        &with(&|bytes| {
            let middle = bytes.len() / 2;
            bytes[middle] ^= 0x10;
        }),
    );
    assert!(outcome.contains("damaged"), "{outcome}");
}

#[test]
fn a_browser_without_graphics_shows_a_message() {
    let Some(mut browser) = browser(&["--disable-3d-apis"]) else {
        return;
    };
    let results = Results::from_records("tests/fixtures/dense.sa", "--record 0");
    let page = results.page(0);
    let text = fs::read_to_string(&page).unwrap();
    let outcome = message(&mut browser, &page, &text);
    assert!(outcome.contains("WebGL2"), "{outcome}");
}
