//! Tests the style of all text that people read. Counts phrases that are hard to read, and long
//! sentences.
//!
//! `limits.txt` lists the largest allowed number for each kind of text. Limits may only decrease.
//! Small improvements need no change of limits, but a number far below its limit does.
//! `STOCHC_WRITE_DOCS=1 cargo test --workspace --test documents prose` lowers the limits.
//! `STOCHC_PROSE=PATH cargo test --workspace --test documents prose` lists all places in the files
//! below `PATH`.
use std::collections::{BTreeMap, HashSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const LIMITS: &str = "tests/documents/limits.txt";

/// Phrases that are hard to read, one per line. `/` separates alternative words.
const PHRASES: &str = include_str!("phrases.txt");

/// Words that must not start a sentence.
const STARTS: [&str; 5] = ["what", "who", "whose", "of", "where"];

/// Kind of text that people read.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Kind {
    Documents,
    Help,
    Messages,
    Comments,
}

impl Kind {
    /// Returns the largest allowed number of words per sentence.
    fn max_words(self) -> usize {
        match self {
            Kind::Comments => 20,
            _ => 25,
        }
    }
}

/// Paragraph of text, with its location. Sentences do not continue after it.
struct Paragraph {
    kind: Kind,
    path: PathBuf,
    line: usize,
    text: String,
}

/// Returns all forms of a phrase with alternative words.
fn written_out(phrase: &str) -> Vec<String> {
    phrase.split(' ').fold(vec![String::new()], |begun, word| {
        let with = |begun: &String, word: &str| [begun, word].join(" ").trim().to_owned();
        let all = (begun.iter()).flat_map(|begun| word.split('/').map(|it| with(begun, it)));
        all.collect()
    })
}

/// Returns the hard phrases and the long sentences in a paragraph.
fn hits(paragraph: &Paragraph, phrases: &HashSet<String>) -> [Vec<String>; 2] {
    let [mut hard, mut long] = [Vec::new(), Vec::new()];
    let text = without_code(&paragraph.text);
    for sentence in text
        .split_inclusive(['.', '!', '?'])
        .fold(Vec::new(), join_within_words)
    {
        let words: Vec<String> = (sentence.split(|it: char| !it.is_alphanumeric() && it != '\''))
            .filter(|word| !word.is_empty())
            .map(str::to_lowercase)
            .collect();
        for length in 1..=3 {
            let found = words.windows(length).map(|words| words.join(" "));
            hard.extend(found.filter(|it| phrases.contains(it)));
        }
        let starts = paragraph.kind != Kind::Messages && words.len() > 2;
        hard.extend(
            words
                .first()
                .filter(|it| starts && STARTS.contains(&it.as_str()))
                .cloned(),
        );
        let count = sentence.split_whitespace().count();
        if count > paragraph.kind.max_words() {
            long.push(format!("{count} words: {}", sentence.trim()));
        }
    }
    [hard, long]
}

/// Adds a piece of text to the list of sentences. Joins it to the last sentence if no space
/// separates them, as in `0.5`.
fn join_within_words(mut sentences: Vec<String>, piece: &str) -> Vec<String> {
    match sentences.last_mut() {
        Some(last) if !piece.starts_with([' ', ')', '"']) => last.push_str(piece),
        _ => sentences.push(piece.to_owned()),
    }
    sentences
}

/// Returns a text with code replaced by one word, and links replaced by their text.
fn without_code(text: &str) -> String {
    let mut plain = String::new();
    for (number, part) in text.split('`').enumerate() {
        plain.push_str(if number % 2 == 0 { part } else { "x" });
    }
    let mut parts = plain.split("](");
    let mut linked = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        linked.push_str(part.split_once(')').map_or(part, |(_, rest)| rest));
    }
    linked
}

