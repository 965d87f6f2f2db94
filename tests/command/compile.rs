use serde_json::Value;

use crate::stochc::stochc;

fn emit(stage: &str, form: &str) -> String {
    let said = stochc(&format!(
        "compile --emit {stage} --format {form} tests/fixtures/tower.sa"
    ));
    assert_eq!((said.status, said.err.as_str()), (0, ""), "{stage} {form}");
    said.out
}

#[test]
fn every_stage_has_a_text_and_a_json() {
    // What they hold, the snapshots of the stages say.
    for (stage, text) in [
        ("ast", "assembly tower {\n"),
        ("graph", "longest serial chain, 2: A.up -> B, B.up -> C"),
        ("table", "magnetize up for A at (1, 1, 1)"),
        ("structure", "foot"),
    ] {
        let shown = emit(stage, "text");
        assert!(shown.contains(text), "{stage}: {shown}");
        assert!(shown.ends_with('\n'));
        let value: Value = serde_json::from_str(&emit(stage, "json")).unwrap();
        assert_eq!(value.is_array(), stage == "ast");
    }
    let table = stochc("compile tests/fixtures/tower.sa").out;
    assert_eq!(
        table,
        emit("table", "text"),
        "the table is what one wants to see"
    );
}

#[test]
fn the_printed_tree_is_a_program_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = crate::stochc::path(folder.path(), "printed.sa");
    let tree = emit("ast", "text");
    std::fs::write(&file, &tree).unwrap();
    let again = crate::stochc::stochc_with("compile --emit ast", &[&file]);
    assert_eq!((again.status, again.out), (0, tree));
}

#[test]
fn pictures_are_of_one_stage_each() {
    for (form, beginning, drawn) in [("dot", "digraph", "graph"), ("svg", "<svg", "structure")] {
        let picture = emit(drawn, form);
        assert!(picture.starts_with(beginning), "{picture}");
        for stage in ["ast", "graph", "table", "structure"] {
            if stage == drawn {
                continue;
            }
            let said = stochc(&format!(
                "compile --emit {stage} --format {form} tests/fixtures/tower.sa"
            ));
            assert_eq!((said.status, said.out.as_str()), (2, ""), "{stage}");
            let instead = format!("`--emit {drawn}`");
            assert!(said.err.contains(&instead), "{}", said.err);
        }
    }
}

#[test]
fn a_wrong_program_has_no_stages() {
    for stage in ["ast", "graph", "table", "structure"] {
        let said = stochc(&format!("compile --emit {stage} tests/fixtures/wrong.sa"));
        assert_eq!((said.status, said.out.as_str()), (1, ""), "{stage}");
        assert!(said.err.contains("unknown-name"), "{}", said.err);
    }
}

#[test]
fn warnings_stay_out_of_the_output() {
    let said = stochc("compile --format json tests/fixtures/careless.sa");
    assert_eq!(said.status, 0);
    assert!(said.json()["programs"].is_array());
    assert!(said.err.contains("unused-seed"), "{}", said.err);
}
