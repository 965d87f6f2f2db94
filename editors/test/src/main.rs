//! Compares the tree-sitter grammar with the pest grammar, and writes the tokens of every program
//! for the test of the TextMate grammar. Arguments: the file to write, and a file that lists the
//! programs. With `--write`, generates the parser.
mod tokens;

use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use serde_json::{Value, json};
use tree_sitter::{Language, Parser, Query, QueryCursor, StreamingIterator as _};
use tree_sitter_language::LanguageFn;

unsafe extern "C" {
    fn tree_sitter_stochc() -> *const ();
}

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tree-sitter-stochc");

/// Version of generated parsers. Neovim 0.7 to 0.10 read no later one.
const ABI: usize = 14;

fn main() -> ExitCode {
    // Recursive rules of pest need the stack.
    let test = std::thread::Builder::new()
        .stack_size(1 << 28)
        .spawn(run)
        .unwrap();
    match test.join().unwrap() {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let mut arguments = std::env::args().skip(1);
    let first = arguments.next().ok_or("TOKENS.jsonl LIST")?;
    if first == "--write" {
        return generate(Path::new(FOLDER).join("src").as_path());
    }
    is_up_to_date()?;
    let mut comparison = Comparison::new()?;
    let files = arguments.next().ok_or("no list of files")?;
    let files = fs::read_to_string(files).map_err(|error| error.to_string())?;
    for path in files.lines() {
        let bytes = fs::read(path).map_err(|error| format!("{path}: {error}"))?;
        let Ok(text) = String::from_utf8(bytes) else {
            continue;
        };
        if !path.ends_with(".md") {
            comparison.program(path, &text);
            continue;
        }
        let blocks = text
            .split("\n```sa")
            .skip(1)
            .filter_map(|rest| rest.split_once('\n'));
        for (number, (_, block)) in blocks.enumerate() {
            let program = block.split("\n```").next().unwrap_or_default();
            comparison.program(&format!("{path}, block {number}"), program);
        }
    }
    fs::write(first, comparison.lines).map_err(|error| error.to_string())?;
    println!(
        "tree-sitter: {} tokens of {} programs ({} with a keyword as a name or a zero byte left out; pest rejects {})",
        comparison.tokens, comparison.accepted, comparison.left_out, comparison.rejected
    );
    if comparison.problems.is_empty() {
        return Ok(());
    }
    let problems = &comparison.problems;
    Err(format!(
        "{} problems\n{}",
        problems.len(),
        problems[..problems.len().min(20)].join("\n")
    ))
}

/// Generates the parser into a folder.
fn generate(folder: &Path) -> Result<(), String> {
    let (optimizations, mut diagnostics) = (Default::default(), Vec::new());
    tree_sitter_generate::generate_parser_in_directory(
        FOLDER,
        Some(folder),
        None::<&str>,
        ABI,
        None,
        None,
        true,
        optimizations,
        &mut diagnostics,
    )
    .map_err(|error| error.to_string())
}

/// Checks that the committed parser is the one that the generator makes.
fn is_up_to_date() -> Result<(), String> {
    let folder = std::env::temp_dir().join(format!("stochc-parser-{}", std::process::id()));
    generate(&folder)?;
    let read =
        |folder: &Path, file: &str| fs::read_to_string(folder.join(file)).unwrap_or_default();
    let committed = Path::new(FOLDER).join("src");
    let files = [
        "parser.c",
        "grammar.json",
        "node-types.json",
        "tree_sitter/parser.h",
    ];
    let old = files
        .into_iter()
        .find(|file| read(&folder, file) != read(&committed, file));
    let _ = fs::remove_dir_all(&folder);
    match old {
        Some(file) => Err(format!(
            "src/{file} is out of date: run `editors/test/run --write`"
        )),
        None => Ok(()),
    }
}

struct Comparison {
    parser: Parser,
    highlights: Query,
    captures: HashMap<String, String>,
    tokens: usize,
    accepted: usize,
    left_out: usize,
    rejected: usize,
    problems: Vec<String>,
    /// Programs and their tokens, in JSON.
    lines: String,
}

impl Comparison {
    fn new() -> Result<Comparison, String> {
        // SAFETY: the generated function returns a pointer to a static language.
        let language = Language::new(unsafe { LanguageFn::from_raw(tree_sitter_stochc) });
        let mut parser = Parser::new();
        parser
            .set_language(&language)
            .map_err(|error| error.to_string())?;
        let query = |name: &str| {
            let text = fs::read_to_string(format!("{FOLDER}/queries/{name}.scm"))
                .map_err(|error| error.to_string())?;
            Query::new(&language, &text).map_err(|error| format!("{name}.scm: {error}"))
        };
        for name in ["folds", "indents", "locals"] {
            query(name)?;
        }
        let scopes: HashMap<String, [String; 2]> =
            serde_json::from_str(include_str!("../scopes.json"))
                .map_err(|error| error.to_string())?;
        Ok(Comparison {
            parser,
            highlights: query("highlights")?,
            captures: scopes
                .into_iter()
                .map(|(kind, [_, capture])| (kind, capture))
                .collect(),
            tokens: 0,
            accepted: 0,
            left_out: 0,
            rejected: 0,
            problems: Vec::new(),
            lines: String::new(),
        })
    }

    fn program(&mut self, path: &str, text: &str) {
        let Some(program) = tokens::parse(text) else {
            self.rejected += 1;
            if path.starts_with("examples/") || path.contains("/snippets/") {
                self.problems
                    .push(format!("{path}: pest rejects it\n{text}"));
            }
            return;
        };
        // Lexers of tree-sitter take the character 0 for the end of the text.
        if program.has_reserved_name || text.contains('\0') {
            self.left_out += 1;
            return;
        }
        self.accepted += 1;
        self.tokens += program.tokens.len();
        let line: Value = json!({ "path": path, "text": text, "tokens": program.tokens });
        self.lines.push_str(&format!("{line}\n"));

        let tree = self
            .parser
            .parse(text, None)
            .expect("the parser has a language");
        if tree.root_node().has_error() {
            let tree = tree.root_node().to_sexp();
            self.problems.push(format!(
                "{path}: tree-sitter finds an error\n{text}\n{tree}"
            ));
            return;
        }
        let mut found: HashMap<(usize, usize), Vec<&str>> = HashMap::new();
        let names = self.highlights.capture_names();
        let mut cursor = QueryCursor::new();
        let mut captures = cursor.captures(&self.highlights, tree.root_node(), text.as_bytes());
        while let Some((matched, index)) = captures.next() {
            let capture = matched.captures()[*index];
            let range = capture.node.byte_range();
            found
                .entry((range.start, range.end))
                .or_default()
                .push(names[capture.index as usize]);
        }
        for (start, end, kind) in program.tokens {
            let captures = found.get(&(start, end)).map_or(&[][..], Vec::as_slice);
            if captures != [self.captures[kind].as_str()] {
                let line = text[..start].matches('\n').count() + 1;
                let token = &text[start..end];
                self.problems.push(format!(
                    "{path}:{line}: `{token}` is a {kind}, captured as {captures:?}"
                ));
            }
        }
    }
}
