//! Tests that a folder with other content is not changed, and that the message contains advice.
use std::fs;
use std::path::Path;

use insta::assert_snapshot;
use stochc_results::integrity::verify;
use stochc_results::{Folder, Manifest};
use stochc_runtime::Settings;

use crate::world::{complete, manifest, program, put};

/// Returns the error message for `path`, with the path replaced. Checks that the folder is
/// unchanged.
fn error(path: &Path, manifest: &Manifest, resume: bool) -> String {
    let before = content(path);
    let error = Folder::open(path, manifest, resume).unwrap_err();
    assert_eq!(content(path), before, "{error}");
    error
        .to_string()
        .replace(&path.display().to_string(), "DIR")
}

fn content(path: &Path) -> Vec<(String, Vec<u8>)> {
    let Ok(entries) = fs::read_dir(path) else {
        return vec![(String::new(), fs::read(path).unwrap())];
    };
    let mut files: Vec<_> = entries
        .map(|entry| entry.unwrap())
        .map(|e| {
            (
                e.file_name().into_string().unwrap(),
                fs::read(e.path()).unwrap(),
            )
        })
        .collect();
    files.sort();
    files
}

#[test]
fn other_files_are_not_touched() {
    let folder = tempfile::tempdir().unwrap();
    put(&folder.path().join("thesis.tex"), "precious");
    assert_snapshot!(error(folder.path(), &manifest(2), true), @"`DIR` contains other files; choose an empty or a new folder");
    assert_snapshot!(error(&folder.path().join("thesis.tex"), &manifest(2), true), @"`DIR` is a file; choose another name for the folder");
}

#[test]
fn runs_without_a_manifest_are_not_touched() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(2), 1);
    fs::remove_file(folder.path().join("manifest.json")).unwrap();
    let before = content(folder.path());
    assert_snapshot!(error(folder.path(), &manifest(2), true), @"`DIR` contains runs, but no `manifest.json`, which is needed to read them; restore it, or choose another folder");
    let message = Folder::read(folder.path()).unwrap_err().to_string();
    assert!(message.contains("no `manifest.json`"), "{message}");
    let message = verify(folder.path()).unwrap_err().to_string();
    assert!(message.contains("no `manifest.json`"), "{message}");
    assert_eq!(content(folder.path()), before);
}

#[test]
fn a_foreign_manifest_is_not_touched() {
    let folder = tempfile::tempdir().unwrap();
    put(&folder.path().join("manifest.json"), "{\"icons\": []}");
    assert_snapshot!(error(folder.path(), &manifest(2), true), @"cannot read `manifest.json` in `DIR`: it is not the manifest of an ensemble; choose another folder, or read this one with the version that made it");
    put(&folder.path().join("manifest.json"), "{\"format\": 99}");
    assert_snapshot!(error(folder.path(), &manifest(2), true), @"cannot read `manifest.json` in `DIR`: its format is 99, and this is 1; choose another folder, or read this one with the version that made it");
}

#[test]
fn another_ensemble_is_rejected_with_the_difference() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(2), 1);
    let refused = |manifest: &Manifest| error(folder.path(), manifest, true);

    let mut other = manifest(2);
    other.seed = 4;
    other.settings.substeps = 16;
    other.settings.max_ticks = Some(100);
    other.settings.solver_iterations = Some(3);
    assert_snapshot!(refused(&other), @"`DIR` contains another ensemble: the seed is `18446744073709551615` there and `4` here, the number of substeps is `2/8` there and `2/16` here, the limit of ticks is `none` there and `100` here, `solver-iterations` is `10` there and `3` here; choose another folder, because results are never overwritten");

    let mut other = manifest(2);
    other.programs[0].sources[0].text.push(' ');
    other.programs[1].scene.tick *= 1.0 + f64::EPSILON;
    assert_snapshot!(refused(&other), @"`DIR` contains another ensemble: the text of `left` has changed, the scene of `right` has changed; choose another folder, because results are never overwritten");

    let mut other = manifest(2);
    other.programs.push(program("left"));
    assert_snapshot!(refused(&Manifest::new(Settings::default(), u64::MAX, 2, other.programs)), @"`DIR` contains another ensemble: the list of programs is `left, right` there and `left, right, left (2)` here; choose another folder, because results are never overwritten");
}

#[test]
fn the_identity_excludes_paths_and_the_number_of_runs() {
    let (mut here, there) = (manifest(2), manifest(3));
    here.programs[0].sources[0].path = "elsewhere.sa".into();
    assert_eq!(here.identity(), there.identity());
}

#[test]
fn resuming_must_be_requested() {
    let folder = tempfile::tempdir().unwrap();
    complete(folder.path(), &manifest(3), 1);
    assert_snapshot!(error(folder.path(), &manifest(5), false), @"`DIR` contains 6 of the 10 runs of this ensemble; resume it with `stochc resume DIR`");
    assert_snapshot!(error(folder.path(), &manifest(2), true), @"`DIR` is an ensemble of 3 runs of each program, more than the 2 asked for; ask for 3, or choose another folder");
}

#[test]
fn one_process_writes_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let held = Folder::open(folder.path(), &manifest(2), false).unwrap();
    assert_snapshot!(error(folder.path(), &manifest(2), true), @"another process is writing to `DIR`; wait for its end, or choose another folder");
    drop(held);
    Folder::open(folder.path(), &manifest(2), true).unwrap();
}

#[test]
fn a_journal_of_another_ensemble_is_rejected() {
    let [folder, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    complete(folder.path(), &manifest(2), 1);
    let mut changed = manifest(2);
    changed.seed = 4;
    complete(other.path(), &changed, 1);
    let journal = |of: &tempfile::TempDir| of.path().join("journal.jsonl");
    fs::copy(journal(&other), journal(&folder)).unwrap();
    assert_snapshot!(error(folder.path(), &manifest(2), true), @"`journal.jsonl` does not belong to the `manifest.json` in its folder; move both back to their folders, or choose another folder; if one is damaged, `stochc fsck --repair` may help");
}

#[test]
fn leftovers_of_a_crash_are_accepted() {
    let folder = tempfile::tempdir().unwrap();
    put(&folder.path().join(".lock"), "");
    put(&folder.path().join(".stochc-partial-x"), "{");
    complete(folder.path(), &manifest(2), 1);
    complete(folder.path(), &manifest(2), 1);
    let names: Vec<_> = content(folder.path())
        .into_iter()
        .map(|file| file.0)
        .collect();
    assert_eq!(
        names,
        [
            ".lock",
            "bonds.parquet",
            "checksums.json",
            "journal.jsonl",
            "manifest.json",
            "phases.parquet",
            "releases.parquet",
            "runs.parquet",
            "unplanned.parquet"
        ]
    );
}

#[test]
fn a_manifest_survives_its_file() {
    let manifest = manifest(2);
    let read = Manifest::from_json(&manifest.to_json()).unwrap();
    assert_eq!(read, manifest);
    assert_eq!(read.to_json(), manifest.to_json());
}
