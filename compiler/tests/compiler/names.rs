//! Compares the definitions of names with the expanded programs.
use std::cell::Cell;
use std::fmt::Write as _;

use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};
use stochc_compiler::expanded::EventKind;
use stochc_compiler::names::{Definition, NameKind, Names};
use stochc_compiler::source_map::blocks_at;
use stochc_compiler::{Cancellation, Checked, Limits, LintLevels, check_observed};

const NEVER: Cancellation<'static> = Cancellation::NEVER;

fn checked(text: &str) -> Checked {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    // `check_observed` does not try fixes of unused definitions, which saves time.
    let (limits, levels) = (Limits::default(), LintLevels::default());
    check_observed("a.sa", &mut reader, limits, &levels, &mut |_| {})
}

/// Names of numbers. Using few names makes definitions hide each other.
const WORDS: [&str; 3] = ["n", "m", "T"];

/// Turns a list of numbers into a program that uses few names for many things. Most programs are
/// valid.
struct Generator {
    choices: std::vec::IntoIter<u32>,
    text: String,
    /// Names that stand for a number at this point.
    known: Vec<&'static str>,
    patterns: Vec<String>,
}

impl Generator {
    fn choose(&mut self, most: usize) -> usize {
        self.choices
            .next()
            .map_or(0, |choice| choice as usize % most)
    }

    fn write(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push(' ');
    }

    /// Writes a number from 1 on, or an expression.
    fn number(&mut self) -> String {
        let count = self.known.len();
        if count == 0 || self.choose(3) == 0 {
            return (1 + self.choose(2)).to_string();
        }
        let choice = self.choose(count);
        let known = self.known[choice];
        match self.choose(3) {
            0 => format!("{known} + 1"),
            _ => known.to_owned(),
        }
    }

    fn declare(&mut self) {
        let (word, value) = (WORDS[self.choose(2)], self.number());
        self.write(&format!("let {word} = {value}"));
        self.known.push(word);
    }

    fn pattern(&mut self, name: String) {
        let outer = self.known.clone();
        let count = WORDS[self.choose(3)];
        self.write(&format!("pattern {name}(base, {count}, side) {{"));
        self.known.push(count);
        if self.choose(2) == 0 {
            self.declare();
        }
        let (high, wide) = (self.number(), self.number());
        // A parameter may have the same name as a block.
        let block = if count == "T" { "U" } else { "T" };
        self.write(&format!("let h = {high} base.side ->> {block}[1..h]"));
        if self.choose(2) == 0 {
            let counter = WORDS[self.choose(2)];
            self.write(&format!(
                "for {counter} in 1..1 {{ {block}[{counter}].east -> V[{wide}] }}"
            ));
        }
        if let (Some(inner), 0) = (self.patterns.last().cloned(), self.choose(2)) {
            let size = self.number();
            let alias = ["", " as l", " as base_of"][self.choose(3)];
            self.write(&format!("{inner}({block}[h], {size}, side){alias}"));
        }
        self.write("}");
        self.known = outer;
        self.patterns.push(name);
    }

    fn assembly(&mut self, name: &str) {
        let (outer, patterns) = (self.known.clone(), self.patterns.len());
        self.write(&format!("assembly {name} {{"));
        if self.choose(2) == 0 {
            self.declare();
        }
        if self.choose(3) == 0 {
            self.pattern(format!("own_{name}"));
        }
        let counter = WORDS[self.choose(2)];
        self.write(&format!(
            "seed plate 40 x 1 {{ for {counter} in 0..9 {{ A[{counter}] at (4 * {counter}, 0) }} }}"
        ));
        self.write("phase first {");
        if self.choose(2) == 0 {
            self.declare();
        }
        for number in 0..self.choose(5) {
            let pattern = self.choose(self.patterns.len());
            let (pattern, size) = (self.patterns[pattern].clone(), self.number());
            let alias = ["l", "T", "n"][self.choose(3)];
            match self.choose(3) {
                0 => self.write(&format!("{pattern}(A[{number}], {size}, up)")),
                1 => self.write(&format!(
                    "{pattern}(A[{number}], {size}, up) as {alias}[{number}]"
                )),
                _ => {
                    let counter = WORDS[self.choose(2)];
                    self.write(&format!(
                        "for {counter} in {number}..{number} {{ {pattern}(A[{counter}], {size}, up) as l[{counter}] }}"
                    ));
                }
            }
        }
        self.write("A[9].up -> T }");
        self.write("phase second { T.up -> U");
        for number in 0..self.choose(4) {
            let word = ["T", "U"][self.choose(2)];
            self.write(&format!("l[{number}].{word}[1].west -> W[{number}]"));
        }
        self.write("} }\n");
        self.known = outer;
        self.patterns.truncate(patterns);
    }
}

