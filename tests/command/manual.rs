use std::io::Write as _;
use std::process::{Command, Stdio};

use clap::CommandFactory as _;
use stochc::cli::Cli;
use stochc::compiler::diagnostic::Code;

use crate::skipped::skipped;
use crate::stochc::{stochc, stochc_with};

fn subcommands() -> Vec<String> {
    let command = Cli::command();
    let names = command.get_subcommands().map(|it| it.get_name().to_owned());
    names.collect()
}

/// Returns the names of all pages of the manual, including pages of nested subcommands.
fn pages() -> Vec<String> {
    let mut left = vec![("stochc".to_owned(), Cli::command())];
    let mut names = Vec::new();
    while let Some((name, command)) = left.pop() {
        let nested = command.get_subcommands();
        left.extend(nested.map(|it| (format!("{name}-{}", it.get_name()), it.clone())));
        names.push(name);
    }
    names
}

/// Runs another program with a text as its input. Returns whether it succeeded, with its output.
/// Returns `None` if the program is not installed.
fn tool(command: &str, input: &str) -> Option<(bool, String)> {
    let mut words = command.split(' ');
    let mut child = Command::new(words.next()?)
        .args(words)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .inspect_err(|_| {
            let package = command.split(' ').next().unwrap();
            skipped(package, command);
        })
        .ok()?;
    let mut to = child.stdin.take().unwrap();
    let input = input.to_owned();
    let writer = std::thread::spawn(move || to.write_all(input.as_bytes()));
    let output = child.wait_with_output().unwrap();
    // The program may exit before it has read the whole input.
    let _ = writer.join();
    let printed = [output.stdout, output.stderr].concat();
    Some((
        output.status.success(),
        String::from_utf8_lossy(&printed).into_owned(),
    ))
}

#[test]
fn every_shell_gets_a_script_with_all_subcommands_and_codes() {
    for (shell, checker) in [
        ("bash", Some("bash -n")),
        ("zsh", Some("zsh -n")),
        ("fish", Some("fish --no-execute")),
        ("powershell", None),
        ("elvish", None),
    ] {
        let outcome = stochc(&format!("completions {shell}"));
        assert_eq!((outcome.status, outcome.err.as_str()), (0, ""), "{shell}");
        for subcommand in subcommands() {
            assert!(outcome.out.contains(&subcommand), "{shell}: {subcommand}");
        }
        // The generators for other shells complete only values of options.
        if checker.is_some() {
            for code in Code::ALL {
                assert!(outcome.out.contains(code.name()), "{shell}: {code}");
            }
        }
        if let Some((fine, complaint)) = checker.and_then(|checker| tool(checker, &outcome.out)) {
            assert!(fine && complaint.is_empty(), "{shell}: {complaint}");
        }
    }
    assert_eq!(stochc("completions tcsh").status, 2);
}

#[test]
fn bash_completes_subcommands_and_codes() {
    let script = stochc("completions bash").out;
    let complete = |words: &str, at: usize| {
        let run = format!(
            "{script}\nCOMP_WORDS=({words}); COMP_CWORD={at}; \
             _stochc stochc \"${{COMP_WORDS[{at}]}}\" \"\"; printf '%s ' \"${{COMPREPLY[@]}}\"\n"
        );
        tool("bash -s", &run).map(|(_, completed)| completed)
    };
    if let Some(completed) = complete("stochc che", 1) {
        assert_eq!(completed, "check ");
        assert_eq!(complete("stochc explain cyc", 2).unwrap(), "cycle ");
        assert_eq!(complete("stochc completions zs", 2).unwrap(), "zsh ");
    }
}

#[test]
fn the_manual_has_a_page_for_every_subcommand() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("man1");
    let completed = stochc_with("man --out", &[pages.to_str().unwrap()]);
    assert_eq!(
        (
            completed.status,
            completed.out.as_str(),
            completed.err.as_str()
        ),
        (0, "", "")
    );
    let names = self::pages();
    assert_eq!(std::fs::read_dir(&pages).unwrap().count(), names.len());
    for name in names {
        let page = std::fs::read_to_string(pages.join(format!("{name}.1"))).unwrap();
        let title = page.lines().find(|line| line.starts_with(".TH")).unwrap();
        assert!(title.starts_with(&format!(".TH {name} 1")), "{title}");
        // groff renders the page with all its warnings enabled.
        if let Some((fine, text)) = tool("groff -man -Tascii -ww -z", &page) {
            assert!(fine && text.is_empty(), "{name}: {text}");
        }
    }
    let first = stochc("man");
    let written = std::fs::read_to_string(pages.join("stochc.1")).unwrap();
    assert_eq!(first.out, written);
    for name in subcommands() {
        assert!(first.out.contains(&format!("stochc\\-{name}(1)")), "{name}");
    }
}
