//! Conversion between file paths and URIs.
use percent_encoding::percent_decode_str;
use stochc_files::address::address;

/// Returns the path of a file URI, with `/` between folders. Other URIs are returned unchanged.
pub fn path(uri: &str) -> String {
    let Some(rest) = uri.strip_prefix("file://") else {
        return uri.to_owned();
    };
    // The host name is ignored: it is this machine.
    let path = rest.find('/').map_or(rest, |slash| &rest[slash..]);
    let path = percent_decode_str(path).decode_utf8_lossy();
    // `/c:/x` is `c:/x` on systems with drive letters.
    match path.as_bytes() {
        [b'/', drive, b':', ..] if drive.is_ascii_alphabetic() => path[1..].to_owned(),
        _ => path.into_owned(),
    }
}

pub fn uri(path: &str) -> String {
    if path.contains("://") || path.starts_with("untitled:") {
        return path.to_owned();
    }
    let slash = if path.starts_with('/') { "" } else { "/" };
    format!("file://{slash}{}", address(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_and_addresses() {
        for (at, file) in [
            ("file:///a/b%20c/%C2%B5.sa", "/a/b c/\u{b5}.sa"),
            ("file:///c%3A/x.sa", "c:/x.sa"),
            ("untitled:Untitled-1", "untitled:Untitled-1"),
        ] {
            assert_eq!(path(at), file);
            assert_eq!(uri(file), at);
        }
        assert_eq!(path("file://localhost/a%zz"), "/a%zz");
        assert_eq!(path("file:///%ff"), "/\u{fffd}");
    }
}
