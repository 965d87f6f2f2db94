//! Tests `stochc plan`.
use std::fs;
use std::path::Path;

use crate::plan_voxels::vox;
use crate::stochc::{path, stochc, stochc_with, unfolded};

const FIVE: &str = "plan examples/five_tower.sa --quiet --tries 20";

#[test]
fn a_program_is_planned_and_passes_every_check() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "five.sa");
    let outcome = stochc_with(FIVE, &["--explain", "--out", &out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome.out.contains("opening order of the faces"),
        "{}",
        outcome.out
    );
    let checked = stochc_with("check --deny warnings", &[&out]);
    assert_eq!(checked.status, 0, "{}", checked.err);
    assert_eq!(stochc_with("fmt --check", &[&out]).status, 0);
    // Without `--out`, the program goes to standard output, and the explanation to standard error.
    let outcome = stochc(&format!("{FIVE} --explain"));
    assert_eq!(outcome.out, fs::read_to_string(&out).unwrap());
    assert!(
        outcome.err.contains("opening order of the faces"),
        "{}",
        outcome.err
    );
    // Existing files are not overwritten.
    let outcome = stochc_with(FIVE, &["--out", &out]);
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("cannot write"), "{}", outcome.err);
}

#[test]
fn a_plan_is_available_as_json() {
    let document = stochc(&format!("{FIVE} --json --minimize p90")).json();
    assert_eq!(document["plan"]["captures"].as_array().unwrap().len(), 10);
    assert!(
        document["program"]
            .as_str()
            .unwrap()
            .contains("yields five_towers")
    );
}

/// Checks that the estimate of a plan equals the estimate of `check --cost`, with built-in rates or
/// with given rates.
#[test]
fn the_estimate_agrees_with_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let planned = |name: &str, more: &[&str]| -> (f64, f64) {
        let out = path(folder.path(), name);
        let document = stochc_with(
            &format!("{FIVE} --json"),
            &[more, &["--out", &out]].concat(),
        )
        .json();
        let cost = stochc_with("check --cost=1", &[&[out.as_str()], more].concat());
        let row = cost
            .out
            .lines()
            .rfind(|line| line.trim_start().starts_with("grow  "));
        let row = row.unwrap_or_else(|| panic!("{}{}", cost.out, cost.err));
        let mean = row.split_whitespace().nth(3).unwrap();
        (
            document["plan"]["estimate"]["mean"].as_f64().unwrap(),
            mean.replace(',', "").parse().unwrap(),
        )
    };
    let (built_in, cost) = planned("built_in.sa", &[]);
    assert!((built_in - cost).abs() <= 0.5, "{built_in} {cost}");
    // The same rates, but with half the arrival rates.
    let rates = fs::read_to_string("crates/estimate/src/data/hemisphere.rates").unwrap();
    let mut rates: serde_json::Value = serde_json::from_str(&rates).unwrap();
    let rate = rates["parameters"][0].as_f64().unwrap();
    rates["parameters"][0] = (rate - 0.5_f64.recip().ln()).into();
    let file = path(folder.path(), "half.rates");
    fs::write(&file, rates.to_string()).unwrap();
    let (half, cost) = planned("half.sa", &["--rates", &file]);
    assert!((half - cost).abs() <= 0.5, "{half} {cost}");
    assert!((1.3..2.1).contains(&(half / built_in)), "{half} {built_in}");
    let (status, message) = wrong(&format!("{FIVE} --rates nowhere.rates"), &[]);
    assert_eq!(status, 2);
    assert!(message.contains("nowhere.rates"), "{message}");
}

pub fn wrong(line: &str, more: &[&str]) -> (i32, String) {
    let outcome = stochc_with(line, more);
    assert_eq!(outcome.out, "");
    (outcome.status, outcome.err)
}

