//! Tests that all inputs of the fuzzing corpus are handled.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

#[path = "../../fuzz/src/lib.rs"]
mod files;

/// Returns the files in a folder of the corpus.
fn corpus(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(format!("fuzz/corpus/{folder}")).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

/// Function that reads an input. It panics if the result is inconsistent.
type Reader = fn(&[u8]);

/// Folders of the corpus, each with the function that reads its inputs.
const READERS: [(&str, Reader); 8] = [
    ("check", files::check::read),
    ("checkpoint", files::checkpoint::read),
    ("executable", files::executable::read),
    ("journal", files::journal::read),
    ("manifest", |bytes| {
        files::manifest::read(&String::from_utf8_lossy(bytes));
    }),
    ("parse", |bytes| {
        files::parse::read(&String::from_utf8_lossy(bytes));
    }),
    ("recording", files::recording::read),
    ("voxels", files::voxels::read),
];

/// Returns whether a folder contains programs, whose checks take long.
fn is_of_programs(folder: &str) -> bool {
    ["check", "parse"].contains(&folder)
}

/// Lock that makes the tests of this file run one after the other. They share folders.
static TURN: Mutex<()> = Mutex::new(());

#[test]
fn every_corpus_file_is_read_or_rejected() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    for (folder, read) in READERS {
        let paths = corpus(folder);
        assert!(!paths.is_empty(), "{folder}");
        for path in paths {
            read(&std::fs::read(path).unwrap());
        }
    }
}

/// Generator of reproducible numbers (Knuth's linear congruential generator).
struct Numbers(u64);

impl Numbers {
    /// Returns a number from 0 to `end - 1`.
    fn below(&mut self, end: usize) -> usize {
        let (a, c) = (6_364_136_223_846_793_005, 1_442_695_040_888_963_407);
        self.0 = self.0.wrapping_mul(a).wrapping_add(c);
        ((self.0 >> 33) % end.max(1) as u64) as usize
    }
}

/// Returns a file with a few random changes. A change flips a bit, replaces a byte or number, or
/// removes, moves or doubles a part.
fn changed(bytes: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    const EXTREME: [&str; 6] = [
        "0",
        "-1",
        "1e308",
        "18446744073709551615",
        "4294967295",
        "null",
    ];
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + numbers.below(3) {
        let at = numbers.below(bytes.len());
        let end = (at + 1 + numbers.below(40)).min(bytes.len());
        let stretch = bytes.get(at..end).unwrap_or_default().to_vec();
        match numbers.below(6) {
            0 => bytes
                .iter_mut()
                .skip(at)
                .take(1)
                .for_each(|byte| *byte ^= 1 << numbers.below(8)),
            1 => bytes
                .iter_mut()
                .skip(at)
                .take(1)
                .for_each(|byte| *byte = numbers.below(256) as u8),
            2 => drop(bytes.drain(at..end)),
            3 => drop(bytes.splice(at..at, stretch)),
            4 => {
                let to = numbers.below(bytes.len());
                drop(bytes.splice(to..to, stretch));
            }
            _ => {
                let is_digit = |byte: &u8| byte.is_ascii_digit();
                let start = bytes
                    .iter()
                    .skip(at)
                    .position(is_digit)
                    .map_or(at, |it| at + it);
                let digits = bytes[start..]
                    .iter()
                    .take_while(|byte| is_digit(byte))
                    .count();
                let number = EXTREME[numbers.below(EXTREME.len())];
                drop(bytes.splice(start..start + digits, number.bytes()));
            }
        }
    }
    bytes
}

/// Checks inputs of the corpus after random changes. `STOCHC_CHANGES` is the number of changes of
/// each kind. docs/validation/stability.md reports a longer run.
#[test]
fn mutated_files_are_read_or_rejected() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let changes = std::env::var("STOCHC_CHANGES");
    let changes: u64 = changes.map_or(2_000, |text| text.parse().unwrap());
    for (folder, read) in READERS {
        let corpus_files: Vec<Vec<u8>> = (corpus(folder).iter())
            .map(|path| std::fs::read(path).unwrap())
            .collect();
        let changes = if is_of_programs(folder) {
            changes / 10
        } else {
            changes
        };
        for seed in 0..changes {
            let mut numbers = Numbers(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            numbers.below(1);
            let bytes = changed(
                &corpus_files[numbers.below(corpus_files.len())],
                &mut numbers,
            );
            let outcome = std::panic::catch_unwind(|| read(&bytes));
            assert!(outcome.is_ok(), "{folder}, change {seed}");
        }
    }
}
