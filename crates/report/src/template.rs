//! HTML pages with a script, made from a template with placeholders and a restrictive content
//! policy.
use std::io::{self, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use sha2::{Digest as _, Sha256};

/// Writes a template. Calls `put` to write the content of each placeholder `@NAME@`.
///
/// # Errors
///
/// Errors of `put` and `out`.
pub(crate) fn fill<W: Write>(
    template: &str,
    out: &mut W,
    mut put: impl FnMut(&str, &mut W) -> io::Result<()>,
) -> io::Result<()> {
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('@') {
        out.write_all(before.as_bytes())?;
        let (name, after) = after.split_once('@').unwrap_or((after, ""));
        rest = after;
        put(name, out)?;
    }
    out.write_all(rest.as_bytes())
}

/// Returns a content policy that forbids all external resources and allows only this script.
pub(crate) fn policy(script: &str) -> String {
    let hash = BASE64.encode(Sha256::digest(script.as_bytes()));
    format!(
        "default-src 'none'; script-src 'sha256-{hash}'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
    )
}
