//! Pages or parts of pages in the documentation that are generated from code.
#![allow(dead_code, reason = "each test uses only some of these functions")]
#![allow(
    clippy::disallowed_methods,
    reason = "pages are compared with the expected text, or written"
)]

/// Environment variable that makes a test update its page instead of comparing it.
const SWITCH: &str = "STOCHC_WRITE_DOCS";

/// Compares a page with the expected text. Updates it instead if requested.
#[track_caller]
pub fn assert_page(path: &str, expected: &str) {
    if std::env::var_os(SWITCH).is_some() {
        std::fs::write(path, expected).expect("the page can be written");
        return;
    }
    let page = std::fs::read_to_string(path).unwrap_or_default();
    for (number, (here, expected)) in page.lines().zip(expected.lines()).enumerate() {
        let line = number + 1;
        assert_eq!(here, expected, "{path}:{line}; {SWITCH}=1 rewrites it");
    }
    assert!(
        page == expected,
        "{path} has a different end; {SWITCH}=1 rewrites it"
    );
}

/// Compares the part of a page between two marks with the expected text. Updates it instead if
/// requested.
#[track_caller]
pub fn assert_part(path: &str, [begin, end]: [&str; 2], expected: &str) {
    let page = std::fs::read_to_string(path).expect("the page exists");
    let (before, rest) = page.split_once(begin).expect("the start of the part");
    let (_, after) = rest.split_once(end).expect("the end of the part");
    assert_page(path, &format!("{before}{begin}{expected}{end}{after}"));
}

/// Compares a table with the table on a page that has the same header. Updates the page instead if
/// requested.
#[track_caller]
pub fn assert_table(path: &str, table: &str) {
    let page = std::fs::read_to_string(path).expect("the page exists");
    let head = table.lines().next().expect("a header");
    let start = page.find(head).expect("a table with this header");
    let end = page[start..].find("\n\n").expect("the end of the table");
    let end = start + end + 1;
    assert_page(path, &[&page[..start], table, &page[end..]].concat());
}
