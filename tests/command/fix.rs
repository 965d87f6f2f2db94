//! Tests `stochc check --fix` through the command line.
use std::fs;

use crate::stochc::{path, stochc, stochc_with};

const WRONG: &str = "\
// kept
assembly a {
    seed plate 2 x 1 { M at (0, 0)  N at (1, 0) }
    phaze p { M.up => A }
}
";

const DIFF: &str = "\
@@ -1,5 +1,5 @@
 // kept
 assembly a {
-    seed plate 2 x 1 { M at (0, 0)  N at (1, 0) }
-    phaze p { M.up => A }
+    seed plate 2 x 1 { M at (0, 0) }
+    phase p { M.up -> A }
 }
";

const RIGHT: &str = "\
// kept
assembly a {
    seed plate 2 x 1 { M at (0, 0) }
    phase p { M.up -> A }
}
";

/// Returns a folder with one file, and the path of the file.
fn file(text: &[u8]) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "a.sa");
    fs::write(&file, text).unwrap();
    (folder, file)
}

#[test]
fn fixes_are_applied_and_the_rest_is_reported() {
    let (_folder, file) = file(WRONG.as_bytes());
    let outcome = stochc_with("check --fix", &[&file]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(outcome.out.contains(DIFF), "{}", outcome.out);
    assert!(
        outcome.out.contains("a: 1 capture in 1 phase\n  proved: "),
        "{}",
        outcome.out
    );
    assert!(outcome.err.contains("3 changes made"), "{}", outcome.err);
    assert_eq!(fs::read_to_string(&file).unwrap(), RIGHT);
    let outcome = stochc_with("check --fix", &[&file]);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    assert!(!outcome.out.contains("@@"), "{}", outcome.out);
}

#[test]
fn a_dry_run_writes_nothing() {
    let (_folder, file) = file(WRONG.as_bytes());
    let outcome = stochc_with("check --fix --dry-run", &[&file]);
    assert_eq!(outcome.status, 1);
    assert!(outcome.out.ends_with(DIFF), "{}", outcome.out);
    assert!(
        outcome.err.ends_with("3 changes to make\n"),
        "{}",
        outcome.err
    );
    assert_eq!(fs::read_to_string(&file).unwrap(), WRONG);
    // Only the remaining diagnostics are shown.
    let rest = WRONG.replace(
        "phaze p { M.up => A }",
        "phase p { M.up -> A; }\n    phase q { Quux.up -> C }",
    );
    fs::write(&file, &rest).unwrap();
    let outcome = stochc_with("check --fix --dry-run", &[&file]);
    assert_eq!(outcome.status, 1);
    assert!(
        outcome.err.contains("1 change to make\n"),
        "{}",
        outcome.err
    );
    assert!(
        outcome.err.contains("cannot find block `Quux`"),
        "{}",
        outcome.err
    );
    assert!(!outcome.err.contains("A;"), "{}", outcome.err);
    assert!(outcome.err.contains("\n1 error"), "{}", outcome.err);
    assert_eq!(fs::read_to_string(&file).unwrap(), rest);
    assert_eq!(stochc_with("check --dry-run", &[&file]).status, 2);
}

#[test]
fn byte_order_mark_and_line_endings_are_preserved() {
    let windows = format!("\u{feff}{}", WRONG.replace('\n', "\r\n"));
    let (_folder, file) = file(windows.as_bytes());
    // With `--json`, the diff is still printed to standard error.
    let shown = stochc_with("check --fix --dry-run --json", &[&file]);
    assert!(!shown.err.contains("U+000D"), "{}", shown.err);
    assert!(shown.err.contains("\n-    phaze p"), "{}", shown.err);
    assert_eq!(stochc_with("check --fix", &[&file]).status, 0);
    let right = format!("\u{feff}{}", RIGHT.replace('\n', "\r\n"));
    assert_eq!(fs::read_to_string(&file).unwrap(), right);
}

#[test]
fn documents_are_not_mixed_with_the_diff() {
    for format in ["json", "sarif"] {
        let (_folder, file) = file(WRONG.as_bytes());
        let outcome = stochc_with(&format!("check --fix --format {format}"), &[&file]);
        assert_eq!(outcome.status, 0);
        outcome.json();
        assert!(outcome.err.contains(DIFF), "{}", outcome.err);
    }
}

#[test]
fn imported_files_are_not_fixed() {
    let (folder, file) = file(b"import \"b.sa\"\n");
    let imported = path(folder.path(), "b.sa");
    fs::write(&imported, "let n = 1;\n").unwrap();
    let outcome = stochc_with("check --fix", &[&file]);
    assert_eq!((outcome.status, outcome.out.as_str()), (1, ""));
    assert_eq!(fs::read_to_string(&imported).unwrap(), "let n = 1;\n");
    assert_eq!(stochc_with("check --fix", &[&imported]).status, 0);
    assert_eq!(fs::read_to_string(&imported).unwrap(), "let n = 1\n");
}

#[test]
fn unreadable_files_are_reported_as_by_check() {
    for file in ["tests/fixtures/none.sa", "/dev/null"] {
        let plain = stochc(&format!("check {file}"));
        let fixed = stochc(&format!("check --fix {file}"));
        assert_eq!(
            (fixed.status, fixed.out, fixed.err),
            (plain.status, plain.out, plain.err)
        );
    }
}

#[test]
#[cfg(unix)]
fn links_permissions_and_protected_files() {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let (folder, file) = file(WRONG.as_bytes());
    let link = path(folder.path(), "link.sa");
    symlink("a.sa", &link).unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o400)).unwrap();
    let outcome = stochc_with("check --fix", &[&link]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("is left as it is: permission denied"),
        "{}",
        outcome.err
    );
    assert_eq!(fs::read_to_string(&file).unwrap(), WRONG);
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
    assert_eq!(stochc_with("check --fix", &[&link]).status, 0);
    assert_eq!(fs::read_to_string(&file).unwrap(), RIGHT);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(
        fs::metadata(&file).unwrap().permissions().mode() & 0o777,
        0o640
    );
}
