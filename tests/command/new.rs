//! Tests `stochc new`, and the commands that it suggests.
use crate::stochc::{command, run_command};

/// Checks that each template is a formatted program, and that its three suggested commands work in
/// order.
#[test]
fn the_next_commands_work() {
    for template in ["structure", "scene", "plan"] {
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