#[test]
fn targets_are_files_of_several_kinds() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        fs::write(folder.path().join(name), bytes).unwrap();
        path(folder.path(), name)
    };
    let text = file("up.txt", b"# #\n");
    let outcome = stochc_with("plan --quiet", &[&text]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    // `up` is a keyword, so the shape gets another name.
    assert!(
        outcome.out.contains("assembly build_shape_up"),
        "{}",
        outcome.out
    );
    let vox = vox(&[&[[3, 3, 3, 1]]]);
    let outcome = stochc_with("plan --quiet", &[&file("cell.vox", &vox)]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome.out.contains("P[0, 0].up -> B[0, 0, 1]"),
        "{}",
        outcome.out
    );
    let (status, message) = wrong("plan --quiet", &[&file("half.vox", &vox[..30])]);
    assert_eq!(
        (status, message.contains("cut off")),
        (2, true),
        "{message}"
    );
    let (status, message) = wrong("plan --quiet --shape a", &[&text]);
    assert_eq!(
        (status, message.contains("one shape")),
        (2, true),
        "{message}"
    );
    let (status, message) = wrong("plan --quiet", &[&path(folder.path(), "none.vox")]);
    assert_eq!(
        (status, message.contains("cannot read")),
        (2, true),
        "{message}"
    );
}

#[test]
fn shapes_plates_and_scenes_are_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let text = "shape one { layer 1 { # } }\nshape two { layer 1..2 { # } }\nscene deep from here { }\n\
                scene here from hemisphere { free 40 uniform }\n";
    let target = path(folder.path(), "shapes.sa");
    fs::write(Path::new(&target), text).unwrap();
    let (status, message) = wrong("plan --quiet", &[&target]);
    assert_eq!(
        (status, message.contains("`one`, `two`")),
        (1, true),
        "{message}"
    );
    let (status, message) = wrong("plan --quiet --shape three", &[&target]);
    assert_eq!(
        (status, message.contains("no shape `three`")),
        (1, true),
        "{message}"
    );
    let outcome = stochc_with("plan --quiet --shape two --scene deep", &[&target]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome.out.contains("scene here from hemisphere"),
        "{}",
        outcome.out
    );
    assert!(outcome.out.contains("seed plate 1 x 1"), "{}", outcome.out);
    let outcome = stochc_with(
        "plan --quiet --shape two --plate",
        &["3 x 3 at (0, 0)", &target],
    );
    assert!(outcome.out.contains("seed plate 3 x 3"), "{}", outcome.out);
    let (status, message) = wrong(
        "plan --quiet --shape two --plate",
        &["3 x 3 at (1, 0)", &target],
    );
    assert_eq!(
        (status, message.contains("attached to no block")),
        (1, true),
        "{message}"
    );
    let outcome = stochc_with(
        "plan --quiet --shape two --plate",
        &["3 x 3 at (2, 1)", "--offset", "2, 1", &target],
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    for part in [
        "P[2, 1] at (2, 1)",
        "shape two at (2, 1)",
        "P[2, 1].up ->> B[2, 1, 1..2]",
    ] {
        assert!(outcome.out.contains(part), "{part}: {}", outcome.out);
    }
    let outcome = stochc_with("plan --quiet --shape two --offset -1,0", &[&target]);
    assert_eq!(outcome.status, 1, "{}", outcome.err);
    let (status, message) = wrong("plan --quiet --shape two --scene nowhere", &[&target]);
    assert_eq!(
        (status, message.contains("no scene is called `nowhere`")),
        (2, true),
        "{message}"
    );
    for line in [
        "--tries 0",
        "--time soon",
        "--plate 3",
        "--offset 3",
        "--complete --offset 1,1",
        "--run 1 --offset 1,1",
        "--minimize most",
    ] {
        assert_eq!(
            stochc_with(&format!("plan {line}"), &[&target]).status,
            2,
            "{line}"
        );
    }
}

