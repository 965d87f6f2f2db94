//! Paths as addresses.
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

/// What stands in the path of an address as it is (RFC 3986, 3.3); a colon could be taken for a scheme's.
const KEPT: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'/')
    .remove(b'-')
    .remove(b'_')
    .remove(b'.')
    .remove(b'~');

/// A path as part of an address: what would end or change it is written in hexadecimal.
pub fn address(path: &str) -> String {
    utf8_percent_encode(path, KEPT).to_string()
}
