//! Tests `stochc new`, and the commands that it suggests.
use crate::stochc::{command, run_command};

const TEMPLATES: [&str; 6] = [
    "structure",
    "suction",
    "magnets",
    "brownian",
    "planar",
    "plan",
];

/// Checks that each template is a formatted program, and that its three suggested commands work in
/// order.
#[test]
fn the_next_commands_work() {
    for template in TEMPLATES {
        let folder = tempfile::tempdir().unwrap();
        let run =
            |words: &[&str]| run_command(command(words.iter().copied()).current_dir(folder.path()));
        let new = run(&["new", "tower", "--template", template]);
        assert_eq!((new.status, new.err.as_str()), (0, ""), "{template}");
        let formatted = run(&["fmt", "--check", "tower.sa"]);
        assert_eq!(
            (formatted.status, formatted.out.as_str()),
            (0, ""),
            "{template}"
        );
        let next: Vec<&str> = (new.out.lines().skip(1))
            .map(|line| line.split('#').next().unwrap().trim())
            .collect();
        assert_eq!(next.len(), 3, "{}", new.out);
        for line in next {
            let mut words: Vec<&str> = line.split(' ').skip(1).collect();
            // Runs with physics would take too long.
            if words[0] == "simulate" {
                words.extend(["--model", "shuffle"]);
            }
            // Runs of models without positions cannot be replayed.
            if words[0] != "replay" {
                let done = run(&words);
                assert_eq!(done.status, 0, "{line}: {}", done.err);
                assert!(!done.err.contains("warning"), "{line}: {}", done.err);
            }
        }
        let again = run(&["new", "tower"]);
        assert_eq!(again.status, 2, "{template}: nothing is replaced");
        let reason = "cannot write `tower.sa`: the file exists";
        assert!(again.err.contains(reason), "{}", again.err);
        let forced = run(&["new", "tower", "--template", template, "--force"]);
        assert_eq!((forced.status, &*forced.out), (0, &*new.out), "{template}");
    }
}

/// Checks that the physics of each template has no warnings, and that a short run does not fail.
#[test]
fn scenes_of_templates_run() {
    for template in ["suction", "magnets", "brownian", "planar"] {
        let folder = tempfile::tempdir().unwrap();
        let run = |line: &str| run_command(command(line.split(' ')).current_dir(folder.path()));
        run(&format!("new tower --template {template}"));
        for line in [
            "check tower.sa --physics --deny warnings",
            "simulate tower.sa --runs 1 --max-ticks 20 --quiet",
        ] {
            let done = run(line);
            // Most runs do not complete within 20 ticks.
            assert!([0, 3].contains(&done.status), "{template}: {}", done.err);
            assert_eq!(done.err, "", "{template}, {line}");
            assert!(!done.out.contains("Failed"), "{template}: {}", done.out);
        }
    }
}

#[test]
fn an_invalid_name_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["", "2towers", "a-b", "a b", "folder/"] {
        let refused = run_command(command(["new", name]).current_dir(folder.path()));
        assert_eq!(refused.status, 2, "{name}");
        assert!(refused.err.contains("is not a name"), "{}", refused.err);
    }
}
