use std::fs;

use crate::stochc::{path, stochc, stochc_reading, stochc_with};

const TOWER: &str = "\
tower: 3 captures in 2 phases
  proved: completes in every order
  proved: no cell is blocked or used twice
  longest serial chain (critical path), 3 in total:
    foot  1: M.up -> A
    top   2: A.up -> B, B.up -> C
  estimate: 1,857 ticks on average, 983 to 2,914 in 80 % of the runs; details: `--cost`
";

/// Returns the line about the tower with the file name, as printed for several files.
fn tower_of_several() -> String {
    format!("tests/fixtures/tower.sa: {TOWER}")
}

#[test]
fn a_valid_program_is_summarized() {
    let outcome = stochc("check tests/fixtures/tower.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    assert_eq!(outcome.out, TOWER);
}

#[test]
fn the_critical_captures_are_printed() {
    let outcome = stochc("check --cost=3 examples/five_tower.sa");
    assert_eq!(outcome.status, 0);
    let rows = |from: &str| {
        let lines = outcome
            .out
            .lines()
            .skip_while(|line| !line.trim_start().starts_with(from));
        let rows = lines
            .skip(2)
            .take_while(|line| line.starts_with("  ") && line.len() > 2);
        let words = rows.map(|row| row.split_whitespace().map(str::to_owned).collect());
        words.collect::<Vec<Vec<String>>>()
    };
    let phases = rows("phase (lower");
    let number = |word: &str| word.replace(',', "").parse::<f64>().unwrap();
    assert_eq!(phases[0][..3], ["corners", "2", "4"]);
    assert_eq!(phases[1][..3], ["centre", "2", "1"]);
    // The numbers are mean, 10 %, median and 90 %, and the total of both phases.
    for times in [&phases[0][3..], &phases[1][3..], &phases[2][1..]] {
        let [mean, low, median, high] = [0, 1, 2, 3].map(|i| number(&times[i]));
        assert!(
            low < median && median < high && low < mean && mean < high,
            "{times:?}"
        );
    }
    let sum = number(&phases[0][3]) + number(&phases[1][3]);
    assert!((sum - number(&phases[2][1])).abs() <= 1.0, "{phases:?}");
    let captures = rows("capture ");
    assert_eq!(captures[0][..3], ["M.up", "->", "N"]);
    assert!(
        outcome
            .out
            .contains("\n  and 7 more; `--cost 10` shows them\n"),
        "{}",
        outcome.out
    );
    assert!(
        outcome
            .out
            .contains("Times are estimates of the rate model."),
        "{}",
        outcome.out
    );
}

#[test]
fn a_timeout_reached_by_some_runs_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "a.sa");
    for (timeout, is_stopped) in [("", false), ("timeout 2500 ticks", true)] {
        let text = format!(
            "assembly a {{
                seed plate 1 x 1 {{ M at (0, 0) }}
                phase p {timeout} {{ M.up ->> T[1..3] }}
            }}"
        );
        std::fs::write(&file, &text).unwrap();
        let short = stochc_with("check", &[&file]);
        assert_eq!(short.status, 0, "{}", short.err);
        assert!(short.out.contains("of the runs"), "{}", short.out);
        let never = "% never complete)";
        assert_eq!(short.out.contains(never), is_stopped, "{}", short.out);
        // The message is one line at any width of the terminal.
        let long = stochc_with("check --cost=5", &[&file])
            .out
            .replace("\n  ", " ");
        assert_eq!(
            long.contains("a phase reached its timeout"),
            is_stopped,
            "{long}"
        );
        // In JSON, the costs are part of the document.
        let json = stochc_with("check --cost=5 --json", &[&file]);
        assert_eq!(json.json()["diagnostics"], serde_json::json!([]));
        let phases = &json.json()["programs"][0]["cost"]["phases"];
        assert!(phases[0]["depth"].is_number(), "{phases}");
        assert!(!json.err.contains("times in ticks"), "{}", json.err);
    }
}

#[test]
fn a_timeout_reached_by_most_runs_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "a.sa");
    let text =
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p timeout 60 ticks { M.up -> A } }";
    std::fs::write(&file, text).unwrap();
    let outcome = stochc_with("check", &[&file]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let line = outcome.out.lines().last().unwrap();
    assert!(
        line.starts_with("  estimate: a phase reaches its timeout in 9"),
        "{line}"
    );
}

