//! Tests the documents. Runs every command in order, as a reader would after cloning the project.
//! Compares the output with the output in the documents.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests read documents and prepare folders for the commands in them"
)]
#![cfg(unix)]
mod dependencies;
mod page;
mod prose;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use page::{Block, blocks, commands};

/// Languages of blocks without commands. `python/tests` runs blocks of `python`.
const NOT_COMMANDS: [&str; 10] = [
    "c",
    "elisp",
    "lua",
    "py",
    "python",
    "sa",
    "sa,fragment",
    "sql",
    "text",
    "toml",
];

/// Returns the README and all pages of `docs/`, by name.
fn documents() -> BTreeMap<String, String> {
    let mut pages = vec![PathBuf::from("README.md")];
    markdown_files(Path::new("docs"), &mut pages);
    let read = |path: PathBuf| {
        let page = std::fs::read_to_string(&path).unwrap();
        (path.to_str().unwrap().to_owned(), page)
    };
    pages.into_iter().map(read).collect()
}

fn markdown_files(folder: &Path, pages: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            markdown_files(&path, pages);
        } else if path.extension().is_some_and(|it| it == "md") {
            pages.push(path);
        }
    }
}

/// Folder as after cloning the project, with a separate home. Its commands are the tested `stochc`,
/// and a `cargo` that runs it.
struct Reader {
    folder: tempfile::TempDir,
    path: std::ffi::OsString,
}

impl Reader {
    fn new() -> Reader {
        let folder = tempfile::tempdir().unwrap();
        let [clone, bin, home] = ["clone", "bin", "home"].map(|name| folder.path().join(name));
        for folder in [&clone.join("examples"), &bin, &home] {
            std::fs::create_dir_all(folder).unwrap();
        }
        copy(Path::new("examples"), &clone.join("examples"));
        std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_stochc"), bin.join("stochc")).unwrap();
        let cargo = "#!/bin/sh\n[ \"$1 $2 $3\" = 'run --release --' ] || exit 127\nshift 3\nexec stochc \"$@\"\n";
        executable(&bin.join("cargo"), cargo);
        let inherited = std::env::var_os("PATH").unwrap();
        let paths = [bin].into_iter().chain(std::env::split_paths(&inherited));
        let path = std::env::join_paths(paths).unwrap();
        Reader { folder, path }
    }

    /// Runs a command in a shell.
    fn run(&self, command: &str) -> Output {
        let mut shell = Command::new("bash");
        shell
            .args(["-c", command])
            .current_dir(self.folder.path().join("clone"))
            .env("HOME", self.folder.path().join("home"))
            .env("PATH", &self.path)
            .stdin(Stdio::null());
        shell.output().unwrap()
    }
}

fn executable(path: &Path, script: &str) {
    use std::os::unix::fs::PermissionsExt;
    std::fs::write(path, script).unwrap();
    std::fs::set_permissions(path, PermissionsExt::from_mode(0o755)).unwrap();
}

/// Returns whether a shell accepts a text as complete. The next line is then a new command.
fn is_whole(text: &str) -> bool {
    let parsed = Command::new("bash").args(["-nc", text]).output().unwrap();
    parsed.status.success()
}

/// Copies a folder recursively.
fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let (from, to) = {
            let entry = entry.unwrap();
            (entry.path(), to.join(entry.file_name()))
        };
        if from.is_dir() {
            copy(&from, &to);
        } else {
            std::fs::copy(&from, &to).unwrap();
        }
    }
}

/// Runs the commands of a document in order. Returns the failures.
fn follow(name: &str, page: &str) -> Vec<String> {
    let reader = Reader::new();
    let blocks = blocks(page);
    let mut wrong = Vec::new();
    for (at, block) in blocks.iter().enumerate() {
        if block.language != "sh" || block.not_run.is_some() {
            continue;
        }
        let mut outcome = String::new();
        for command in commands(block.text, is_whole) {
            let output = reader.run(command.text);
            let (out, err) = (lossy(&output.stdout), lossy(&output.stderr));
            if output.status.code() != Some(command.status) {
                let status = output.status;
                wrong.push(format!(
                    "{name}:{}: {status}: {}\n{err}",
                    block.line, command.text
                ));
            }
            outcome += &out;
            outcome += &err;
        }
        if let Some(shown) = shown_after(&blocks[at + 1..])
            && !outcome.contains(&tidy(shown.text))
        {
            wrong.push(format!(
                "{name}:{}: the output differs from\n{outcome}",
                shown.line
            ));
        }
    }
    wrong
}

