use std::fs;

use serde_json::Value;

use crate::stochc::{path, stochc, stochc_with, tables};

fn emit(stage: &str, form: &str) -> String {
    let outcome = stochc(&format!(
        "compile --emit {stage} --format {form} tests/fixtures/tower.sa"
    ));
    assert_eq!(
        (outcome.status, outcome.err.as_str()),
        (0, ""),
        "{stage} {form}"
    );
    outcome.out
}

#[test]
fn every_stage_has_a_text_and_a_json() {
    // Snapshots check the contents of all stages.
    for (stage, text) in [
        ("graph", "longest serial chain, 2: A.up -> B, B.up -> C"),
        ("table", "magnetize up for A at (1, 1, 1)"),
        ("structure", "foot"),
    ] {
        let shown = emit(stage, "text");
        assert!(shown.contains(text), "{stage}: {shown}");
        assert!(shown.ends_with('\n'));
        let value: Value = serde_json::from_str(&emit(stage, "json")).unwrap();
        assert_eq!(value["format"], 1);
        assert!(value["programs"].is_array(), "{stage}");
    }
    let table = stochc("compile tests/fixtures/tower.sa").out;
    assert_eq!(
        table,
        emit("table", "text"),
        "the default stage is the table"
    );
}

/// The volume is the sum of the signed volumes of the triangles with the origin.
#[test]
fn the_surface_of_a_structure_encloses_the_volume_of_its_blocks() {
    let file = "examples/five_tower.sa";
    let surface = stochc(&format!("compile --emit structure --format stl {file}")).out;
    let number = |word: &str| word.parse::<f64>().unwrap();
    let corners = surface.lines().filter_map(|it| it.strip_prefix("vertex "));
    let corners = corners.flat_map(|it| it.split(' ').map(number));
    let corners: Vec<f64> = corners.collect();
    let volumes = corners.chunks(9).map(|of| {
        let [a, b, c] = [&of[..3], &of[3..6], &of[6..]];
        let cross = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
        (a[0] * cross(1, 2) + a[1] * cross(2, 0) + a[2] * cross(0, 1)) / 6.0
    });
    // Ten blocks of 20 cm.
    let expected = 10.0 * 200_f64.powi(3);
    assert!((volumes.sum::<f64>() / expected - 1.0).abs() < 1e-9);
    let heights = corners.iter().skip(2).step_by(3).copied();
    assert_eq!(
        heights.fold((1.0, 0.0), |(low, high), z| (z.min(low), z.max(high))),
        (0.0, 400.0)
    );
}

#[test]
fn pictures_are_of_one_stage_each() {
    for (form, beginning, drawn) in [
        ("dot", "digraph", "graph"),
        ("svg", "<svg", "structure"),
        ("stl", "solid", "structure"),
    ] {
        let picture = emit(drawn, form);
        assert!(picture.starts_with(beginning), "{picture}");
        for stage in ["graph", "table", "structure"] {
            if stage == drawn {
                continue;
            }
            let outcome = stochc(&format!(
                "compile --emit {stage} --format {form} tests/fixtures/tower.sa"
            ));
            assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{stage}");
            let instead = format!("`--emit {drawn}`");
            assert!(outcome.err.contains(&instead), "{}", outcome.err);
        }
    }
}

#[test]
fn one_of_several_programs_is_shown_if_it_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "two.sa");
    let of = |name| {
        format!(
            "assembly {name} {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> {name}_block }} }}\n"
        )
    };
    fs::write(&file, format!("{}{}", of("a"), of("b"))).unwrap();
    for stage in ["graph", "table"] {
        let both = stochc_with(&format!("compile --emit {stage}"), &[&file]);
        let one = stochc_with(&format!("compile --emit {stage} --program b"), &[&file]);
        assert_eq!((both.status, one.status), (0, 0), "{}{}", both.err, one.err);
        assert!(both.out.contains("a_block") && both.out.contains("b_block"));
        assert!(!one.out.contains("a_block") && one.out.contains("b_block"));
    }
    let picture = "compile --emit structure --format svg";
    let both = stochc_with(picture, &[&file]);
    assert_eq!((both.status, both.out.as_str()), (2, ""));
    assert!(both.err.contains("`--program`: `a`, `b`"), "{}", both.err);
    let one = stochc_with(&format!("{picture} --program b"), &[&file]);
    assert_eq!((one.status, one.out.matches("<svg").count()), (0, 1));
    let outcome = stochc_with("compile --program c", &[&file]);
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    assert!(
        outcome.err.contains("no program `c`, but `a`, `b`"),
        "{}",
        outcome.err
    );
}

#[test]
fn a_wrong_program_has_no_stages() {
    for stage in ["graph", "table", "structure"] {
        let outcome = stochc(&format!("compile --emit {stage} tests/fixtures/wrong.sa"));
        assert_eq!((outcome.status, outcome.out.as_str()), (1, ""), "{stage}");
        assert!(outcome.err.contains("unknown-name"), "{}", outcome.err);
    }
}

#[test]
fn warnings_stay_out_of_the_output() {
    let outcome = stochc("compile --format json tests/fixtures/careless.sa");
    assert_eq!(outcome.status, 0);
    assert!(outcome.json()["programs"].is_array());
    assert!(outcome.err.contains("unused-seed"), "{}", outcome.err);
}

