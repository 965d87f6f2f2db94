//! Paths as parts of URLs.
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

/// Characters that need no escape in a path (RFC 3986, section 3.3). A colon is escaped, because it
/// could end a scheme.
const ESCAPED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'/')
    .remove(b'-')
    .remove(b'_')
    .remove(b'.')
    .remove(b'~');

/// Returns a path as part of a URL, with special characters percent-encoded.
pub fn address(path: &str) -> String {
    utf8_percent_encode(path, ESCAPED).to_string()
}
