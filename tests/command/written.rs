//! Tests output files. Only new files and files of stochc are replaced, and a formatted file keeps
//! its attributes.
use std::fs::{self, File};
use std::os::unix::fs::{FileTypeExt as _, MetadataExt as _, PermissionsExt as _, symlink};
use std::path::Path;
use std::process::Command;

use crate::stochc::{path, stochc_with};

const TOWER: &str = "tests/fixtures/tower.sa";

/// Returns the command lines that write a file. Each has the words before and after the file name.
/// It also states whether the command may replace its own file.
fn writers(results: &str) -> Vec<(String, Vec<&str>, bool)> {
    let compile = |what: &str| format!("compile {TOWER} --emit {what} --out");
    let mut writers = vec![
        (compile("executable"), vec![], true),
        (compile("table"), vec![], false),
        (compile("graph --format json"), vec![], false),
        (compile("structure --format svg"), vec![], false),
        ("report --out".to_owned(), vec![results], true),
    ];
    for line in ["replay", "export --format parquet", "export --format gltf"] {
        writers.push((format!("{line} --run 0 --out"), vec![results], true));
    }
    writers
}

#[test]
fn only_files_of_stochc_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let here = |name: &str| path(folder.path(), name);
    let results = here("results");
    let simulate = "simulate --quiet tests/fixtures/dense.sa --runs 1 --substeps 1 --out";
    assert_eq!(stochc_with(simulate, &[&results]).status, 0);
    let text = "mine <!DOCTYPE html> glTF PAR1 {\"kind\":\"stochc\"} .TH";
    for (line, after, twice) in writers(&results) {
        let write = |name: &str| stochc_with(&line, &[&[name], &after[..]].concat());
        let [document, link, dangling, device, pipe] =
            ["document", "link", "dangling", "device", "pipe"].map(here);
        fs::write(&document, text).unwrap();
        symlink("document", &link).unwrap();
        symlink("nothing", &dangling).unwrap();
        symlink("/dev/null", &device).unwrap();
        assert!(
            Command::new("mkfifo")
                .arg(&pipe)
                .status()
                .unwrap()
                .success()
        );
        for name in [&document, &link, &dangling, &device, &pipe] {
            let before = fs::symlink_metadata(name).unwrap();
            let outcome = write(name);
            assert_eq!(
                (outcome.status, outcome.out.as_str()),
                (2, ""),
                "{line} {name}"
            );
            assert!(
                outcome.err.contains(name.as_str()),
                "{line}: {}",
                outcome.err
            );
            let after = fs::symlink_metadata(name).unwrap();
            assert_eq!(after.ino(), before.ino(), "{line} {name}");
        }
        assert_eq!(fs::read_to_string(&document).unwrap(), text, "{line}");
        assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
        assert!(!Path::new(&here("nothing")).exists(), "{line}");
        // The command writes a new file, and replaces a file of its own.
        let new = here("new");
        let outcome = write(&new);
        assert_eq!(outcome.status, 0, "{line}: {}", outcome.err);
        let written = fs::read(&new).unwrap();
        let again = write(&new);
        assert_eq!(
            again.status,
            if twice { 0 } else { 2 },
            "{line}: {}",
            again.err
        );
        assert!(fs::read(&new).unwrap() == written, "{line}");
        for name in [document, link, dangling, device, pipe, new] {
            fs::remove_file(name).unwrap();
        }
        let _ = fs::remove_dir_all(here("new-figures"));
    }
    let pages = here("man1");
    fs::create_dir(&pages).unwrap();
    fs::write(path(pages.as_ref(), "stochc-fmt.1"), ".TH mine").unwrap();
    let outcome = stochc_with("man --out", &[&pages]);
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("stochc-fmt.1"), "{}", outcome.err);
    fs::remove_file(path(pages.as_ref(), "stochc-fmt.1")).unwrap();
    for _ in 0..2 {
        assert_eq!(stochc_with("man --out", &[&pages]).status, 0);
    }
}

