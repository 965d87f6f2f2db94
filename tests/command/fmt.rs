use crate::stochc::{command, path, run_command, stochc, stochc_reading, stochc_with};

const CARELESS: &str = "assembly a{seed plate 1 x 1{M at(0,0)}// plate\nphase p{M.up->A}}";
const LAID_OUT: &str = "\
assembly a {
    seed plate 1 x 1 { M at (0, 0) }   // plate
    phase p { M.up -> A }
}
";

#[test]
fn files_are_formatted_in_place() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("deep/er");
    std::fs::create_dir_all(&inner).unwrap();
    let (a, b) = (path(folder.path(), "a.sa"), path(&inner, "b.sa"));
    let text = path(folder.path(), "c.txt");
    for file in [&a, &b, &text] {
        std::fs::write(file, CARELESS).unwrap();
    }
    let outcome = stochc_with("fmt", &[folder.path().to_str().unwrap()]);
    assert_eq!(
        (outcome.status, outcome.out, outcome.err),
        (0, String::new(), String::new())
    );
    assert_eq!(std::fs::read_to_string(&a).unwrap(), LAID_OUT);
    assert_eq!(std::fs::read_to_string(&b).unwrap(), LAID_OUT);
    assert_eq!(std::fs::read_to_string(&text).unwrap(), CARELESS);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
    assert_eq!(stochc_with("fmt --check", &[&a, &b]).status, 0);
}

#[test]
fn check_prints_a_diff_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "a.sa");
    std::fs::write(&file, LAID_OUT.replace("M.up -> A", "M.up->A")).unwrap();
    let outcome = stochc_with("fmt --check", &[&file]);
    assert_eq!(outcome.status, 1);
    for line in [
        "-    phase p { M.up->A }\n",
        "+    phase p { M.up -> A }\n",
        "@@ -1,4 +1,4 @@",
    ] {
        assert!(outcome.out.contains(line), "{}", outcome.out);
    }
    assert!(std::fs::read_to_string(&file).unwrap().contains("M.up->A"));
}

#[test]
fn a_program_with_errors_is_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (path(folder.path(), "a.sa"), path(folder.path(), "b.sa"));
    std::fs::write(&a, "assembly a  {").unwrap();
    std::fs::write(&b, CARELESS).unwrap();
    let outcome = stochc_with("fmt", &[&a, &b]);
    assert_eq!(outcome.status, 1);
    assert!(outcome.err.contains("unclosed-brace"), "{}", outcome.err);
    assert_eq!(std::fs::read_to_string(&a).unwrap(), "assembly a  {");
    assert_eq!(std::fs::read_to_string(&b).unwrap(), LAID_OUT);

    std::fs::write(&a, b"// \xff").unwrap();
    assert_eq!(stochc_with("fmt", &[&a]).status, 1);
    let outcome = stochc_with("fmt", &[&path(folder.path(), "none.sa")]);
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("file not found"), "{}", outcome.err);
}

#[test]
#[cfg(unix)]
fn permissions_and_links_are_preserved() {
    use std::fs::Permissions;
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (path(folder.path(), "a.sa"), path(folder.path(), "link.sa"));
    std::fs::write(&file, CARELESS).unwrap();
    std::fs::set_permissions(&file, Permissions::from_mode(0o640)).unwrap();
    symlink("a.sa", &link).unwrap();
    assert_eq!(stochc_with("fmt", &[&link]).status, 0);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), LAID_OUT);
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    let mode = std::fs::metadata(&file).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o640);
}

#[test]
fn standard_input_is_formatted_to_standard_output() {
    assert_eq!(stochc_reading("fmt -", CARELESS).out, LAID_OUT);
    assert_eq!(run_command(&mut command(["fmt", "-"])).out, "");
}

#[test]
fn the_byte_order_mark_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "a.sa");
    std::fs::write(&file, format!("\u{feff}{LAID_OUT}")).unwrap();
    assert_eq!(stochc_with("fmt --check", &[&file]).status, 1);
    assert_eq!(stochc_with("fmt", &[&file]).status, 0);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), LAID_OUT);
}

/// Checks that `fmt` does not change files that `check` rejects.
#[test]
fn a_lone_carriage_return_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "a.sa");
    let text = LAID_OUT.replacen('\n', "\r", 1);
    std::fs::write(&file, &text).unwrap();
    let outcome = stochc_with("fmt", &[&file]);
    assert_eq!(outcome.status, 1);
    assert!(
        outcome.err.contains("carriage return without a line feed"),
        "{}",
        outcome.err
    );
    assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
}

#[test]
fn the_programs_of_this_project_are_formatted() {
    let outcome = stochc("fmt --check examples compiler/src/scene/hemisphere.sa");
    assert_eq!(
        (outcome.status, outcome.out.as_str(), outcome.err.as_str()),
        (0, "", "")
    );
}