#[test]
fn the_reason_for_no_estimate_is_stated() {
    for (file, reason) in [
        (
            "examples/microns.sa",
            "scene `microns` has not been calibrated; measure it with `stochc calibrate`",
        ),
        (
            "examples/experiment_2.sa",
            "the rate model does not support aggregates",
        ),
        ("examples/five_tower.sa", "blocks may jam (tight-approach)"),
        (
            "tests/fixtures/soft.sa",
            "scene `soft` has not been calibrated",
        ),
    ] {
        let outcome = stochc_with("check", &[file]);
        let line = format!("  no estimate: {reason}");
        assert!(outcome.out.contains(&line), "{file}: {}", outcome.out);
    }
}

#[test]
fn times_need_the_rates_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let program = path(folder.path(), "slow.sa");
    let text = fs::read_to_string("tests/fixtures/tower.sa").unwrap();
    fs::write(
        &program,
        text.replace("assembly tower", "assembly tower in hemisphere_2005"),
    )
    .unwrap();
    let outcome = stochc_with("check --cost=10 --allow warnings", &[&program]);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    assert!(
        outcome
            .out
            .contains("No times: this scene has no calibrated rates"),
        "{}",
        outcome.out
    );
    assert!(!outcome.out.contains("in ticks"), "{}", outcome.out);
    // Rates of another scene are not used. The same rates are used for their own scene.
    let shipped = fs::read_to_string("crates/estimate/src/data/hemisphere.rates").unwrap();
    let mut rates: serde_json::Value = serde_json::from_str(&shipped).unwrap();
    let file = path(folder.path(), "x.rates");
    for (scene, are_known) in [("hemisphere", false), ("hemisphere_2005", true)] {
        let scene = stochc_compiler::scene::built_in(scene).unwrap();
        rates["scene"] = serde_json::to_value(scene).unwrap();
        fs::write(&file, rates.to_string()).unwrap();
        let outcome = stochc_with("check --cost=10 --rates", &[&file, &program]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        assert_eq!(
            outcome.err.contains("is not used"),
            !are_known,
            "{}",
            outcome.err
        );
        assert_eq!(
            outcome.out.contains("in ticks"),
            are_known,
            "{}",
            outcome.out
        );
    }
    assert_eq!(
        stochc("check --rates x.rates tests/fixtures/tower.sa").status,
        2
    );
}