/// Returns the block with the output of the previous commands, which is the next `text` block of
/// the section.
fn shown_after<'a>(blocks: &'a [Block<'a>]) -> Option<&'a Block<'a>> {
    let next = blocks.first()?;
    (next.language == "text" && !next.begins_section).then_some(next)
}

fn lossy(bytes: &[u8]) -> String {
    tidy(&String::from_utf8_lossy(bytes))
}

/// Removes spaces at the ends of lines.
fn tidy(text: &str) -> String {
    text.lines().fold(String::new(), |mut tidied, line| {
        tidied += line.trim_end();
        tidied.push('\n');
        tidied
    })
}

#[test]
fn every_document_can_be_followed() {
    let wrong: Vec<String> = (documents().iter())
        .flat_map(|(name, page)| follow(name, page))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Checks the files that links lead to. `docs/build` also checks the anchors.
#[test]
fn every_link_leads_to_a_file() {
    let mut missing = Vec::new();
    for (name, page) in &documents() {
        let folder = Path::new(name).parent().unwrap();
        let targets = page
            .split("](")
            .skip(1)
            .filter_map(|it| it.split(')').next());
        for target in targets.filter(|it| !it.contains("://") && !it.contains(char::is_whitespace))
        {
            let file = target.split('#').next().unwrap();
            if !folder.join(file).exists() {
                missing.push(format!("{name}: {target}"));
            }
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn skipped_commands_are_listed() {
    let (mut list, mut run) = (String::new(), 0);
    for (name, page) in &documents() {
        for block in blocks(page) {
            let Block { line, language, .. } = block;
            let known = language == "sh" || NOT_COMMANDS.contains(&language);
            assert!(
                known,
                "{name}:{line}: `{language}` may contain commands that are not run"
            );
            if language != "sh" {
                continue;
            }
            let Some(reason) = block.not_run else {
                run += 1;
                continue;
            };
            writeln!(list, "{name}: {reason}").unwrap();
            for command in commands(block.text, is_whole) {
                writeln!(list, "    {}", command.text.replace('\n', "\n    ")).unwrap();
            }
        }
    }
    let left_out = list.lines().filter(|line| !line.starts_with(' ')).count();
    insta::assert_snapshot!(format!(
        "{run} blocks are run, {left_out} are not:\n\n{list}"
    ));
}

#[test]
fn a_command_may_span_several_lines() {
    let block =
        "# a note\nfor i in 1 2; do\n    echo $i\ndone\necho a \\\n    b   # exit status 3: why\n";
    let found = commands(block, is_whole);
    let found: Vec<_> = found.iter().map(|it| (it.text, it.status)).collect();
    let expected = [
        ("for i in 1 2; do\n    echo $i\ndone", 0),
        ("echo a \\\n    b   # exit status 3: why", 3),
    ];
    assert_eq!(found[..], expected[..]);
}

#[test]
fn a_command_with_other_output_is_reported() {
    let wrong = follow(
        "page",
        "```sh\nfalse\n```\n```sh\necho one\n```\nsays\n```text\ntwo\n```\n```sh\nfalse   # exit status 1\n```\n\
         # More\n```text\nno output\n```\n<!-- not run: too long -->\n```sh\nexit 7\n```\n",
    );
    assert_eq!(wrong.len(), 2, "{wrong:#?}");
    assert!(
        wrong[0].starts_with("page:1: exit status: 1: false"),
        "{wrong:#?}"
    );
    assert!(
        wrong[1].starts_with("page:8: the output differs from\none"),
        "{wrong:#?}"
    );
}

#[test]
#[should_panic(expected = "`not run` stands above no block")]
fn a_marker_without_its_block_is_reported() {
    blocks("<!-- not run: too long -->\nA sentence.\n");
}
