//! Tests files of compiled programs. Reading a file returns the same programs, and invalid files
//! are rejected.
use std::ops::ControlFlow;

use proptest::prelude::*;
use serde_json::{Value, json};
use stochc::compiler::Program;
use stochc::ir::{Executable, ExecutableError};
use stochc::runtime::{Model, Settings, run};

fn executables(path: &str) -> Vec<Executable> {
    let checked = stochc::check(path);
    assert!(!checked.has_errors(), "{path}: {:?}", checked.diagnostics);
    let programs = checked.programs.into_iter();
    programs.filter_map(Program::into_executable).collect()
}

fn written(programs: &[Executable]) -> Vec<u8> {
    let mut file = Vec::new();
    Executable::write_all(programs, &mut file).unwrap();
    file
}

fn examples() -> Vec<String> {
    let files = std::fs::read_dir("examples").unwrap();
    let paths = files.map(|file| file.unwrap().path().display().to_string());
    let mut paths: Vec<String> = paths.filter(|path| path.ends_with(".sa")).collect();
    paths.sort();
    paths
}

#[test]
fn an_executable_survives_a_round_trip() {
    let mut count = 0;
    for path in examples() {
        let programs = executables(&path);
        let file = written(&programs);
        let read = Executable::read_all(&file).unwrap();
        assert_eq!(read, programs, "{path}");
        let identity = |programs: &[Executable]| -> Vec<String> {
            programs.iter().map(Executable::identity).collect()
        };
        assert_eq!(identity(&read), identity(&programs));
        count += programs.len();
    }
    assert!(count > 10, "{count}");
}

#[test]
fn distinguishes_foreign_from_corrupted_files() {
    let read = |bytes: &[u8]| Executable::read_all(bytes).unwrap_err();
    assert!(matches!(
        read(b"assembly a { }"),
        ExecutableError::OtherFile
    ));
    assert!(matches!(
        read(b"{\"format\":1}"),
        ExecutableError::OtherFile
    ));
    let file = written(&executables("examples/line.sa"));
    let text = String::from_utf8(file).unwrap();
    let newer = text.replacen("\"format\":1", "\"format\":7", 1);
    assert!(matches!(
        read(newer.as_bytes()),
        ExecutableError::OtherFormat(7)
    ));
    let half = &text[..text.len() / 2];
    assert!(matches!(
        read(half.as_bytes()),
        ExecutableError::Corrupted(_)
    ));
    for (what, otherwise) in [
        ("\"faces\":1", "\"faces\":9"),
        ("\"role\":0", "\"role\":4000"),
        ("\"phase\":0", "\"phase\":12"),
        ("\"width\":", "\"width\":99999"),
        ("\"tick\":", "\"tick\":-"),
    ] {
        let corrupted = text.replacen(what, otherwise, 1);
        assert_ne!(corrupted, text, "{what}");
        let error = read(corrupted.as_bytes());
        assert!(
            matches!(
                error,
                ExecutableError::Corrupted(_) | ExecutableError::Invalid(_)
            ),
            "{what}: {error}"
        );
    }
}

/// Checks files whose parts are each valid, but inconsistent with each other.
#[test]
fn mismatched_parts_are_named() {
    type Edit<'a> = &'a dyn Fn(&mut Value);
    let file = written(&executables("examples/line.sa"));
    let line: Value = serde_json::from_slice(&file).unwrap();
    let read = |program: Edit| {
        let mut file = line.clone();
        program(&mut file["programs"][0]);
        Executable::read_all(file.to_string().as_bytes())
    };
    assert!(read(&|_| {}).is_ok());
    let roles = &line["programs"][0]["tables"]["roles"];
    let captured = (roles.as_array().unwrap().iter()).position(|role| role["seed"].is_null());
    let captured = captured.unwrap();
    let edits: [(&str, Edit); 7] = [
        ("tables.bond", &|it| it["tables"]["bond"] = json!("reject")),
        ("tables.faces", &|it| it["tables"]["faces"] = json!(2)),
        ("tables.phases[0].reports", &|it| {
            it["tables"]["phases"][0]["reports"] = json!(0)
        }),
        ("tables.phases[0].timeout", &|it| {
            it["tables"]["phases"][0]["timeout"] = json!(0)
        }),
        ("scene.free.count", &|it| {
            it["scene"]["free"]["count"] = json!(1)
        }),
        (&format!("tables.roles[{captured}].name"), &|it| {
            it["tables"]["roles"][captured]["name"] = it["tables"]["roles"][0]["name"].clone()
        }),
        (&format!("tables.roles[{captured}].seed"), &|it| {
            // Seeds must come first in the list of roles.
            let roles = it["tables"]["roles"].as_array_mut().unwrap();
            for role in &mut roles[..=captured] {
                role["seed"] = json!([0, 0, 0]);
            }
        }),
    ];
    for (field, edit) in edits {
        let error = read(edit).unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains(&format!("`{field}`")),
            "{field}: {message}"
        );
    }
}

/// Returns the position and length of each number in a JSON text.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let is_digit = |c: char| c.is_ascii_digit();
    let mut found = Vec::new();
    let mut from = 0;
    while let Some(begin) = text[from..].find(is_digit).map(|at| from + at) {
        let rest = &text[begin..];
        let length = rest.find(|c: char| !is_digit(c)).unwrap_or(rest.len());
        found.push((begin, length));
        from = begin + length;
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Checks that a file with changed numbers is rejected, or can be run.
    #[test]
    fn an_edited_file_is_rejected_or_run(
        example in 0usize..6,
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0u32..40), 1..4),
    ) {
        let names = ["line", "five_tower", "five_tower_reconfigured", "experiment_2", "experiment_3", "suction_growth"];
        let path = format!("examples/{}.sa", names[example]);
        let mut text = String::from_utf8(written(&executables(&path))).unwrap();
        for (place, value) in edits {
            let (begin, length) = *place.get(&numbers(&text));
            text.replace_range(begin..begin + length, &value.to_string());
        }
        let Ok(programs) = Executable::read_all(text.as_bytes()) else {
            return Ok(());
        };
        for program in programs.iter().filter(|program| program.scene.free.count < 10_000) {
            let settings = Settings {
                max_ticks: Some(300),
                ..Settings::new(Model::Shuffle, 1)
            };
            let mut proceed = |_, _| ControlFlow::Continue(());
            // An error is allowed here, but a panic is not.
            let _ = run(&program.tables, &program.scene, &settings, 1, 0, &mut proceed);
        }
    }
}
