use crate::stochc::{path, stochc_with};

#[test]
fn a_folder_tells_what_was_told_when_it_was_filled() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate =
        "simulate --quiet --model shuffle --runs 4 tests/fixtures/tower.sa tests/fixtures/late.sa";
    for form in [
        &[][..],
        &["--bonds"],
        &["--format", "json"],
        &["--format", "json", "--bonds"],
    ] {
        let told = stochc_with(simulate, &[&["--out", &out], form].concat());
        let again = stochc_with("results", &[&[out.as_str()], form].concat());
        assert_eq!((told.status, again.status), (3, 3), "one program times out");
        assert_eq!(again.err, "");
        assert_eq!(told.out, again.out);
    }
}

#[test]
fn what_holds_no_results_is_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let missing = path(folder.path(), "missing");
    for place in [
        folder.path().to_str().unwrap(),
        &missing,
        "tests/fixtures",
        "Cargo.toml",
    ] {
        let said = stochc_with("results", &[place]);
        assert_eq!((said.status, said.out.as_str()), (2, ""), "{place}");
        assert!(
            said.err.contains(&format!("`{place}` holds no results")),
            "{}",
            said.err
        );
    }
}
