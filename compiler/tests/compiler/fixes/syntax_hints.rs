//! Random mistakes: checks that `--fix` never makes a program worse and applies every safe fix.
use std::collections::BTreeMap;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestCaseError, TestRunner};
use stochc_compiler::Checked;
use stochc_compiler::diagnostic::Code;

use super::{apply_fixes, checked};
use crate::random::declare;

/// Number of mistakes. They are the same in every run.
const SLIPS: u32 = 20_000;

/// Returns the first and last byte of every word, number and character outside of comments.
fn tokens(text: &str) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let rest = &bytes[at..];
        let count = |of: &dyn Fn(&u8) -> bool| rest.iter().take_while(|&byte| of(byte)).count();
        if rest.starts_with(b"//") {
            at += count(&|&byte| byte != b'\n');
            continue;
        }
        let signs: [&[u8]; 3] = [b"->>", b"->", b".."];
        let length = match signs.iter().find(|sign| rest.starts_with(sign)) {
            Some(sign) => sign.len(),
            None if is_word(&byte) => count(&is_word),
            None if byte.is_ascii() => 1,
            None => count(&|byte| !byte.is_ascii()),
        };
        if !byte.is_ascii_whitespace() {
            tokens.push((at, at + length));
        }
        at += length;
    }
    tokens
}

/// A mistake in one token.
#[derive(Clone, Copy, Debug)]
enum Slip {
    Deleted,
    Doubled,
    Swapped,
    Misspelt { letter: usize, how: u8 },
}

/// Returns a text with a mistake in one token.
fn slipped(text: &str, token: usize, slip: Slip) -> String {
    let tokens = tokens(text);
    let (start, end) = tokens[token];
    let (before, word, after) = (&text[..start], &text[start..end], &text[end..]);
    match slip {
        Slip::Deleted => format!("{before}{after}"),
        Slip::Doubled => format!("{before}{word} {word}{after}"),
        Slip::Swapped => match tokens.get(token + 1) {
            Some(&(next, last)) => {
                let (between, other) = (&text[end..next], &text[next..last]);
                format!("{before}{other}{between}{word}{}", &text[last..])
            }
            None => text.to_owned(),
        },
        Slip::Misspelt { letter, how } => {
            let mut letters: Vec<char> = word.chars().collect();
            let at = letter % letters.len();
            match how % 4 {
                0 => drop(letters.remove(at)),
                1 => letters.insert(at, letters[at]),
                2 if at + 1 < letters.len() => letters.swap(at, at + 1),
                2 => letters.push('e'),
                _ => letters[at] = char::from(b'a' + (letter / 7 % 26) as u8),
            }
            let word: String = letters.into_iter().collect();
            format!("{before}{word}{after}")
        }
    }
}

/// Returns all programs of the examples and fixtures, and the valid programs of the pages.
fn programs() -> Vec<String> {
    let mut programs: Vec<String> = ["examples", "tests/fixtures", "tests/verification"]
        .map(|folder| format!("../{folder}"))
        .into_iter()
        .flat_map(|folder| std::fs::read_dir(folder).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "sa"))
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect();
    // The order of a directory is not defined.
    programs.sort();
    let pages = Code::ALL.iter().filter_map(|code| {
        let (_, right) = code.page().split_once("Right:\n\n```sa\n")?;
        Some(right.split("```").next()?.to_owned())
    });
    programs.extend(pages);
    programs
}

/// Counts the errors of each code.
fn errors(checked: &Checked) -> BTreeMap<Code, usize> {
    let mut errors = BTreeMap::new();
    for diagnostic in checked.diagnostics.iter().filter(|it| it.is_error()) {
        *errors.entry(diagnostic.code).or_default() += 1;
    }
    errors
}

/// Checks that `--fix` makes a text no worse. Returns whether it has changed the text.
fn only_betters(wrong: &str) -> Result<bool, TestCaseError> {
    let once = apply_fixes(wrong);
    let left = checked(&once.text);
    if once.changes == 0 {
        prop_assert_eq!(&*once.text, wrong);
    } else {
        let before = errors(&once.before);
        for (code, count) in errors(&left) {
            let known = before.get(&code).copied().unwrap_or_default();
            prop_assert!(
                count <= known,
                "{code} comes of\n{wrong}\nto\n{}",
                once.text
            );
        }
        let size = |checked: &Checked| {
            (
                errors(checked).values().sum::<usize>(),
                checked.diagnostics.len(),
            )
        };
        prop_assert!(size(&left) < size(&once.before));
        prop_assert_eq!(
            apply_fixes(&once.text).changes,
            0,
            "{}\nto\n{}",
            wrong,
            once.text
        );
    }
    let is_safe = |fix: &stochc_compiler::diagnostic::Fix| fix.safe;
    let has_left = left
        .diagnostics
        .iter()
        .any(|it| it.fix.as_ref().is_some_and(is_safe));
    prop_assert!(!has_left, "a safe fix is left in\n{}", once.text);
    Ok(once.changes > 0)
}

