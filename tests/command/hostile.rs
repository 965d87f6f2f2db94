//! Tests names that contain control characters of terminals.
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::stochc::{Outcome, path, stochc, stochc_with};

/// Name that clears the screen, reverses the reading direction, and begins a new line.
const NAME: &str = "a\u{1b}[2J\u{202e}b\nerror: forged\u{e0041}";

/// Returns whether a text has no active control characters, and no line that starts with a part of
/// the name.
fn is_harmless(text: &str) -> bool {
    let acts = |c: char| stochc::text::is_invisible(c) && c != '\n';
    !text.contains(acts) && !text.lines().any(|line| line.starts_with("error: forged"))
}

#[track_caller]
fn assert_harmless(outcome: &Outcome, is_data: bool) {
    assert!(is_harmless(&outcome.err), "{:?}", outcome.err);
    assert!(is_data || is_harmless(&outcome.out), "{:?}", outcome.out);
    let printed = format!("{}{}", outcome.out, outcome.err);
    assert!(
        is_data || printed.contains("⟨U+001B⟩[2J⟨U+202E⟩b"),
        "{printed}"
    );
}

const TOWER: &str = include_str!("../fixtures/tower.sa");

#[test]
fn names_of_files_are_escaped() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| path(folder.path(), name);
    let [good, wrong, missing, plain] =
        ["good.sa", "wrong.sa", "missing", "unlaid.sa"].map(|end| at(&format!("{NAME}{end}")));
    fs::write(&good, TOWER).unwrap();
    fs::write(
        &wrong,
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phaze p { M.up -> A } }",
    )
    .unwrap();
    fs::write(&plain, format!("{TOWER}\n\n\n")).unwrap();
    for (line, file) in [
        ("check tests/fixtures/tower.sa", &good),
        ("check --physics", &good),
        ("verify", &wrong),
        ("check", &wrong),
        ("check --format short", &wrong),
        ("check --fix --dry-run", &wrong),
        ("check --fix", &wrong),
        ("check", &missing),
        ("check --format short", &missing),
        ("fmt --check", &plain),
        ("fmt", &missing),
        ("compile", &missing),
        ("simulate --quiet --runs 1", &missing),
        ("repeat", &missing),
        ("trade --quiet --runs 2", &missing),
        ("show", &missing),
        ("fsck", &missing),
        ("report", &missing),
        ("replay --run 0", &missing),
        ("export --run 0 --format parquet", &missing),
        (
            "fit tests/fixtures/tower.sa --vary free=1..2 --data",
            &missing,
        ),
    ] {
        assert_harmless(&stochc_with(line, &[file]), false);
    }
    // This argument begins like an option.
    assert_harmless(&stochc_with("check", &[&format!("--{NAME}")]), false);
    let import = format!("import \"{}\"\n", "x\u{1b}[2J\u{202e}b");
    fs::write(at("plain.sa"), import).unwrap();
    for form in ["graphical", "short"] {
        assert_harmless(
            &stochc_with("check --format", &[form, &at("plain.sa")]),
            false,
        );
    }
}

/// Checks names in a file of compiled programs, which may be any text.
#[test]
fn names_in_files_are_escaped() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| path(folder.path(), name);
    let (tower, results) = (at("tower.json"), at("results"));
    stochc_with(
        "compile tests/fixtures/tower.sa --emit executable --out",
        &[&tower],
    );
    let text = fs::read_to_string(&tower).unwrap();
    let mut file: serde_json::Value = serde_json::from_str(&text).unwrap();
    let names = rename(&mut file, "");
    assert!(names >= 4, "{names}");
    // A file of executables begins with the version of its format.
    let programs = &file["programs"];
    let hostile =
        format!("{{\"kind\":\"stochc executable\",\"format\":1,\"programs\":{programs}}}\n");
    fs::write(&tower, hostile).unwrap();
    let simulate = "simulate --model shuffle --runs 3 --max-ticks 100000 --out";
    assert_harmless(&stochc_with(simulate, &[&results, &tower]), false);
    for line in ["show --captures", "show"] {
        assert_harmless(&stochc_with(line, &[&results]), false);
    }
    assert_harmless(
        &stochc_with("trace --model shuffle --run 1", &[&tower]),
        false,
    );
    let again = stochc_with(
        "simulate --model shuffle --runs 3 --max-ticks 100000 --seed 2 --out",
        &[&results, &tower],
    );
    assert_eq!(again.status, 2);
    assert_harmless(&again, true);
    assert_harmless(&stochc_with("replay --run 9", &[&results]), true);
    let none = stochc_with("replay --run 0 --program none", &[&results]);
    assert_harmless(&none, false);
    let trade = "trade --quiet --runs 2 --max-ticks 100";
    assert_harmless(&stochc_with(trade, &[&tower]), false);
}

/// Replaces every value of `key` and every assembly in a document with the hostile name. Returns
/// the number of replacements.
fn rename(value: &mut serde_json::Value, key: &str) -> usize {
    use serde_json::Value::{Array, Object, String};
    match value {
        String(text) if matches!(key, "name" | "assembly") => {
            text.push_str(NAME);
            1
        }
        Array(all) => all.iter_mut().map(|value| rename(value, "")).sum(),
        Object(fields) => (fields.iter_mut())
            .map(|(key, value)| rename(value, key))
            .sum(),
        _ => 0,
    }
}