#[test]
fn an_ensemble_follows_no_link() {
    let folder = tempfile::tempdir().unwrap();
    let document = path(folder.path(), "document");
    let simulate = "simulate --quiet tests/fixtures/dense.sa --substeps 1 --record all --out";
    for name in [
        "journal.jsonl",
        "manifest.json",
        "runs.parquet",
        ".lock",
        "recordings/2-0.rec",
    ] {
        let out = path(folder.path(), "out");
        assert_eq!(stochc_with(simulate, &[&out, "--runs", "1"]).status, 0);
        let place = Path::new(&out).join(name);
        let place = place.to_str().unwrap().replace("2-0", "0-1");
        let content = fs::read(&place).unwrap_or_default();
        let _ = fs::remove_file(&place);
        fs::write(&document, &content).unwrap();
        symlink(&document, &place).unwrap();
        let outcome = stochc_with("resume --quiet --runs 2 --record all", &[&out]);
        assert_eq!(outcome.status, 2, "{name}: {}", outcome.err);
        assert!(
            outcome.err.contains("symbolic link"),
            "{name}: {}",
            outcome.err
        );
        assert!(fs::read(&document).unwrap() == content, "{name}");
        assert!(fs::symlink_metadata(&place).unwrap().is_symlink(), "{name}");
        fs::remove_dir_all(&out).unwrap();
    }
    // This also holds for a folder that is a link to another place.
    let (out, elsewhere) = (path(folder.path(), "out"), path(folder.path(), "elsewhere"));
    fs::create_dir(&elsewhere).unwrap();
    assert_eq!(stochc_with(simulate, &[&out, "--runs", "1"]).status, 0);
    fs::remove_dir_all(path(out.as_ref(), "recordings")).unwrap();
    symlink(&elsewhere, path(out.as_ref(), "recordings")).unwrap();
    let outcome = stochc_with("resume --quiet --runs 2 --record all", &[&out]);
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    assert_eq!(fs::read_dir(&elsewhere).unwrap().count(), 0);
}

#[test]
fn leftovers_of_a_kill_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let left = folder.path().join(".stochc-partial-left");
    let busy = folder.path().join(".stochc-partial-busy");
    fs::write(&left, "half of it").unwrap();
    let file = File::create(&busy).unwrap();
    file.lock().unwrap();
    let out = path(folder.path(), "X");
    assert_eq!(stochc_with("compile --out", &[&out, TOWER]).status, 0);
    assert!(!left.exists());
    assert!(busy.exists());
}

#[test]
fn a_rewritten_file_retains_links_owner_and_mode() {
    let careless = "assembly a{seed plate 1 x 1{M at(0,0)}phaze p{M.up->A}}";
    let laid_out = careless.replace("phaze", "phase");
    for (line, text) in [("fmt", &laid_out[..]), ("check --fix", careless)] {
        let folder = tempfile::tempdir().unwrap();
        let [file, twin, owned] = ["a.sa", "twin", "owned.sa"].map(|it| path(folder.path(), it));
        fs::write(&file, text).unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        fs::hard_link(&file, &twin).unwrap();
        let outcome = stochc_with(line, &[&file]);
        assert_eq!(outcome.status, 0, "{line}: {}", outcome.err);
        let new = fs::read_to_string(&file).unwrap();
        assert_ne!(new, text, "{line}");
        assert_eq!(fs::read_to_string(&twin).unwrap(), new, "{line}");
        let (one, other) = (fs::metadata(&file).unwrap(), fs::metadata(&twin).unwrap());
        assert_eq!(
            (one.ino(), one.mode() & 0o777),
            (other.ino(), 0o640),
            "{line}"
        );
        // Files of another owner can only be tested by root.
        fs::write(&owned, text).unwrap();
        if std::os::unix::fs::chown(&owned, Some(1234), Some(1234)).is_ok() {
            assert_eq!(stochc_with(line, &[&owned]).status, 0, "{line}");
            let metadata = fs::metadata(&owned).unwrap();
            assert_eq!((metadata.uid(), metadata.gid()), (1234, 1234), "{line}");
            assert_ne!(fs::read_to_string(&owned).unwrap(), text, "{line}");
        }
        let names = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(names, 3, "{line}");
    }
}