#[test]
fn any_typo_is_fixed_or_left_alone() {
    let programs = programs();
    let slip = (0u8..4, any::<usize>(), any::<u8>()).prop_map(|(kind, letter, how)| match kind {
        0 => Slip::Deleted,
        1 => Slip::Doubled,
        2 => Slip::Swapped,
        _ => Slip::Misspelt { letter, how },
    });
    let choices = prop::collection::vec(any::<u32>(), 0..80);
    let which = 0..programs.len() * 5 / 4;
    let cases_of = (which, choices, any::<prop::sample::Index>(), slip);
    let config = Config {
        cases: SLIPS,
        failure_persistence: None,
        ..Config::default()
    };
    let mut runner = TestRunner::new_with_rng(
        config,
        prop::test_runner::TestRng::deterministic_rng(prop::test_runner::RngAlgorithm::ChaCha),
    );
    let fixed = std::cell::Cell::new(0u32);
    let outcome = runner.run(&cases_of, |(which, choices, token, slip)| {
        let text = match programs.get(which) {
            Some(text) => text.clone(),
            None => declare(choices, 1).text,
        };
        let wrong = slipped(&text, token.index(tokens(&text).len()), slip);
        fixed.set(fixed.get() + u32::from(only_betters(&wrong)?));
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
    // Most mistakes are ambiguous, but some are not.
    println!("{} of {SLIPS} slips are fixed", fixed.get());
    assert!(fixed.get() > SLIPS / 50);
}

/// Returns the positions of a brace in a text, outside of comments.
fn braces(text: &str, brace: &str) -> Vec<usize> {
    let starts = tokens(text).into_iter().map(|(start, _)| start);
    starts
        .filter(|&start| text[start..].starts_with(brace))
        .collect()
}

#[test]
fn a_missing_opening_brace_is_the_only_diagnostic() {
    const HEADS: [&str; 8] = [
        "assembly", "seed", "phase", "for", "pattern", "scene", "shape", "layer",
    ];
    let without_blanks = |text: &str| -> String { text.split_whitespace().collect() };
    let mut tried = 0;
    for right in programs() {
        if checked(&right)
            .diagnostics
            .iter()
            .any(|it| it.fix.is_some() || it.is_error())
        {
            continue;
        }
        for at in braces(&right, "{") {
            let line = &right[right[..at].rfind(['\n', '{', '}']).map_or(0, |at| at + 1)..];
            let head = line.split_whitespace().next().unwrap_or_default();
            let follows = right[at + 1..].trim_start();
            // An empty block has no hint, and the header of a one-line scene contains words.
            let is_plain = !follows.starts_with('}') && !follows.starts_with("//");
            let is_scene_line =
                head == "scene" && !right[at + 1..].trim_start_matches(' ').starts_with('\n');
            if !HEADS.contains(&head) || !is_plain || is_scene_line {
                continue;
            }
            tried += 1;
            let wrong = format!("{}{}", &right[..at], &right[at + 1..]);
            let found = checked(&wrong).diagnostics;
            let codes: Vec<Code> = found
                .iter()
                .filter(|it| it.is_error())
                .map(|it| it.code)
                .collect();
            assert_eq!(codes, [Code::MissingBrace], "{wrong}");
            let fixed = apply_fixes(&wrong).text;
            assert_eq!(without_blanks(&fixed), without_blanks(&right), "{wrong}");
        }
    }
    assert!(tried > 300, "{tried}");
}

#[test]
fn an_extra_closing_brace_is_the_only_diagnostic() {
    for right in programs() {
        if checked(&right).has_errors() {
            continue;
        }
        for at in braces(&right, "}") {
            let wrong = format!("{} }}{}", &right[..at], &right[at..]);
            let codes: Vec<Code> = checked(&wrong)
                .diagnostics
                .iter()
                .map(|it| it.code)
                .collect();
            let errors = checked(&wrong)
                .diagnostics
                .into_iter()
                .filter(|it| it.is_error());
            assert_eq!(errors.count(), 1, "{codes:?} in\n{wrong}");
            assert!(codes.contains(&Code::StrayBrace), "{codes:?} in\n{wrong}");
        }
    }
}