#[test]
fn a_file_without_an_assembly_is_valid() {
    let outcome = stochc("check tests/fixtures/importing_tower.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    assert!(outcome.out.ends_with("no assembly or aggregate to check\n"));
    // A shape without an assembly is for `plan`.
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "shape.sa");
    fs::write(&file, "shape post { layer 1..3 { # } }\n").unwrap();
    let outcome = stochc_with("check --allow warnings", &[&file]);
    let advice = format!("`stochc plan {file}` writes an assembly for its shape");
    assert!(outcome.out.contains(&advice), "{}", outcome.out);
    let outcome = stochc_with("simulate", &[&file]);
    assert!(outcome.err.contains(&advice), "{}", outcome.err);
    let outcome = stochc("check tests/fixtures/importing.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    assert!(outcome.out.contains("3 captures"), "{}", outcome.out);
}

#[test]
fn diagnostics_are_printed_on_standard_error() {
    let outcome = stochc("check tests/fixtures/wrong.sa");
    assert_eq!((outcome.status, outcome.out.as_str()), (1, ""));
    for part in ["unknown-name", "wrong.sa:5:", "│", "help:"] {
        assert!(outcome.err.contains(part), "{part} in {}", outcome.err);
    }
    assert!(
        outcome
            .err
            .ends_with("\n1 error\nFor an explanation, run `stochc explain unknown-name`.\n"),
        "{}",
        outcome.err
    );
}

#[test]
fn a_warning_is_not_an_error() {
    let outcome = stochc("check tests/fixtures/careless.sa");
    assert_eq!(outcome.status, 0);
    assert!(outcome.err.contains("seed `N` is never used"));
    assert!(
        outcome.out.contains("1 phase, 1 warning\n"),
        "{}",
        outcome.out
    );
}

#[test]
fn each_assembly_counts_its_own_warnings() {
    let text = "\
let unused = 1
assembly clean { seed plate 3 x 3 { M at (1, 1) } phase grow { M.up -> A } }
assembly careless { seed plate 3 x 3 { M at (1, 1)  N at (0, 0) } let own = 1 phase grow { M.up -> A } }
assembly calm {
    allow unused-seed \"for the camera\"
    seed plate 3 x 3 { M at (1, 1)  N at (0, 0) }
    phase grow { M.up -> A }
}
";
    let outcome = stochc_reading("check -", text);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let verdict = |of: &str| {
        let mut lines = outcome.out.lines();
        let line = lines.find(|line| line.starts_with(of)).unwrap();
        line.rsplit("1 phase").next().unwrap().to_owned()
    };
    assert_eq!(verdict("clean: "), "");
    assert_eq!(verdict("careless: "), ", 2 warnings");
    assert_eq!(verdict("calm: "), ", 1 warning allowed");
    let outside = "1 warning outside of assemblies and aggregates\n";
    assert_eq!(outcome.out.matches(outside).count(), 1, "{}", outcome.out);
    assert!(outcome.err.contains("\n3 warnings;"), "{}", outcome.err);
}

#[test]
fn a_warning_in_a_pattern_counts_for_each_assembly() {
    let text = "\
pattern row(base) { base.up -> A after base }
assembly one { seed plate 3 x 3 { M at (1, 1) } phase grow { row(M) as a } }
assembly two { seed plate 3 x 3 { M at (1, 1) } phase grow { row(M) as b } }
";
    let outcome = stochc_reading("check -", text);
    assert_eq!(
        outcome.out.matches(", 1 warning\n").count(),
        2,
        "{}{}",
        outcome.out,
        outcome.err
    );
    assert!(!outcome.out.contains("outside of"), "{}", outcome.out);
    assert!(outcome.err.contains("\n1 warning"), "{}", outcome.err);
}

#[test]
fn files_that_cannot_be_read_are_errors_of_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let missing = path(folder.path(), "missing.sa");
    let expected = format!("error: cannot read {missing}: file not found\n");
    for command in [
        "check",
        "check --fix",
        "check --format short",
        "compile",
        "simulate",
        "estimate",
        "plan",
        "fmt",
        "trade --out none",
    ] {
        let outcome = stochc_with(command, &[&missing]);
        let all = (outcome.status, outcome.out.as_str(), outcome.err.as_str());
        assert_eq!(all, (2, "", expected.as_str()), "{command}");
    }
    // The messages come before all diagnostics, independent of the order of the files.
    let other = path(folder.path(), "other.sa");
    for command in ["check", "simulate"] {
        let outcome = stochc_with(command, &["tests/fixtures/careless.sa", &missing, &other]);
        assert_eq!(outcome.status, 2, "{}", outcome.err);
        let both = expected.clone() + &expected.replace("missing", "other");
        assert!(outcome.err.starts_with(&both), "{}", outcome.err);
    }
    // The JSON document is still printed.
    let outcome = stochc_with("check --json", &[&missing]);
    assert_eq!(
        (outcome.status, outcome.err.as_str()),
        (2, expected.as_str())
    );
    assert_eq!(outcome.json()["diagnostics"], serde_json::json!([]));
    let outcome = stochc_with("check --format sarif", &[&missing]).json();
    let run = &outcome["runs"][0];
    assert_eq!(run["invocations"][0]["executionSuccessful"], false);
    assert_eq!(run["results"], serde_json::json!([]));
}

#[test]
fn errors_come_before_warnings() {
    let text = "assembly a {
    seed plate 3 x 1 { M at (0, 0)  N at (2, 0) }
    phase p { M.up -> A  M.up -> B }
}
let unused = 1
scene s from hemisphere { tick 1 m }
";
    let outcome = stochc_reading("check --format short -", text);
    let levels = outcome.out.lines().map(|line| line.contains(": error["));
    let levels: Vec<bool> = levels.collect();
    assert!(
        levels.is_sorted_by(|one, next| one >= next),
        "{}",
        outcome.out
    );
    let text = "assembly a {
    seed plate 3 x 1 { M at (0, 0)  N at (2, 0) }
    phase p { M.up -> A }
    phase q { A.up -> B after A }
}
";
    let outcome = stochc_reading("check --deny redundant-after --format short -", text);
    let lines: Vec<&str> = outcome.out.lines().collect();
    assert_eq!(lines.len(), 2, "{}", outcome.out);
    assert!(
        lines[0].contains(":4:31: error[redundant-after]"),
        "{}",
        outcome.out
    );
    assert!(
        lines[1].contains(":2:37: warning[unused-seed]"),
        "{}",
        outcome.out
    );
}