/// Checks that output on a terminal is escaped, and that files keep the original text.
#[test]
#[cfg(target_os = "linux")]
fn pipes_get_names_unescaped() {
    let there = Command::new("script").arg("--version").output();
    if !there.is_ok_and(|output| output.status.success()) {
        return crate::skipped::skipped("bsdutils", "script");
    }
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "a.sa");
    let hostile = "assembly a { seed plate 1 x 1 { M at (0, 0) } phaze p { M.up -> A } } // \u{1b}[2J\u{202e}\n";
    fs::write(&file, hostile).unwrap();
    let piped = stochc_with("check --fix --dry-run", &[&file]);
    assert!(piped.out.contains("// \u{1b}[2J\u{202e}"), "{}", piped.out);
    let line = format!(
        "{} check --fix --dry-run {file}",
        env!("CARGO_BIN_EXE_stochc")
    );
    let shown = Command::new("script")
        .args(["--quiet", "--return", "--command", &line, "/dev/null"])
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let shown = String::from_utf8_lossy(&shown.stdout).into_owned();
    assert!(shown.contains("// ⟨U+001B⟩[2J⟨U+202E⟩"), "{shown}");
    assert!(
        !shown.contains("\u{1b}[2J") && !shown.contains('\u{202e}'),
        "{shown:?}"
    );
}

#[test]
fn imports_stay_within_the_folder_of_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| path(folder.path(), name);
    let secret = "this text is a secret\n";
    for name in ["own/deep", "other"] {
        fs::create_dir_all(at(name)).unwrap();
    }
    let tower = fs::read_to_string("tests/fixtures/importing_tower.sa").unwrap();
    let main = fs::read_to_string("tests/fixtures/importing.sa").unwrap();
    fs::write(at("other/importing_tower.sa"), &tower).unwrap();
    fs::write(at("own/deep/importing_tower.sa"), &tower).unwrap();
    fs::write(at("other/secret"), secret).unwrap();
    let program = at("own/main.sa");
    let importing = |path: &str| {
        fs::write(&program, main.replace("importing_tower.sa", path)).unwrap();
    };
    let elsewhere = at("other/importing_tower.sa");
    let other = at("other");
    let checked = |more: &[&str]| {
        let words = [more, &[&*program]].concat();
        let outcome = stochc_with("check", &words);
        // Every command that compiles the file prints the same message.
        for line in [
            "compile --emit structure",
            "trace --model shuffle --run 0 --quiet --max-ticks 100000",
            "check --fix",
        ] {
            assert_eq!(
                stochc_with(line, &words).status,
                outcome.status,
                "{line}: {}",
                outcome.err
            );
        }
        outcome
    };
    for path in [
        "../other/secret",
        &*at("other/secret"),
        "/etc/passwd",
        "../other/none",
    ] {
        importing(path);
        let outcome = checked(&[]);
        assert_eq!(outcome.status, 1, "{}", outcome.err);
        assert!(outcome.err.contains("import-outside"), "{}", outcome.err);
        assert!(
            outcome.err.contains("--allow-import DIR"),
            "{}",
            outcome.err
        );
        assert!(
            !outcome.err.contains("somebody") && !outcome.err.contains("root:"),
            "{}",
            outcome.err
        );
    }
    importing("deep/importing_tower.sa");
    assert_eq!(checked(&[]).status, 0);
    for path in ["../other/importing_tower.sa", &elsewhere] {
        importing(path);
        assert_eq!(checked(&[]).status, 1);
        assert_eq!(
            checked(&["--allow-import", &at("own"), "--allow-import", &other]).status,
            0
        );
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&elsewhere, at("own/link.sa")).unwrap();
        importing("link.sa");
        assert_eq!(checked(&[]).status, 1);
        assert_eq!(checked(&["--allow-import", &other]).status, 0);
    }
    let outcome = stochc_with("check --allow-import", &[&at("none"), &program]);
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("--allow-import"), "{}", outcome.err);
    assert!(Path::new("tests/fixtures/importing.sa").exists());
    assert_eq!(stochc("check tests/fixtures/importing.sa").status, 0);
}

#[test]
fn a_file_imported_by_two_paths_is_read_once() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| path(folder.path(), name);
    std::fs::create_dir(at("lib")).unwrap();
    std::fs::write(at("lib/tower.sa"), "pattern tower(b) { b.up -> T }\n").unwrap();
    let program = |imports: &str| {
        let rest =
            "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { tower(M) } }\n".to_owned();
        std::fs::write(at("lib/program.sa"), imports.to_owned() + &rest).unwrap();
        stochc_with("check --deny warnings", &[&at("lib/program.sa")])
    };
    for other in ["../lib/tower.sa", ".//tower.sa", &at("lib/tower.sa")] {
        let outcome = program(&format!("import \"tower.sa\"\nimport \"{other}\"\n"));
        assert_eq!(outcome.status, 0, "{other}: {}", outcome.err);
    }
    let circle = |outcome: crate::stochc::Outcome| {
        assert_eq!(outcome.status, 1);
        let code = outcome.err.lines().next().unwrap_or_default();
        assert!(code.starts_with("error[import-cycle]"), "{}", outcome.err);
        assert!(!outcome.err.contains("duplicate-name"), "{}", outcome.err);
    };
    circle(program(r#"import "tower.sa" import "../lib/program.sa" "#));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("tower.sa", at("lib/link.sa")).unwrap();
        std::os::unix::fs::symlink(".", at("lib/here")).unwrap();
        let outcome = program(r#"import "tower.sa" import "link.sa" import "here/tower.sa" "#);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        circle(program(r#"import "tower.sa" import "here/program.sa" "#));
    }
}
