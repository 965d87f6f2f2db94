//! Tests that a manifest is enough to repeat its ensemble, and that an interrupted ensemble is
//! resumed.
use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::stochc::{path, stochc_with, tables};

const TOWER: &str = "simulate --model shuffle --quiet tests/fixtures/tower.sa";

#[test]
fn a_manifest_reruns_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let [first, again] = ["first", "again"].map(|name| path(folder.path(), name));
    let program = path(folder.path(), "program.sa");
    let imported = path(folder.path(), "importing_tower.sa");
    fs::copy("tests/fixtures/importing.sa", &program).unwrap();
    fs::copy("tests/fixtures/importing_tower.sa", &imported).unwrap();
    let outcome = stochc_with(
        TOWER,
        &[&program, "--runs", "6", "--seed", "9", "--out", &first],
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    // The manifest contains everything, so no other file is needed.
    fs::remove_file(&program).unwrap();
    fs::remove_file(&imported).unwrap();
    let manifest = path(first.as_ref(), "manifest.json");
    let rerun = stochc_with("repeat --quiet", &[&manifest, "--out", &again]);
    assert_eq!((rerun.status, rerun.err.as_str()), (0, ""));
    let said_at_first = outcome.out;
    assert_eq!(rerun.out, said_at_first);
    assert!(tables(&first) == tables(&again));
    let manifests =
        [&first, &again].map(|of| fs::read(path(of.as_ref(), "manifest.json")).unwrap());
    assert!(manifests[0] == manifests[1]);
    // `show` prints a single run of the folder.
    let outcome = stochc_with("show --run 3", &[&again]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(outcome.out.contains("importing, run 3"), "{}", outcome.out);
    // The results folder can be given in place of its manifest.
    let rerun = stochc_with("repeat --quiet", &[&first]);
    assert_eq!((rerun.status, rerun.out), (0, said_at_first));
}

#[test]
fn an_invalid_manifest_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "manifest.json");
    for (text, reason) in [
        ("", "not the manifest"),
        ("{}", "not the manifest"),
        (r#"{"format": 999}"#, "format is 999"),
        (r#"{"format": 1}"#, "damaged"),
    ] {
        fs::write(&file, text).unwrap();
        let outcome = stochc_with("repeat", &[&file]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{text}");
        assert!(outcome.err.contains(reason), "{}", outcome.err);
    }
    let outcome = stochc_with("repeat --seed 2", &[&file]);
    assert_eq!(outcome.status, 2, "the manifest contains the seed");
}

/// Checks manifests that request too many runs, or none.
#[test]
fn a_manifest_beyond_all_limits_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    stochc_with(TOWER, &["--runs", "1", "--out", &out]);
    let file = path(out.as_ref(), "manifest.json");
    let valid: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let of = |key: &str, value: Value| {
        let mut manifest = valid.clone();
        manifest[key] = value;
        manifest
    };
    fs::write(&file, of("seed", json!(2)).to_string()).unwrap();
    let outcome = stochc_with("repeat", &[&file]);
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    assert!(
        outcome.err.contains("its checksum differs"),
        "{}",
        outcome.err
    );
    // Outside of a results folder, a file `manifest.json` belongs to the user.
    let file = path(folder.path(), "manifest.json");
    let program = &valid["programs"][0];
    for (manifest, reason) in [
        (of("runs", json!(10_000_001)), "at most 10000000"),
        (of("runs", json!(0)), "no runs"),
        (of("programs", json!([])), "no programs"),
        (of("programs", json!(vec![program; 1_001])), "at most 1000"),
    ] {
        fs::write(&file, manifest.to_string()).unwrap();
        let outcome = stochc_with("repeat", &[&file]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{reason}");
        assert!(outcome.err.contains(reason), "{}", outcome.err);
    }
}

#[test]
fn more_runs_are_added() {
    let folder = tempfile::tempdir().unwrap();
    let [grown, fresh] = ["grown", "fresh"].map(|name| path(folder.path(), name));
    stochc_with(TOWER, &["--runs", "3", "--out", &grown]);
    let refused = stochc_with(TOWER, &["--runs", "8", "--out", &grown]);
    assert_eq!(refused.status, 2);
    assert!(refused.err.contains("3 of the 8 runs"), "{}", refused.err);
    assert!(refused.err.contains("stochc resume "), "{}", refused.err);
    let outcome = stochc_with("resume --quiet --runs 8", &[&grown]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    stochc_with(TOWER, &["--runs", "8", "--out", &fresh]);
    assert!(tables(&grown) == tables(&fresh));
}

#[test]
fn a_killed_ensemble_resumes() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, torn] = ["whole", "torn"].map(|name| path(folder.path(), name));
    stochc_with(TOWER, &["--runs", "8", "--out", &whole]);
    fs::create_dir(&torn).unwrap();
    let file = |of: &String, name: &str| path(of.as_ref(), name);
    fs::copy(file(&whole, "manifest.json"), file(&torn, "manifest.json")).unwrap();
    let journal = fs::read(file(&whole, "journal.jsonl")).unwrap();
    fs::write(
        file(&torn, "journal.jsonl"),
        &journal[..journal.len() * 2 / 3],
    )
    .unwrap();

    let outcome = stochc_with("show", &[&torn]);
    assert_eq!(outcome.status, 3);
    assert!(
        outcome.err.ends_with("of 8 runs are still to do\n"),
        "{}",
        outcome.err
    );
    let outcome = stochc_with(TOWER, &["--runs", "8", "--out", &torn]);
    assert_eq!(outcome.status, 2);
    let outcome = stochc_with("resume --quiet", &[&torn]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(tables(&whole) == tables(&torn));
}

/// Returns the path of a results folder with three runs. Its manifest lists these builds.
fn made_by(folder: &Path, builds: &[&str]) -> String {
    let out = path(folder, "out");
    let outcome = stochc_with(
        "simulate --quiet tests/fixtures/dense.sa --runs 3",
        &["--out", &out],
    );
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    set_builds(&path(out.as_ref(), "manifest.json"), builds);
    out
}

/// Replaces the list of builds in a manifest. Removes the checksums of its folder.
pub(crate) fn set_builds(file: &str, builds: &[&str]) {
    let text = fs::read_to_string(file).unwrap();
    let mut manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(manifest["builds"].as_array().unwrap().len(), 1);
    manifest["builds"] = builds.into();
    fs::write(file, manifest.to_string()).unwrap();
    let checksums = Path::new(file).with_file_name("checksums.json");
    fs::remove_file(checksums).unwrap();
}

#[test]
fn runs_of_another_build_are_reported_once() {
    let (build, warning) = (
        "0123456789abcdef",
        "another build of `stochc` (0123456789abcdef",
    );
    let folder = tempfile::tempdir().unwrap();
    let out = made_by(folder.path(), &[build]);
    let file = path(out.as_ref(), "manifest.json");
    let once = |err: &str| assert_eq!(err.matches(warning).count(), 1, "{err}");
    // `show` makes no runs, so it prints no warning.
    assert!(!stochc_with("show", &[&out]).err.contains(warning));
    let again = stochc_with("repeat --quiet", &[&file]);
    assert_eq!(again.status, 0, "it is a warning");
    once(&again.err);
    once(&stochc_with("export --run 1 --format parquet", &[&out]).err);
    once(&stochc_with("replay --run 1", &[&out]).err);
    let line = "resume --quiet --runs 5";
    let before = fs::read(&file).unwrap();
    let refused = stochc_with(line, &[&out]);
    assert_eq!(refused.status, 2, "{}", refused.err);
    once(&refused.err);
    assert!(refused.err.contains("`--mixed-builds`"), "{}", refused.err);
    assert!(fs::read(&file).unwrap() == before);
    let resumed = stochc_with(line, &[&out, "--mixed-builds"]);
    assert_eq!(resumed.status, 0, "{}", resumed.err);
    once(&resumed.err);
    // Afterwards, both builds have made runs.
    let manifest: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    let builds = manifest["builds"].as_array().unwrap();
    assert_eq!((builds.len(), &builds[0]), (2, &build.into()));
}

/// Checks that runs with different physics are never mixed: before resuming, one existing run is
/// repeated.
#[test]
fn a_run_with_a_different_result_stops_resuming() {
    let folder = tempfile::tempdir().unwrap();
    let this = stochc::results::this_build();
    for (build, more) in [(&this[..], &[][..]), ("other", &["--mixed-builds"])] {
        let out = made_by(folder.path(), &[build]);
        let journal = path(out.as_ref(), "journal.jsonl");
        let text = fs::read_to_string(&journal).unwrap();
        // Another build would have sent the messages of these runs along other paths.
        let lines = text.lines().map(|line| {
            let (object, _) = line.rsplit_once(",\"crc\"").unwrap();
            let object = object.replace("\"hops\":", "\"hops\":1") + "}";
            stochc::files::checksum::sealed(object) + "\n"
        });
        let text: String = lines.collect();
        fs::write(&journal, &text).unwrap();
        let before = fs::read(path(out.as_ref(), "manifest.json")).unwrap();
        let line = "resume --quiet --runs 5";
        let outcome = stochc_with(line, &[&[&out[..]], more].concat());
        assert_eq!(
            (outcome.status, outcome.out.as_str()),
            (2, ""),
            "{}",
            outcome.err
        );
        assert!(
            outcome.err.contains("does not come out as it is"),
            "{}",
            outcome.err
        );
        assert_eq!(fs::read_to_string(&journal).unwrap(), text);
        assert!(fs::read(path(out.as_ref(), "manifest.json")).unwrap() == before);
        fs::remove_dir_all(&out).unwrap();
    }
}

/// Checks that a wrong folder name is reported before runs are made.
#[test]
fn a_folder_without_runs_to_resume_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let expected = format!("there is nothing to resume in `{out}`; `stochc simulate`");
    let outcome = stochc_with("resume", &[&out]);
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains(&expected), "{}", outcome.err);
    assert!(!fs::exists(&out).unwrap());
}