/// Checks that `check` draws warnings, and that other commands print each warning on one line. They
/// print warnings only after the command line has been validated.
#[test]
fn warnings_are_one_line_for_other_commands() {
    let line = "tests/fixtures/careless.sa:4:37: warning[unused-seed]: seed `N` is never used\n";
    for command in ["simulate --runs 1 --model shuffle", "estimate"] {
        let file = "tests/fixtures/careless.sa";
        let outcome = stochc_with(command, &[file]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        assert!(outcome.err.starts_with(line), "{command}: {}", outcome.err);
        assert!(!outcome.err.contains("help:"), "{command}: {}", outcome.err);
        for quiet in ["-q", "--quiet"] {
            let outcome = stochc_with(command, &[file, quiet]);
            assert_eq!(
                (outcome.status, outcome.err.as_str()),
                (0, line),
                "{command}"
            );
        }
    }
    // An error of the command line comes first.
    let outcome = stochc("sweep tests/fixtures/careless.sa --vary nothing=1,2");
    assert_eq!(outcome.status, 2);
    let lines: Vec<&str> = outcome.err.lines().collect();
    assert!(lines[0].starts_with("error: "), "{}", outcome.err);
    assert_eq!(lines.last(), Some(&line.trim_end()));
}

#[test]
fn the_option_with_two_letters_swapped_is_suggested() {
    let outcome = stochc("simulate tests/fixtures/tower.sa --rusn 5");
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("'--runs'"), "{}", outcome.err);
    assert!(!outcome.err.contains("'--run'"), "{}", outcome.err);
}

/// Tests links to programs and folders, and file names that are not UTF-8.
#[test]
#[cfg(target_os = "linux")]
fn skipped_files_of_a_folder_are_reported() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("in")).unwrap();
    fs::create_dir_all(at("elsewhere/deep")).unwrap();
    fs::copy("tests/fixtures/tower.sa", at("in/ok.sa")).unwrap();
    fs::copy("tests/fixtures/wrong.sa", at("elsewhere/bad.sa")).unwrap();
    fs::copy("tests/fixtures/wrong.sa", at("elsewhere/deep/worse.sa")).unwrap();
    let own = path(folder.path(), "in");
    let files = |output: &str| -> Vec<String> {
        let lines = output.lines().filter_map(|line| line.split(".sa").next());
        lines.map(|file| file.replace(&own, "")).collect()
    };
    symlink("../elsewhere/bad.sa", at("in/link.sa")).unwrap();
    symlink("ok.sa", at("in/same.sa")).unwrap();
    let output = stochc_with("check --format short", &[&own]);
    assert_eq!((output.status, output.err.as_str()), (1, ""));
    assert_eq!(files(&output.out), ["/link"]);
    // Each file is checked once, although a link leads back to it.
    symlink("../elsewhere/deep", at("in/linked")).unwrap();
    symlink("../../in", at("elsewhere/deep/back")).unwrap();
    let outcome = stochc_with("check --format short", &[&own]);
    assert_eq!(files(&outcome.out), ["/link", "/linked/worse"]);
    symlink("nowhere.sa", at("in/broken.sa")).unwrap();
    let outcome = stochc_with("check --format short", &[&own]);
    assert_eq!(outcome.status, 2);
    let broken = format!("error: cannot read {own}/broken.sa: file not found\n");
    assert_eq!(outcome.err, broken);
    fs::remove_file(at("in/broken.sa")).unwrap();
    let strange = at("in").join(OsStr::from_bytes(b"caf\xe9.sa"));
    fs::copy("tests/fixtures/wrong.sa", strange).unwrap();
    let outcome = stochc_with("check --format short", &[&own]);
    assert_eq!(outcome.status, 2);
    let expected = format!("error: cannot read {own}/caf\u{fffd}.sa: its name is not UTF-8\n");
    assert_eq!(outcome.err, expected);
}