/// Checks a shape in the air, above the seed of another assembly's plate. It cannot be attached.
#[test]
fn impossible_shapes_are_reported_with_a_help() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = path(folder.path(), "drawn.txt");
    fs::write(&drawn, "# . .\n\n# . #\n").unwrap();
    let outcome = stochc_with("plan", &[&drawn]);
    assert_eq!(outcome.status, 1);
    let lines: Vec<&str> = outcome.err.lines().collect();
    assert!(
        lines.iter().any(|line| line.starts_with("error: ")),
        "{}",
        outcome.err
    );
    assert!(
        lines.iter().any(|line| line.starts_with("help: ")),
        "{}",
        outcome.err
    );
    assert!(!outcome.err.contains("U+000A"), "{}", outcome.err);
    assert!(!outcome.err.contains("plans tried"), "{}", outcome.err);
}

/// Checks that an output file that cannot be written is reported before planning.
#[test]
fn the_output_path_is_checked_first() {
    let folder = tempfile::tempdir().unwrap();
    let there = path(folder.path(), "there.sa");
    fs::write(&there, "mine").unwrap();
    for out in [there.as_str(), &path(folder.path(), "none/out.sa")] {
        for command in ["plan missing.sa --out", "calibrate missing.sa --out"] {
            let outcome = stochc_with(command, &[out]);
            assert_eq!(outcome.status, 2, "{}", outcome.err);
            assert!(
                outcome.err.contains(&format!("cannot write `{out}`"))
                    && !outcome.err.contains("stochc-partial"),
                "{}",
                outcome.err
            );
        }
    }
    assert_eq!(fs::read_to_string(&there).unwrap(), "mine");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// Checks that the message about a file that is not a program is about the file, not about
/// generated source.
#[test]
fn targets_that_cannot_be_planned_are_reported_with_a_help() {
    let folder = tempfile::tempdir().unwrap();
    let compiled = path(folder.path(), "line.json");
    let made = stochc_with(
        "compile examples/line.sa --emit executable --out",
        &[&compiled],
    );
    assert_eq!(made.status, 0, "{}", made.err);
    let text = fs::read_to_string(&compiled).unwrap();
    let pretty = path(folder.path(), "pretty.json");
    fs::write(&pretty, text.replacen("{\"kind\":", "{\n  \"kind\": ", 1)).unwrap();
    for file in [&compiled, &pretty] {
        for command in ["plan", "check", "compile"] {
            let outcome = stochc_with(command, &[file]);
            assert_eq!(outcome.status, 2, "{}", outcome.err);
            assert!(
                unfolded(&outcome.err).contains("it is already compiled"),
                "{}",
                outcome.err
            );
        }
        let ran = stochc_with("simulate --model shuffle --runs 1 --quiet", &[file]);
        assert_eq!(ran.status, 0, "{}", ran.err);
    }
    let folder = folder.path().to_str().unwrap();
    let outcome = stochc_with("plan", &[folder]);
    assert!(
        outcome.err.contains("`--run N` plans the rest"),
        "{}",
        outcome.err
    );
    let drawn = path(Path::new(folder), "drawn");
    fs::write(&drawn, "#\n").unwrap();
    let outcome = stochc_with("plan", &[&drawn]);
    assert_eq!(outcome.status, 1, "{}", outcome.err);
    assert!(
        outcome.err.contains("files of voxels end in `.txt`"),
        "{}",
        outcome.err
    );
    let outcome = stochc("plan examples/line.sa --shape none --scene nope");
    assert_eq!(outcome.status, 1, "{}", outcome.err);
    let outcome = stochc("plan examples/five_tower.sa --scene nope");
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    assert!(
        outcome
            .err
            .contains("no scene is called `nope`; `hemisphere`, "),
        "{}",
        outcome.err
    );
    let folder = tempfile::tempdir().unwrap();
    let voxels = path(folder.path(), "one.txt");
    fs::write(&voxels, "#\n").unwrap();
    let outcome = stochc_with("plan --complete", &[&voxels]);
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    assert!(
        outcome.err.contains("a file of voxels is one shape"),
        "{}",
        outcome.err
    );
}

/// Checks that the comments of a scene are copied with it.
#[test]
fn a_scene_is_copied_as_it_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "\
/// The tank in the cellar.
scene lab from hemisphere {   // measured in May
    free 200 uniform   // counted
    enclosure hemisphere { radius 5m  wall 250 N/m }
}
";
    let program = "shape s { layer 1 { # # } }
assembly a in lab { seed plate 2 x 1 { A at (0, 0) } phase rest { A.up -> B.east -> C yields s } }
";
    let file = path(folder.path(), "lab.sa");
    fs::write(&file, format!("{scene}{program}")).unwrap();
    let outcome = stochc_with("plan --quiet", &[&file]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(outcome.out.contains(scene), "{}", outcome.out);
}

/// Checks that a text with layers may begin with a byte order mark, as a program may.
#[test]
fn layers_may_begin_with_a_byte_order_mark() {
    let folder = tempfile::tempdir().unwrap();
    let layers = path(folder.path(), "one.txt");
    fs::write(&layers, "\u{feff}#\n").unwrap();
    let outcome = stochc_with("plan --quiet", &[&layers]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome
            .out
            .contains("/// 1 capture, up to 1 face open at the same time"),
        "{}",
        outcome.out
    );
}

#[test]
fn a_program_is_completed() {
    let folder = tempfile::tempdir().unwrap();
    let part = path(folder.path(), "part.sa");
    let text = "shape stairs { layer 1 { # # } layer 2 { # } }\n\
                assembly build {\n\
                    seed plate 2 x 1 { M at (0, 0) }\n\
                    phase begun { M.up -> T }\n\
                    phase rest { yields stairs }\n\
                }\n";
    fs::write(&part, text).unwrap();
    assert_eq!(stochc_with("check", &[&part]).status, 1);
    let unbuilt = stochc_with("plan", &[&part]);
    assert!(
        unbuilt.err.contains("`--complete` plans"),
        "{}",
        unbuilt.err
    );
    let whole = path(folder.path(), "whole.sa");
    let outcome = stochc_with("plan --complete --quiet", &[&part, "--out", &whole]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(stochc_with("check --deny warnings", &[&whole]).status, 0);
    // The program cannot be written to a folder that lacks its imports.
    let imported = "let length = 2\n";
    fs::write(path(folder.path(), "lengths.sa"), imported).unwrap();
    let importing = path(folder.path(), "importing.sa");
    let more = text.replace("M.up -> T", "M.up ->> T[1..length]");
    let more = more.replace("layer 2 { # }", "layer 2 { # # }");
    fs::write(&importing, format!("import \"lengths.sa\"\n{more}")).unwrap();
    let beside = path(folder.path(), "beside.sa");
    let outcome = stochc_with("plan --complete --quiet", &[&importing, "--out", &beside]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    fs::create_dir(folder.path().join("elsewhere")).unwrap();
    let elsewhere = path(folder.path(), "elsewhere/whole.sa");
    let outcome = stochc_with(
        "plan --complete --quiet",
        &[&importing, "--out", &elsewhere],
    );
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    assert!(
        outcome.err.contains("into the folder of the program"),
        "{}",
        outcome.err
    );
    assert!(!Path::new(&elsewhere).exists());
    let again = stochc_with("plan --complete", &[&whole]);
    assert_eq!(again.status, 1);
    assert!(
        again
            .err
            .contains("every phase that claims a shape builds it"),
        "{}",
        again.err
    );
    fs::write(&part, text.replace("M.up", "N.up")).unwrap();
    let wrong = stochc_with("plan --complete", &[&part]);
    assert_eq!(wrong.status, 1);
    assert!(wrong.err.contains("unknown-name"), "{}", wrong.err);
}

#[test]
fn a_censored_run_is_completed() {
    let folder = tempfile::tempdir().unwrap();
    let results = path(folder.path(), "results");
    let simulate =
        "simulate examples/five_tower.sa --model rate --runs 2 --max-ticks 2000 --quiet --out";
    assert_eq!(stochc_with(simulate, &[&results]).status, 3);
    let rest = path(folder.path(), "rest.sa");
    let outcome = stochc_with("plan --run 1 --tries 10 --quiet --out", &[&rest, &results]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let checked = stochc_with("check --deny warnings", &[&rest]);
    assert_eq!(checked.status, 0, "{}", checked.err);
    assert!(
        checked.out.contains("pre-attached block"),
        "{}",
        checked.out
    );
    let done = stochc_with("simulate --model rate --runs 1 --quiet", &[&rest]);
    assert_eq!(done.status, 0, "{}", done.err);

    let unknown = stochc_with("plan --run 1 --dead Unknown", &[&results]);
    assert_eq!(unknown.status, 2);
    assert!(
        unknown.err.contains("no block is called `Unknown`"),
        "{}",
        unknown.err
    );
    assert_eq!(stochc_with("plan --run 2", &[&results]).status, 2);
    let nowhere = stochc_with("plan --run 1 --scene nowhere", &[&results]);
    assert_eq!(nowhere.status, 2, "{}", nowhere.err);
    assert!(nowhere.err.contains("no scene is called `nowhere`"));
    // These options belong to other targets.
    assert_eq!(stochc_with("plan --dead E", &[&results]).status, 2);
    assert_eq!(
        stochc_with("plan --run 1 --complete", &[&results]).status,
        2
    );
    assert_eq!(
        stochc_with("plan --run 1 --program unknown", &[&results]).status,
        2
    );
}

#[test]
fn uncalibrated_estimates_are_marked() {
    let planned = |scene: &str| {
        let line =
            format!("plan examples/five_tower.sa --tries 10 --quiet --explain --scene {scene}");
        let outcome = stochc_with(&line, &[]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        (outcome.out + &outcome.err)
            .matches("this scene has not been calibrated")
            .count()
    };
    assert_eq!(planned("hemisphere"), 0);
    // The note appears in the program and in the explanation.
    assert_eq!(planned("hemisphere_soft"), 2);
}

/// Checks scenes with warnings, and scenes whose faces always attract. The result is a program or
/// an error.
#[test]
fn a_warning_does_not_prevent_a_plan() {
    let folder = tempfile::tempdir().unwrap();
    let cube = "layer 1..2 { # #\n # # }";
    for (name, scene, shape) in [
        (
            "reject",
            "scene own from magnet_tank { free 20 uniform  enclosure hemisphere { radius 1 m  wall 200 N/m } }",
            cube,
        ),
        (
            "dense",
            "scene own from hemisphere { free 30000 uniform }",
            "layer 1..2 { # }",
        ),
    ] {
        let file = path(folder.path(), &format!("{name}.sa"));
        let out = path(folder.path(), &format!("{name}_planned.sa"));
        fs::write(&file, format!("{scene}\nshape goal {{ {shape} }}\n")).unwrap();
        let outcome = stochc_with(
            "plan --scene own --tries 5 --quiet",
            &[&file, "--out", &out],
        );
        assert_eq!(outcome.status, 0, "{name}: {}", outcome.err);
        let checked = stochc_with("check --deny warnings", &[&out]);
        assert_eq!(checked.status, 0, "{name}: {}", checked.err);
    }
}

/// Checks the completion of a program that has other claims, which are not true yet, and all kinds
/// of comments.
#[test]
fn a_completed_program_retains_claims_and_comments() {
    let folder = tempfile::tempdir().unwrap();
    let (part, whole) = (
        path(folder.path(), "part.sa"),
        path(folder.path(), "whole.sa"),
    );
    let text = "\
shape low { layer 1 { # # } }
shape high { layer 1..2 { # # } }
assembly x {
    seed plate 2 x 1 { M at (0, 0)   N at (1, 0) }
    phase a {
        M.up -> A
        /// The low shape.
        // not /// that
        yields low
    } /// The high shape.
    phase b { yields high }
}
";
    fs::write(&part, text).unwrap();
    let outcome = stochc_with(
        "plan --complete --quiet --tries 5",
        &[&part, "--out", &whole],
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let written = fs::read_to_string(&whole).unwrap();
    for retained in [
        "// not /// that",
        "/// The low shape.",
        "/// The high shape.\n    phase b {",
    ] {
        assert!(written.contains(retained), "{retained}: {written}");
    }
    let all = path(folder.path(), "all.sa");
    let outcome = stochc_with(
        "plan --complete --quiet --tries 5",
        &[&whole, "--out", &all],
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let checked = stochc_with("check", &[&all]);
    assert_eq!(checked.status, 0, "{}", checked.err);
}

/// Checks a forged record with a valid checksum. It is ignored if no run of the program could have
/// this record.
#[test]
fn a_forged_record_is_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let results = path(folder.path(), "results");
    let program = path(folder.path(), "chain.sa");
    let text =
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phase grow { M.up -> A.up -> B.up -> C } }";
    fs::write(&program, text).unwrap();
    let options = "simulate --model shuffle --runs 1 --max-ticks 2 --quiet";
    let outcome = stochc_with(options, &[&program, "--out", &results]);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let journal = Path::new(&results).join("journal.jsonl");
    let honest = fs::read_to_string(&journal).unwrap();
    fs::remove_file(Path::new(&results).join("checksums.json")).unwrap();
    for (index, key, value) in [
        (1, "cell", serde_json::json!([0, 0, 0])),
        (1, "cell", serde_json::json!([7, 7, 7])),
        (0, "parent", 2.into()),
        (1, "parent", 2.into()),
        (1, "child", 1.into()),
        (1, "face", "east".into()),
        (1, "magnetized", 0.into()),
        (1, "body", 100_000.into()),
    ] {
        let (header, line) = honest.trim_end().split_once('\n').unwrap();
        let mut line: serde_json::Value = serde_json::from_str(line).unwrap();
        line.as_object_mut().unwrap().remove("crc");
        assert!(line["record"]["bonds"][index][key] != value);
        line["record"]["bonds"][index][key] = value.clone();
        let forged = stochc::files::checksum::sealed(line.to_string());
        fs::write(&journal, format!("{header}\n{forged}\n")).unwrap();
        for command in ["plan --run 0 --tries 5", "show", "replay --run 0"] {
            let outcome = stochc_with(command, &[&results]);
            let reason = "is not possible";
            assert!(
                outcome.err.contains(reason),
                "{command}, {key} {value}: {}",
                outcome.err
            );
        }
    }
    fs::write(&journal, &honest).unwrap();
    let outcome = stochc_with("plan --run 0 --tries 5", &[&results]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
}

/// Checks that a race selects the fastest plan without a stopped run. The resulting program has no
/// warnings.
#[test]
fn a_race_with_physics_chooses_the_fastest_plan() {
    let folder = tempfile::tempdir().unwrap();
    let (target, out) = ("pair.txt", "pair.sa");
    let [target, out] = [target, out].map(|name| path(folder.path(), name));
    fs::write(&target, "#.#\n\n###\n").unwrap();
    let race = ["--race", "8", "--tries", "5", "--json", "--quiet"];
    let document = stochc_with(&format!("plan {target} --out {out}"), &race).json();
    let plan = &document["plan"];
    let entrants = plan["race"].as_array().unwrap();
    assert!(entrants.len() > 2, "{entrants:?}");
    assert!(entrants.iter().all(|it| it["runs"] == 8));
    let mean = |it: &&serde_json::Value| it["mean"].as_f64().unwrap();
    let fastest = entrants.iter().filter(|it| it["stopped"] == 0);
    let fastest = fastest.min_by(|a, b| mean(a).total_cmp(&mean(b))).unwrap();
    assert_eq!(plan["baseline"], fastest["baseline"]);
    assert_eq!(stochc_with("check --deny warnings", &[&out]).status, 0);
    let refused = stochc_with(&format!("plan {target} --run 0"), &race);
    assert_eq!(refused.status, 2);
}
