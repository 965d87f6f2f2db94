use std::fs;

use serde_json::Value;

use crate::stochc::{Outcome, path, stochc, stochc_with, tables};

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

    let outcome = stochc_with("compile --emit jani --format text", &[&file]);
    assert_eq!(outcome.status, 2, "{}", outcome.err);
}

/// Writes a program as a Markov chain.
fn chain_of(body: &str) -> Value {
    let outcome = emit_jani(body);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    serde_json::from_str(&outcome.out).unwrap()
}

fn emit_jani(body: &str) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "some.sa");
    fs::write(&file, body).unwrap();
    stochc_with("compile --emit jani", &[&file])
}

/// Returns the targets and the rates of the transitions of a state with this number of docking
/// blocks.
fn rates_from(chain: &Value, state: &str) -> Vec<(String, f64)> {
    let edges = chain["automata"][0]["edges"].as_array().unwrap();
    let edges = edges.iter().filter(|edge| edge["location"] == state);
    let rate = |edge: &Value| {
        let rate = &edge["rate"]["exp"];
        let target = edge["destinations"][0]["location"].as_str().unwrap();
        let value = rate.as_f64().or(rate["right"].as_f64());
        (target.to_owned(), value.unwrap())
    };
    edges.map(rate).collect()
}

const APART: &str = "assembly some { seed plate 9 x 9 { M at (1, 1)  N at (7, 7) }
    phase p { M.up -> A  N.up -> B } }";

/// Two distant faces with equal surroundings have one counter. After one capture, half of its
/// blocks are ignored, and one of 300 free blocks is missing.
#[test]
fn faces_that_open_together_share_a_counter_of_docking_blocks() {
    let chain = chain_of(APART);
    let names: Vec<&str> = (chain["variables"].as_array().unwrap().iter())
        .map(|variable| variable["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["captures", "first_1", "second_1"]);
    let both = rates_from(&chain, "0");
    let [arrivals, stage, one, other] = &both[..] else {
        panic!("{both:?}")
    };
    let half = (stage.1 / 2.0).to_bits();
    assert_eq!((one.1.to_bits(), other.1.to_bits()), (half, half));
    assert_eq!([&*one.0, &*other.0], ["1", "2"]);
    for state in ["1", "2"] {
        let left = rates_from(&chain, state);
        assert_eq!(
            left[..2],
            [(state.to_owned(), arrivals.1), (state.to_owned(), stage.1)]
        );
        let [capture, ignored] = &left[2..] else {
            panic!("{left:?}")
        };
        assert_eq!([&*capture.0, &*ignored.0], ["3", state]);
        assert!(
            (capture.1 / stage.1 - 299.0 / 600.0).abs() < 1e-12,
            "{left:?}"
        );
        assert!(
            (ignored.1 / stage.1 - 301.0 / 600.0).abs() < 1e-12,
            "{left:?}"
        );
    }
    assert!(rates_from(&chain, "3").is_empty());
}

/// The faces of C and D open together if A is captured after B. There is therefore a state for each
/// order of A and B. It has one counter if the two faces opened together, and otherwise two.
#[test]
fn groups_of_faces_depend_on_the_order_of_captures() {
    let chain = chain_of(
        "assembly some { seed plate 9 x 9 { M at (1, 1)  N at (7, 7) }
        phase p { M.up -> A  N.up -> B  A.up -> C  B.up -> D after A } }",
    );
    let edges = chain["automata"][0]["edges"].as_array().unwrap();
    let after = |first: &str, second: &str| {
        let next = |from: &str, capture: &str| {
            let edge = (edges.iter())
                .find(|edge| edge["location"] == from && edge["comment"] == capture)
                .unwrap();
            edge["destinations"][0]["location"].as_str().unwrap()
        };
        next(next("0", first), second)
    };
    let [a_first, b_first] = [
        after("M.up -> A", "N.up -> B"),
        after("N.up -> B", "M.up -> A"),
    ];
    assert_ne!(a_first, b_first);
    let counters = |state: &str| {
        let edges = edges.iter().filter(|edge| edge["location"] == state);
        edges.filter(|edge| edge["rate"]["exp"].is_number()).count()
    };
    assert_eq!([counters(a_first), counters(b_first)], [2, 1]);
}

/// A capture can change the mean docking time of a waiting face. Blocks with the later docking time
/// are counted from the start.
#[test]
fn docking_times_that_change_have_counters_of_their_own() {
    let chain = chain_of(
        "scene many from hemisphere { block cube { side 20cm  mass 1kg  faces 2 } }
        assembly some in many { seed plate 3 x 3 { M at (1, 1)  M.up -> A }
        phase p { A.up -> B  A.east -> C } }",
    );
    let edges = chain["automata"][0]["edges"].as_array().unwrap();
    let of_start = edges.iter().filter(|edge| edge["location"] == "0");
    let arrivals = of_start
        .filter(|edge| edge["rate"]["exp"].is_number())
        .count();
    let variables = chain["variables"].as_array().unwrap().len();
    // The face upwards starts with one docking time, and gets another one next to C.
    assert_eq!((arrivals, variables), (3, 7));
}

#[test]
fn programs_without_a_small_markov_chain_are_refused() {
    let in_scene = |clause: &str| {
        let text = APART.replace("some {", "some in worn {");
        format!("scene worn from hemisphere {{ {clause} }} {text}")
    };
    let masts = |count: i32, second: &str| {
        format!(
            "assembly some {{ seed plate 31 x 1 {{ for i in 1..{count} {{ M[i] at (3 * i, 0) }} }}
            phase p {{ for i in 1..{count} {{ M[i].up -> T[i]  {second} }} }} }}"
        )
    };
    for (body, reason) in [
        (
            APART.replace("phase p", "phase p timeout 90000 ticks"),
            "has a timeout",
        ),
        (
            APART.replace("N.up -> B", "N.up -> B  wait 9 s"),
            "has a `wait`",
        ),
        (
            APART.replace("} }", "} phase q { release B } }"),
            "releases blocks",
        ),
        (in_scene("messages { hop 1 ticks }"), "messages take time"),
        (in_scene("faults { latch 1% }"), "has faults"),
        (
            APART.replace("some {", "some in hemisphere_soft {"),
            "no built-in rates",
        ),
        (masts(10, ""), "more than 1000 sets of captured blocks"),
        (masts(5, "T[i].up -> U[i]"), "too many blocks can dock"),
    ] {
        let outcome = emit_jani(&body);
        assert_eq!((outcome.status, &*outcome.out), (2, ""), "{}", outcome.err);
        assert!(outcome.err.contains(reason), "{reason}: {}", outcome.err);
    }
}