#[test]
fn the_standard_input_is_for_check_and_fmt() {
    for (command, argument, what) in [
        ("compile", "tests/fixtures", "a folder"),
        ("compile", "-", "the standard input"),
        ("simulate", "-", "the standard input"),
        ("trade --out none", "-", "the standard input"),
    ] {
        let outcome = stochc_with(command, &[argument]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{command}");
        let expected = format!("error: `{argument}` is {what}: name the file of a program;");
        assert!(outcome.err.starts_with(&expected), "{}", outcome.err);
    }
}

/// Checks that a folder stands for its programs if a command takes several.
#[test]
fn the_programs_of_a_folder_are_simulated() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().to_str().unwrap();
    let empty = stochc_with("simulate", &[own]);
    assert_eq!(empty.status, 2);
    assert!(
        empty.err.contains("contains no program (`*.sa`)"),
        "{}",
        empty.err
    );
    for name in ["a.sa", "b.sa"] {
        fs::copy("tests/fixtures/tower.sa", folder.path().join(name)).unwrap();
    }
    let outcome = stochc_with("simulate --model shuffle --runs 2 --quiet", &[own]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(outcome.out.contains("tower (2)"), "{}", outcome.out);
}

#[test]
fn a_folder_is_the_programs_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("deep");
    std::fs::create_dir_all(inner.join(".hidden")).unwrap();
    let careless = std::fs::read("tests/fixtures/careless.sa").unwrap();
    for file in ["a.sa", "deep/b.sa", "deep/c.txt", "deep/.hidden/d.sa"] {
        std::fs::write(folder.path().join(file), &careless).unwrap();
    }
    let own = folder.path().to_str().unwrap();
    let lines = |output: &str| -> Vec<String> {
        let files = output
            .lines()
            .map(|line| line.split(':').next().unwrap_or_default());
        files.map(|file| file.replace(own, "")).collect()
    };
    let output = stochc_with("check --format short", &[own]);
    assert_eq!((output.status, output.err.as_str()), (0, ""));
    assert_eq!(lines(&output.out), ["/a.sa", "/deep/b.sa"]);
    // Each program is checked once.
    let outcome = stochc_with("check --format short", &[own, &path(&inner, "b.sa"), own]);
    assert_eq!(lines(&outcome.out), ["/a.sa", "/deep/b.sa"]);
    let outcome = stochc_with("check", &[own]);
    assert!(
        outcome.err.contains(
            "\n2 warnings; `stochc check --fix` can fix them all\nFor an explanation, run "
        ),
        "{}",
        outcome.err
    );
    // With `--fix`, the files of a folder are fixed one by one.
    let outcome = stochc_with("check --fix", &[own]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(stochc_with("check --deny warnings", &[own]).status, 0);

    let empty = tempfile::tempdir().unwrap();
    let outcome = stochc_with(
        "check",
        &[empty.path().to_str().unwrap(), "tests/fixtures/tower.sa"],
    );
    assert_eq!((outcome.status, outcome.out), (2, tower_of_several()));
    assert!(
        outcome.err.contains("contains no program (`*.sa`)"),
        "{}",
        outcome.err
    );
}

#[test]
fn the_standard_input_is_a_program() {
    let wrong = "assembly a {\n    seed plate 2 x 1 { M at (0, 0)  N at (1, 0) }\n    phaze p { M.up -> A }\n}\n";
    let right =
        "assembly a {\n    seed plate 2 x 1 { M at (0, 0) }\n    phase p { M.up -> A }\n}\n";
    let outcome = stochc_reading("check --format short -", wrong);
    assert_eq!(outcome.status, 1);
    assert!(
        outcome.out.starts_with("<stdin>:3:11: error[syntax]: "),
        "{}",
        outcome.out
    );
    // With `--fix`, the output is the fixed source, and messages go to standard error.
    let outcome = stochc_reading("check --fix -", wrong);
    assert_eq!((outcome.status, outcome.out.as_str()), (0, right));
    assert!(
        outcome.err.starts_with("<stdin>: 2 changes made\n"),
        "{}",
        outcome.err
    );
    assert!(
        outcome.err.contains("a: 1 capture in 1 phase\n  proved: "),
        "{}",
        outcome.err
    );
    let outcome = stochc_reading("check --fix -", right);
    assert_eq!((outcome.status, outcome.out.as_str()), (0, right));
    let outcome = stochc_reading("check --fix --dry-run -", wrong);
    assert_eq!(outcome.status, 1);
    assert!(outcome.out.contains("-    phaze p"), "{}", outcome.out);
    let outcome = stochc_reading("check --fix --json -", wrong);
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    assert!(
        outcome.err.contains("leave one of the two out"),
        "{}",
        outcome.err
    );
    // Imports of standard input are relative to the working directory.
    let outcome = stochc_reading("check -", "import \"tests/fixtures/importing_tower.sa\"\n");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
}

#[test]
fn the_last_line_counts_all_diagnostics() {
    let outcome = stochc("check tests/fixtures/wrong.sa tests/fixtures/careless.sa");
    assert!(
        outcome.err
            .ends_with("\n1 error, 1 warning; `stochc check --fix` can fix 1 of them\nFor explanations, run `stochc explain CODE` with unknown-name or unused-seed.\n"),
        "{}",
        outcome.err
    );
    for command in ["compile", "simulate"] {
        let outcome = stochc(&format!("{command} tests/fixtures/wrong.sa"));
        assert!(
            outcome
                .err
                .ends_with("\n1 error\nFor an explanation, run `stochc explain unknown-name`.\n"),
            "{}",
            outcome.err
        );
    }
}

#[test]
#[cfg(unix)]
fn an_unreadable_file_is_reported() {
    use std::fs::Permissions;
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let file = crate::stochc::path(folder.path(), "secret.sa");
    std::fs::write(&file, "").unwrap();
    std::fs::set_permissions(&file, Permissions::from_mode(0o000)).unwrap();
    if std::fs::File::open(&file).is_ok() {
        return; // Root ignores permissions.
    }
    let outcome = stochc_with("check", &[&file]);
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("permission denied"), "{}", outcome.err);
}