/// Returns the paragraphs in these lines. Leaves out fenced blocks, tables and headings.
fn paragraphs(
    kind: Kind,
    path: &Path,
    lines: impl Iterator<Item = (usize, String)>,
) -> Vec<Paragraph> {
    let mut found: Vec<Paragraph> = Vec::new();
    let (mut fenced, mut last) = (false, None);
    for (line, text) in lines {
        let text = text.trim();
        let fence = text.starts_with("```");
        fenced ^= fence;
        if fenced || fence || text.is_empty() || text.starts_with(['|', '#', '<']) {
            last = None;
            continue;
        }
        let continues = last == Some(line - 1) && !text.starts_with(['-', '*', '1']);
        last = Some(line);
        match found.last_mut() {
            Some(paragraph) if continues => {
                paragraph.text.push(' ');
                paragraph.text.push_str(text);
            }
            _ => found.push(Paragraph {
                kind,
                path: path.to_owned(),
                line,
                text: text.to_owned(),
            }),
        }
    }
    found
}

/// Returns the comments and the long strings of a Rust file, as paragraphs.
fn rust_paragraphs(path: &Path, source: &str) -> Vec<Paragraph> {
    let name = path.to_str().unwrap();
    let is_test = name.contains("tests");
    let comments = if name.starts_with("src/command") {
        Kind::Help
    } else {
        Kind::Comments
    };
    let (mut comment_lines, mut strings) = (Vec::new(), Vec::new());
    let mut open: Option<(usize, String)> = None;
    for (line, text) in (1..).zip(source.lines()) {
        let mut rest = text;
        loop {
            if let Some((start, mut string)) = open.take() {
                let end = unescaped_quote(rest);
                string.push_str(
                    rest[..end.unwrap_or(rest.len())]
                        .trim_end_matches('\\')
                        .trim_start(),
                );
                let Some(end) = end else {
                    open = Some((start, string + " "));
                    break;
                };
                strings.push((start, string));
                rest = &rest[end + 1..];
            }
            let quote = rest
                .replace("'\"'", "   ")
                .find('"')
                .filter(|at| !rest[..*at].ends_with(['#', '\\']));
            match (quote, rest.find("//")) {
                (quote, Some(at)) if quote.is_none_or(|quote| at < quote) => {
                    let comment = rest[at..].trim_start_matches(['/', '!']);
                    comment_lines.push((line, comment.to_owned()));
                    break;
                }
                (Some(at), _) => {
                    open = Some((line, String::new()));
                    rest = &rest[at + 1..];
                }
                (None, _) => break,
            }
        }
    }
    let is_message = |text: &str| !is_test && text.len() > 12 && text.contains(' ');
    let messages = strings.into_iter().filter(|(_, text)| is_message(text));
    let messages = messages.map(|(line, text)| Paragraph {
        kind: Kind::Messages,
        path: path.to_owned(),
        line,
        text,
    });
    let mut found = paragraphs(comments, path, comment_lines.into_iter());
    found.extend(messages);
    found
}

/// Returns the position of the quote that ends a string. Returns `None` if there is none.
fn unescaped_quote(text: &str) -> Option<usize> {
    let mut escaped = false;
    text.char_indices().find_map(|(at, character)| {
        let ends = character == '"' && !escaped;
        escaped = character == '\\' && !escaped;
        ends.then_some(at)
    })
}

/// Collects the paragraphs of all files below a folder.
fn texts(folder: &Path, found: &mut Vec<Paragraph>) {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    for path in paths {
        let path = path.strip_prefix(".").unwrap_or(&path).to_owned();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() {
            if !name.starts_with('.')
                && !["target", "corpus", "fixtures", "node_modules", "results"].contains(&name)
            {
                texts(&path, found);
            }
            continue;
        }
        let kind = match path.extension().and_then(|it| it.to_str()) {
            Some("md") => Kind::Documents,
            Some("pyi") => Kind::Help,
            Some("rs") => Kind::Comments,
            _ => continue,
        };
        let text = std::fs::read_to_string(&path).unwrap();
        found.extend(match kind {
            Kind::Comments => rust_paragraphs(&path, &text),
            kind => paragraphs(kind, &path, (1..).zip(text.lines().map(str::to_owned))),
        });
    }
}

