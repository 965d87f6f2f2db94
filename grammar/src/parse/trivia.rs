//! Skips space and comments between tokens.

/// Returns the first byte from `at` on that is neither blank nor part of a comment.
pub fn skip(text: &str, mut at: usize) -> usize {
    let bytes = text.as_bytes();
    loop {
        while at < bytes.len() && matches!(bytes[at], b' ' | b'\t' | b'\r' | b'\n') {
            at += 1;
        }
        if !is_comment(&bytes[at..]) {
            return at;
        }
        at = end_of_line(bytes, at);
    }
}

/// Returns the line end at or after `at`, or the end of the source.
pub fn end_of_line(bytes: &[u8], at: usize) -> usize {
    bytes[at..]
        .iter()
        .position(|&byte| byte == b'\n')
        .map_or(bytes.len(), |offset| at + offset)
}

/// Returns whether a text begins with a comment. Two slashes, or more than three, begin a comment.
/// Three slashes begin documentation.
pub fn is_comment(rest: &[u8]) -> bool {
    rest.starts_with(b"//") && (!rest.starts_with(b"///") || rest.starts_with(b"////"))
}