/// Checks that resuming recognizes a program, whatever its path.
#[test]
fn a_folder_resumes_with_any_path_of_its_program() {
    let folder = tempfile::tempdir().unwrap();
    let [out, at_once] = ["out", "at_once"].map(|name| path(folder.path(), name));
    let here = std::env::current_dir().unwrap();
    let absolute = path(&here, "tests/fixtures/tower.sa");
    let copied = path(folder.path(), "copied.sa");
    fs::copy(&absolute, &copied).unwrap();
    let simulate = |program: &str, runs: &str, out: &str| {
        let line = "simulate --model shuffle --quiet";
        let outcome = stochc_with(line, &[program, "--runs", runs, "--out", out]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        let outcome = stochc_with("fsck", &[out]);
        assert_eq!(outcome.status, 0, "{program}: {}", outcome.out);
        assert_eq!(stochc_with("show", &[out]).status, 0, "{program}");
    };
    simulate("tests/fixtures/tower.sa", "3", &out);
    let first = fs::read(path(out.as_ref(), "manifest.json")).unwrap();
    for program in ["./tests/fixtures/tower.sa", &absolute, &copied] {
        simulate(program, "3", &out);
        assert!(fs::read(path(out.as_ref(), "manifest.json")).unwrap() == first);
    }
    let outcome = stochc_with("resume --quiet --runs 5", &[&out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    simulate("tests/fixtures/tower.sa", "5", &at_once);
    assert!(tables(&out) == tables(&at_once));
}

#[test]
fn a_folder_resumes_without_its_program() {
    let folder = tempfile::tempdir().unwrap();
    let [out, at_once, other] = ["out", "at_once", "other"].map(|name| path(folder.path(), name));
    let sweep = ["--vary", "free=50,60", "--seed", "7"];
    let line = TOWER.replace("simulate", "sweep");
    let outcome = stochc_with(
        &line,
        &[&["--runs", "2", "--out", &out], &sweep[..]].concat(),
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let outcome = stochc_with(
        &line,
        &[&["--runs", "6", "--out", &at_once], &sweep[..]].concat(),
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let outcome = stochc_with("resume --quiet --runs 6", &[&out]);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    assert!(tables(&out) == tables(&at_once));
    // The number of runs is never reduced.
    assert_eq!(stochc_with("resume --quiet", &[&out]).status, 0);
    assert!(tables(&out) == tables(&at_once));
    assert_eq!(stochc_with("resume --quiet --runs 3", &[&out]).status, 2);
    // The folder determines all other settings, so these options are rejected.
    for option in ["--seed 3", "--model rate", "--max-ticks 9", "--vary free=9"] {
        let line = format!("resume {option}");
        let outcome = stochc_with(&line, &[&out]);
        assert_eq!(outcome.status, 2, "{option}: {}", outcome.err);
    }
    let outcome = stochc_with("resume", &[&other]);
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("nothing to resume"), "{}", outcome.err);
    // Repeating an ensemble may use another number of runs.
    let manifest = path(at_once.as_ref(), "manifest.json");
    let line = "repeat --quiet --runs 2";
    let outcome = stochc_with(line, &[&manifest, "--out", &other]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let rows = stochc_with("show --json", &[&other]).json();
    assert_eq!(rows["programs"][0]["runs"], 2, "{rows}");
}