#[test]
fn bytes_that_are_not_text_are_a_diagnostic() {
    let folder = tempfile::tempdir().unwrap();
    let file = crate::stochc::path(folder.path(), "bytes.sa");
    std::fs::write(&file, b"assembly x {\n \xff }").unwrap();
    let outcome = stochc_with("check --format short", &[&file]);
    assert_eq!(outcome.status, 1, "{}", outcome.err);
    assert!(outcome.out.contains("error[not-utf8]"), "{}", outcome.out);
}

#[test]
fn all_files_are_checked() {
    let outcome = stochc("check tests/fixtures/wrong.sa tests/fixtures/tower.sa");
    assert_eq!(outcome.status, 1);
    assert_eq!(outcome.out, tower_of_several());
    assert!(outcome.err.contains("unknown-name"));
    let outcome =
        stochc("check tests/fixtures/none.sa tests/fixtures/wrong.sa tests/fixtures/tower.sa");
    assert_eq!(outcome.status, 2, "the worst of all");
    assert_eq!(outcome.out, tower_of_several());
}

#[test]
fn short_diagnostics_are_one_per_line() {
    let outcome = stochc("check --format short tests/fixtures/wrong.sa tests/fixtures/tower.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (1, ""));
    let lines = "\
tests/fixtures/wrong.sa:5:18: error[unknown-name]: cannot find block `Q`
";
    assert_eq!(outcome.out, lines);
}

#[test]
fn sarif_of_all_files_is_one_run() {
    let outcome = stochc("check --format sarif tests/fixtures/wrong.sa tests/fixtures/careless.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (1, ""));
    let log = outcome.json();
    let runs = log["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 1);
    let results = runs[0]["results"].as_array().unwrap();
    let reported: Vec<_> = (results.iter())
        .map(|result| {
            let place = &result["locations"][0]["physicalLocation"];
            (
                place["artifactLocation"]["uri"].as_str().unwrap(),
                place["region"]["startLine"].as_u64().unwrap(),
                result["ruleId"].as_str().unwrap(),
                result["level"].as_str().unwrap(),
            )
        })
        .collect();
    assert_eq!(
        reported,
        [
            ("tests/fixtures/wrong.sa", 5, "unknown-name", "error"),
            ("tests/fixtures/careless.sa", 4, "unused-seed", "warning"),
        ]
    );
}

#[test]
fn json_of_all_files_is_one_document_with_lines_and_columns() {
    let outcome = stochc("check --json tests/fixtures/wrong.sa tests/fixtures/careless.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (1, ""));
    let document = outcome.json();
    let diagnostics = &document["diagnostics"];
    let reported: Vec<_> = (diagnostics.as_array().unwrap().iter())
        .map(|diagnostic| {
            let label = &diagnostic["labels"][0];
            let at = |end: &str| {
                let end = &label[end];
                (
                    end["line"].as_u64().unwrap(),
                    end["column"].as_u64().unwrap(),
                )
            };
            let text = |value: &serde_json::Value| value.as_str().unwrap().to_owned();
            let file = text(&label["file"]);
            (file, text(&diagnostic["code"]), at("start"), at("end"))
        })
        .collect();
    let diagnostic = |file: &str, code: &str, start, end| {
        (
            format!("tests/fixtures/{file}.sa"),
            code.to_owned(),
            start,
            end,
        )
    };
    assert_eq!(
        reported,
        [
            diagnostic("wrong", "unknown-name", (5, 18), (5, 27)),
            diagnostic("careless", "unused-seed", (4, 37), (4, 38)),
        ]
    );
    assert_eq!(diagnostics[0]["severity"], "error");
    let label = &diagnostics[0]["labels"][0];
    let text = std::fs::read("tests/fixtures/wrong.sa").unwrap();
    let offset = |end: &str| label[end]["offset"].as_u64().unwrap() as usize;
    assert_eq!(&text[offset("start")..offset("end")], b"Q.up -> A");
    let right = stochc("check --json tests/fixtures/tower.sa").json();
    assert_eq!(right["diagnostics"], serde_json::json!([]));
}

#[test]
fn event_tables_are_run_in_every_order() {
    let outcome = stochc("verify tests/fixtures/tower.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let (status, _) = TOWER.split_once("  longest").unwrap();
    let explored =
        "  Explored every order of events (equivalent orders once): 10 states, 9 transitions.
1 program verified; every order of events explored: 1
";
    assert_eq!(outcome.out, format!("{status}{explored}"));
    // An invalid program has no tables to verify.
    let outcome = stochc("verify tests/fixtures/wrong.sa");
    assert_eq!(outcome.status, 1);
    assert!(
        outcome.out.starts_with("0 programs verified"),
        "{}",
        outcome.out
    );
}

#[test]
fn dead_blocks_are_survived_with_retries() {
    let outcome = stochc("verify --faults 3 examples/dead_blocks.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let survives = "  Survives 3 dockings of dead blocks in every order: ";
    assert!(outcome.out.contains(survives), "{}", outcome.out);

    let outcome = stochc("verify --faults 4 examples/dead_blocks.sa");
    assert_eq!(outcome.status, 3);
    assert!(
        outcome
            .err
            .ends_with("help: write `retry 4` in phase `grow`\n"),
        "{}",
        outcome.err
    );

    let outcome = stochc("verify --faults 1 tests/fixtures/tower.sa");
    assert_eq!(outcome.status, 3);
    assert!(
        outcome
            .out
            .ends_with("; every order of events explored: 1, not surviving dead blocks: 1\n"),
        "{}",
        outcome.out
    );
    insta::assert_snapshot!("dead_block", outcome.err);
}

#[test]
fn long_traces_show_the_fault_and_the_last_steps() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "towers.sa");
    let towers = "assembly towers { seed plate 5 x 3 { M at (1, 1)  N at (3, 1) }
        phase grow { M.up ->> T[1..15]  N.up ->> U[1..15] } }";
    fs::write(&file, towers).unwrap();
    let outcome = stochc_with("verify --faults 1", &[&file]);
    assert_eq!(outcome.status, 3);
    let lines: Vec<&str> = outcome.err.lines().collect();
    // The two lines of the error precede the steps, and the help follows them.
    let steps = &lines[2..lines.len() - 1];
    let first = [
        "       ... 1 step not shown; `--json` lists all",
        "    2. N.up captures a block for U[1], which does not answer",
        "       ... 9 steps not shown; `--json` lists all",
        "   12. T[10].up captures T[11]",
    ];
    assert_eq!(steps[..4], first);
    assert_eq!(steps.len(), 3 + 20, "{}", outcome.err);
}

#[test]
fn proposed_retries_are_valid_in_their_phases() {
    for (file, help) in [
        (
            "examples/line.sa",
            "add `on timeout { release grow  retry 1 }` to phase `grow`",
        ),
        (
            "examples/experiment_1_timed.sa",
            "write the releases of phase `recapture` in a phase of their own. The captures can then be retried",
        ),
    ] {
        let outcome = stochc(&format!("verify --faults 1 {file}"));
        assert_eq!(outcome.status, 3);
        let end = format!("\nhelp: {help}\n");
        assert!(outcome.err.ends_with(&end), "{}", outcome.err);
    }
}

#[test]
fn random_orders_with_dead_blocks_are_counted() {
    let outcome = stochc("verify --faults 3 --states 100 examples/dead_blocks.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let sampled = "  Survives 3 dockings of dead blocks in 1000 random orders.
1 program verified; every order of events explored: 0, 1000 random orders: 1
";
    assert!(outcome.out.ends_with(sampled), "{}", outcome.out);
}

#[test]
fn too_many_orders_are_reported_and_sampled() {
    let outcome = stochc("verify --states 5 tests/fixtures/tower.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let tried = "stopped after 5 states, without a fault.
  Executed in 1000 random orders without a fault: 9000 transitions.
1 program verified; every order of events explored: 0, 1000 random orders: 1
";
    assert!(outcome.out.ends_with(tried), "{}", outcome.out);
}

/// Checks that output of `stochc` in place of a program causes one diagnostic, not one for each
/// line.
#[test]
fn json_without_extension_is_recognized() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "hemisphere.sa");
    fs::copy("crates/estimate/src/data/hemisphere.rates", &file).unwrap();
    let outcome = stochc_with("check", &[&file]);
    assert_eq!(outcome.status, 1);
    assert!(
        outcome.err.contains("the file is JSON, not a program"),
        "{}",
        outcome.err
    );
    assert!(
        outcome.err.contains("rates are passed with `--rates`"),
        "{}",
        outcome.err
    );
    assert!(outcome.err.contains("\n1 error\n"), "{}", outcome.err);
}

/// Checks that messages about numbers use words for users, not words of a parser.
#[test]
fn invalid_numbers_of_options_are_reported() {
    for (number, words) in [
        ("abc", "a whole number is needed, with digits alone"),
        ("1.5", "a whole number is needed, with digits alone"),
        ("99999999999999999999999", "the number is too large"),
        ("0", "0 is not in 1..=10000000"),
    ] {
        let outcome = stochc_with("simulate tests/fixtures/tower.sa --runs", &[number]);
        let expected = format!("error: invalid value '{number}' for '--runs <N>': {words}\n");
        assert_eq!(outcome.status, 2);
        assert!(outcome.err.starts_with(&expected), "{}", outcome.err);
    }
}

#[test]
fn an_unknown_scene_is_reported_with_the_built_in_ones() {
    let outcome = stochc("calibrate hemispere");
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("is called `hemispere`"),
        "{}",
        outcome.err
    );
    assert!(
        outcome.err.contains("`hemisphere`, `hemisphere_soft`"),
        "{}",
        outcome.err
    );
}

/// Checks that offsets in a file include its byte order mark.
#[test]
fn offsets_refer_to_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "marked.sa");
    let text = "\u{feff}assembly a {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase p { M.up -> A let z = 2 }\n}\n";
    fs::write(&file, text).unwrap();
    let found = stochc_with("check --json", &[&file]).json();
    let edit = &found["diagnostics"][0]["fix"]["edits"][0];
    let [start, end] = ["start", "end"].map(|it| edit[it]["offset"].as_u64().unwrap() as usize);
    assert_eq!(text[start..end].trim(), "let z = 2", "{found:#}");
}

/// Checks that all formats report the same column, whatever text precedes it on its line.
#[test]
fn columns_are_characters_in_every_form() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "wide.sa");
    let text = "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { allow unused-let \"größer, µm\" X.up -> A } }\n";
    fs::write(&file, text).unwrap();
    let short = stochc_with("check --allow warnings --format short", &[&file]).out;
    let column = text[..text.find("X.up").unwrap()].chars().count() + 1;
    assert!(short.contains(&format!(":1:{column}: error")), "{short}");
    let drawn = stochc_with("check --allow warnings", &[&file]);
    let drawn = drawn.out + &drawn.err;
    assert!(drawn.contains(&format!(":1:{column}]")), "{drawn}");
}