#[test]
fn an_executable_is_simulated_without_its_source() {
    let folder = tempfile::tempdir().unwrap();
    let [program, there, here] = ["X", "there", "here"].map(|name| path(folder.path(), name));
    let compile = "compile --emit executable tests/fixtures/importing.sa";
    let outcome = stochc_with(compile, &["--out", &program]);
    assert_eq!(
        (outcome.status, outcome.out.as_str()),
        (0, ""),
        "{}",
        outcome.err
    );
    assert_eq!(stochc(compile).out, fs::read_to_string(&program).unwrap());
    let options = ["--model", "shuffle", "--runs", "5", "--quiet", "--out"];
    let simulate = |file: &str, out: &str| {
        let outcome = stochc_with("simulate", &[&[file], &options[..], &[out]].concat());
        assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
        outcome.out
    };
    let text = simulate("tests/fixtures/importing.sa", &there);
    assert_eq!(simulate(&program, &here), text);
    assert!(tables(&there) != tables(&here), "their identities differ");
    let bonds = |out: &str| stochc_with("show --captures", &[out]).out;
    assert_eq!(bonds(&there), bonds(&here));
    let outcome = stochc_with("report --quiet", &[&here]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let outcome = stochc_with("sweep --vary free=10..20/2", &[&program]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("is already compiled"),
        "{}",
        outcome.err
    );
}

#[test]
fn an_empty_executable_is_neither_written_nor_run() {
    let folder = tempfile::tempdir().unwrap();
    let [empty, out, none] =
        ["empty.sa", "out.json", "none.json"].map(|it| path(folder.path(), it));
    fs::write(&empty, "").unwrap();
    let outcome = stochc_with("compile --emit executable", &[&empty, "--out", &out]);
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    assert!(
        outcome.err.contains("declares no assembly"),
        "{}",
        outcome.err
    );
    let nothing = r#"{"kind":"stochc executable","format":1,"programs":[]}"#;
    fs::write(&none, nothing).unwrap();
    for command in ["estimate", "simulate --runs 1"] {
        let outcome = stochc_with(command, &[&none]);
        assert_eq!(outcome.status, 2, "{}", outcome.err);
        assert!(
            outcome.err.contains("contains no program"),
            "{}",
            outcome.err
        );
    }
}

#[test]
fn a_corrupted_executable_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let program = path(folder.path(), "X");
    let compile = "compile --emit executable tests/fixtures/tower.sa --out";
    stochc_with(compile, &[&program]);
    let text = fs::read_to_string(&program).unwrap();
    for (edited, reason) in [
        (
            text.replacen("\"format\":1", "\"format\":2", 1),
            "its format is 2",
        ),
        (text[..text.len() / 2].to_owned(), "it is damaged"),
        (
            text.replacen("\"faces\":1", "\"faces\":7", 1),
            "has no 7 faces",
        ),
        (
            text.replacen("\"faces\":1", "\"faces\":1,\"fases\":2", 1),
            "nothing is known of its field `programs.0.tables.fases`",
        ),
    ] {
        fs::write(&program, edited).unwrap();
        let outcome = stochc_with("simulate", &[&program]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{reason}");
        assert!(outcome.err.contains(reason), "{}", outcome.err);
    }
}

/// The chain has three transitions for each capture. The claim about completion is a property.
#[test]
fn the_rate_model_is_written_as_a_markov_chain() {
    let folder = tempfile::tempdir().unwrap();
    let [file, chain] = ["mast.sa", "mast.jani"].map(|name| path(folder.path(), name));
    let mast = "assembly mast { seed plate 1 x 1 { M at (0, 0) } phase grow { M.up ->> T[1..3] }
        expect complete within 30.5 s with probability >= 0.9
        expect mean completion <= 4000 ticks }";
    fs::write(&file, mast).unwrap();
    let outcome = stochc_with(&format!("compile --emit jani --out {chain}"), &[&file]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let chain: Value = serde_json::from_str(&fs::read_to_string(&chain).unwrap()).unwrap();
    assert_eq!(chain["type"], "ctmc");
    let edges = chain["automata"][0]["edges"].as_array().unwrap();
    assert_eq!(edges.len(), 9);
    for edge in edges.iter().step_by(3) {
        let rate = edge["rate"]["exp"].as_f64().unwrap();
        assert!((1e-4..1e-1).contains(&rate), "{rate}");
    }
    let properties = chain["properties"].as_array().unwrap();
    assert_eq!(properties.len(), 1);
    let time = &properties[0]["expression"]["values"]["exp"]["time-bounds"]["upper"];
    assert_eq!(time, 1525.0);

    let two = mast.replace("1 x 1 { M at (0, 0) }", "3 x 1 { M at (0, 0) N at (2, 0) }");
    let two = two.replace("M.up ->>", "N.up -> U  M.up ->>");
    fs::write(&file, two).unwrap();
    let outcome = stochc_with("compile --emit jani", &[&file]);
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    assert!(
        outcome.err.contains("one after the other"),
        "{}",
        outcome.err
    );
    let outcome = stochc_with("compile --emit jani --format text", &[&file]);
    assert_eq!(outcome.status, 2, "{}", outcome.err);
}
