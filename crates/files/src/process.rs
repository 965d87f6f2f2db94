//! Status of this process.

/// Returns a field of `/proc/self/status` (proc(5)), such as `SigIgn`. Returns `None` except on
/// Linux.
pub fn status(field: &str) -> Option<String> {
    let status = crate::read("/proc/self/status").ok()?;
    let status = String::from_utf8_lossy(&status);
    let value = (status.lines()).find_map(|line| line.strip_prefix(field)?.strip_prefix(':'))?;
    Some(value.trim().to_owned())
}
