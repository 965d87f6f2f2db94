//! Tokens of a program by its pest grammar, with their kinds.
use pest::Parser as _;
use pest::iterators::Pair;

#[derive(pest_derive::Parser)]
#[grammar = "../../../grammar/src/sa.pest"]
struct SaParser;

const FACES: [&str; 6] = ["up", "down", "north", "south", "east", "west"];

/// A token: its first byte, its end, and a key of `scopes.json`.
pub type Token = (usize, usize, &'static str);

/// A program that pest accepts.
pub struct Program {
    /// Tokens and comments in order.
    pub tokens: Vec<Token>,
    /// Whether a keyword stands in the place of a name. The compiler rejects such a program.
    pub has_reserved_name: bool,
}

/// Parses a program. Returns `None` if pest rejects it.
pub fn parse(text: &str) -> Option<Program> {
    let pairs = SaParser::parse(Rule::program, text).ok()?;
    let mut program = Program {
        tokens: Vec::new(),
        has_reserved_name: false,
    };
    for pair in pairs {
        program.add(pair, Rule::program, 0);
    }
    let mut at = 0;
    let mut comments = Vec::new();
    for &(start, end, _) in program.tokens.iter().chain([&(text.len(), text.len(), "")]) {
        for (offset, line) in lines(&text[at..start]) {
            if let Some(slashes) = line.find("//") {
                let begin = at + offset + slashes;
                comments.push((begin, at + offset + line.len(), "comment"));
            }
        }
        at = end;
    }
    program.tokens.extend(comments);
    program.tokens.sort_unstable();
    Some(program)
}

fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut at = 0;
    text.split('\n').map(move |line| {
        let start = at;
        at += line.len() + 1;
        (start, line)
    })
}

impl Program {
    /// Adds the tokens of a rule. `parent` is the rule around it, `index` its number in that rule.
    fn add(&mut self, pair: Pair<'_, Rule>, parent: Rule, index: usize) {
        let rule = pair.as_rule();
        // The name of a phase is a place.
        let outer = if parent == Rule::phase_head && rule == Rule::place {
            parent
        } else if rule == Rule::expected_event && pair.as_str().starts_with("phase") {
            Rule::phase_head
        } else {
            rule
        };
        let span = pair.as_span();
        let text = pair.as_str();
        let mut parts = pair.into_inner().peekable();
        if parts.peek().is_some() {
            let mut index = 0;
            while let Some(part) = parts.next() {
                let is_called = |next: &Pair<'_, Rule>| next.as_rule() == Rule::arguments;
                let is_function =
                    part.as_rule() == Rule::name && parts.peek().is_some_and(is_called);
                let parent = if is_function { Rule::arguments } else { outer };
                self.add(part, parent, index);
                index += 1;
            }
            return;
        }
        let kind = match rule {
            Rule::EOI => return,
            Rule::name => match parent {
                Rule::place if index > 0 && FACES.contains(&text) => "face",
                Rule::expr | Rule::condition if FACES.contains(&text) => "face",
                Rule::assembly_head | Rule::aggregate | Rule::scene_head | Rule::shape_head => {
                    "type"
                }
                Rule::yields | Rule::phase_head | Rule::expected_faster => "type",
                Rule::pattern_head if index == 1 => "function",
                Rule::instance | Rule::arguments => "function",
                _ => "name",
            },
            Rule::word => "word",
            Rule::integer | Rule::number | Rule::unit_power => "number",
            Rule::unit_symbol => "unit",
            Rule::string => "string",
            Rule::doc => "doc",
            Rule::code => "code",
            Rule::row => "row",
            Rule::arrow
            | Rule::relation
            | Rule::operator
            | Rule::minus
            | Rule::equals
            | Rule::times
            | Rule::dots => "operator",
            Rule::condition_operator if matches!(text.trim(), "and" | "or") => "keyword",
            Rule::condition_operator => "operator",
            Rule::unit_operator if text.trim().is_empty() => return,
            Rule::unit_operator => "operator",
            Rule::comma => "delimiter",
            Rule::open | Rule::close | Rule::paren_open | Rule::paren_close => "bracket",
            Rule::bracket_open | Rule::bracket_close => "bracket",
            _ => "keyword",
        };
        self.has_reserved_name |=
            matches!(rule, Rule::name | Rule::code) && kind != "face" && is_reserved(text);
        let blanks = text.len() - text.trim_start().len();
        let start = span.start() + blanks;
        self.tokens.push((start, start + text.trim().len(), kind));
    }
}

/// Returns whether a word is a keyword or a face.
fn is_reserved(word: &str) -> bool {
    const KEYWORDS: [&str; 27] = [
        "after",
        "aggregate",
        "as",
        "assembly",
        "at",
        "expect",
        "for",
        "from",
        "import",
        "in",
        "layer",
        "let",
        "mirrored",
        "on",
        "pattern",
        "phase",
        "plate",
        "release",
        "retry",
        "scene",
        "seed",
        "shape",
        "timeout",
        "to",
        "turned",
        "wait",
        "yields",
    ];
    KEYWORDS.contains(&word) || FACES.contains(&word)
}