fn program(choices: Vec<u32>) -> String {
    let mut generator = Generator {
        choices: choices.into_iter(),
        text: String::new(),
        known: Vec::new(),
        patterns: Vec::new(),
    };
    for _ in 0..generator.choose(3) {
        generator.declare();
    }
    for number in 0..=generator.choose(3) {
        generator.pattern(format!("p{number}"));
    }
    generator.assembly("a");
    if generator.choose(2) == 0 {
        generator.assembly("b");
    }
    generator.text
}

/// Describes everything that a program does, without its names.
fn structure(checked: &Checked) -> String {
    let mut shown = String::new();
    for program in &checked.programs {
        for event in &program.plan.events {
            let _ = match event.kind {
                EventKind::Capture { parent, face } => write!(shown, "{}.{face}", parent.0),
                EventKind::Release => write!(shown, "-"),
            };
            let _ = write!(shown, "{} ", event.role.0);
        }
        let _ = writeln!(shown, "{:?}", program.layout.cells);
    }
    shown
}

/// Renames a definition and its uses in a text.
fn renamed(text: &str, names: &Names, definition: Definition, name: &str) -> String {
    let mut renamed = String::new();
    let mut done = 0;
    for occurrence in names.occurrences_of(definition) {
        let span = occurrence.location.span;
        renamed.push_str(&text[done..span.start as usize]);
        renamed.push_str(name);
        done = span.end as usize;
    }
    renamed + &text[done..]
}

/// Runs a test for many programs without errors.
fn for_programs(test: impl Fn(&str, &Checked, &Names) -> Result<usize, TestCaseError>) {
    let config = ProptestConfig {
        cases: 200,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let random = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let mut runner = TestRunner::new_with_rng(config, random);
    let (right, compared) = (Cell::new(0), Cell::new(0));
    let done = runner.run(&prop::collection::vec(any::<u32>(), 0..80), |choices| {
        let text = program(choices);
        let checked = checked(&text);
        if checked.has_errors() {
            return Ok(());
        }
        let names = Names::new(&checked, NEVER).unwrap();
        right.set(right.get() + 1);
        compared.set(compared.get() + test(&text, &checked, &names)?);
        Ok(())
    });
    done.unwrap();
    let (right, compared) = (right.get(), compared.get());
    println!("{right} programs are right, {compared} names compared");
    assert!(right > 60 && compared > 10 * right, "{right}, {compared}");
}

#[test]
fn names_do_not_affect_the_result() {
    for_programs(|text, checked_before, names| {
        let before = structure(checked_before);
        let mut definitions: Vec<Definition> =
            names.all().iter().map(|name| name.definition).collect();
        definitions.sort_unstable();
        definitions.dedup();
        let count = definitions.len();
        for definition in definitions {
            // Built-in things cannot be renamed.
            if !names.occurrences_of(definition).any(|name| name.declares) {
                continue;
            }
            let text = renamed(text, names, definition, "fresh");
            let after = checked(&text);
            prop_assert!(!after.has_errors(), "{text}\n{:#?}", after.diagnostics);
            prop_assert_eq!(&before, &structure(&after), "{}", text);
        }
        Ok(count)
    });
}

#[test]
fn a_name_expands_to_its_blocks() {
    for_programs(|text, checked, names| {
        let mut count = 0;
        // Each block belongs to exactly one definition, whose name is the stem of the block's name.
        let mut definitions = std::collections::BTreeMap::new();
        for name in names.all() {
            let kind = names.kind(name.definition);
            let place = (name.location.file, name.location.span.start);
            let located = blocks_at(checked, place, Limits::default(), NEVER).unwrap();
            let word = checked.symbols.word(names.word(name.definition));
            for located in located {
                let plan = &checked.programs[located.program].plan;
                for role in located.roles {
                    let block = plan.roles.name(role, &checked.symbols);
                    let stem = block.rsplit('.').next().unwrap_or_default();
                    match kind {
                        NameKind::Block => {
                            prop_assert_eq!(stem.split('[').next(), Some(word), "{}", text);
                            let known = definitions
                                .entry((located.program, role))
                                .or_insert(name.definition);
                            prop_assert_eq!(*known, name.definition, "{} of {}", block, text);
                            count += 1;
                        }
                        // A parameter stands for the block of its argument.
                        NameKind::Parameter => count += 1,
                        kind => prop_assert!(false, "{kind:?} `{word}` stands for {block}: {text}"),
                    }
                }
            }
        }
        Ok(count)
    });
}