/// Returns the largest allowed numbers of hard phrases and of long sentences, for each kind of
/// text.
fn limits() -> BTreeMap<String, [usize; 2]> {
    let text = std::fs::read_to_string(LIMITS).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    rows.map(|row| {
        let [kind, hard, long] = row.split_whitespace().collect::<Vec<_>>()[..] else {
            panic!("{LIMITS}: {row}");
        };
        (
            kind.to_owned(),
            [hard, long].map(|it| it.parse().expect("a number")),
        )
    })
    .collect()
}

#[test]
fn texts_get_no_harder_to_read() {
    let phrases: HashSet<String> = PHRASES.lines().flat_map(written_out).collect();
    let mut all = Vec::new();
    texts(Path::new("."), &mut all);
    let requested = std::env::var_os("STOCHC_PROSE");
    let mut counts: BTreeMap<Kind, [usize; 2]> = BTreeMap::new();
    let mut places = String::new();
    for paragraph in &all {
        let found = hits(paragraph, &phrases);
        let count = counts.entry(paragraph.kind).or_default();
        for (count, found) in count.iter_mut().zip(&found) {
            *count += found.len();
        }
        if requested
            .as_ref()
            .is_some_and(|it| paragraph.path.starts_with(it))
        {
            for what in found.iter().flatten() {
                writeln!(
                    places,
                    "{}:{}: {what}",
                    paragraph.path.display(),
                    paragraph.line
                )
                .unwrap();
            }
        }
    }
    assert!(requested.is_none(), "\n{places}");
    let limits = limits();
    let mut rows =
        "# Largest numbers of hard phrases and of long sentences (prose.rs).\n".to_owned();
    let mut wrong = Vec::new();
    for (kind, count) in counts {
        let kind = format!("{kind:?}").to_lowercase();
        let limit = limits[&kind];
        let lower = [0, 1].map(|at| count[at].min(limit[at]));
        writeln!(rows, "{kind} {} {}", lower[0], lower[1]).unwrap();
        for (what, count, limit) in [
            ("hard phrases", count[0], limit[0]),
            ("long sentences", count[1], limit[1]),
        ] {
            if count > limit {
                wrong.push(format!(
                    "{kind}: {count} {what}, but at most {limit} are allowed"
                ));
            } else if count + 20 + limit / 4 < limit {
                wrong.push(format!(
                    "{kind}: only {count} {what}: lower the limit of {limit}"
                ));
            }
        }
    }
    if std::env::var_os("STOCHC_WRITE_DOCS").is_some() {
        std::fs::write(LIMITS, rows).unwrap();
        return;
    }
    assert!(
        wrong.is_empty(),
        "{}\nSTOCHC_PROSE=PATH lists the places below PATH; STOCHC_WRITE_DOCS=1 lowers the limits",
        wrong.join("\n")
    );
}

#[test]
fn hard_phrases_and_long_sentences_are_found() {
    let phrases: HashSet<String> = PHRASES.lines().flat_map(written_out).collect();
    let source = include_str!("hard_source.txt");
    let found: Vec<_> = (rust_paragraphs(Path::new("a.rs"), source).iter())
        .flat_map(|paragraph| hits(paragraph, &phrases)[0].clone())
        .collect();
    assert_eq!(
        found,
        [
            "nobody",
            "what is",
            "in which",
            "what",
            "go on",
            "so long as"
        ]
    );
    let text = format!(
        "Short. {}end.\n\n| {} |\n",
        "word ".repeat(25),
        "cell ".repeat(30)
    );
    let lines = (1..).zip(text.lines().map(str::to_owned));
    let found = paragraphs(Kind::Documents, Path::new("a.md"), lines);
    let [long] = &hits(&found[0], &phrases)[1][..] else {
        panic!("one long sentence");
    };
    assert!(long.starts_with("26 words: word"), "{long}");
    assert_eq!(found.len(), 1);
}
