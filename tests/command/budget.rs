//! Tests files that claim excessive sizes. They are read with little memory:
//! docs/reference/limits.md.
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use stochc_files::checksum::crc32;

use crate::stochc::{stochc_with, unfolded};

/// Limit on the address space of a command \[KiB\].
const SPACE: u32 = 2 << 20;

const TIB: u64 = 1 << 40;
const MIB: usize = 1 << 20;

/// Runs a command that must reject a file within its limit of address space. Returns the messages.
#[track_caller]
fn refused(arguments: &[&str]) -> String {
    let program = format!("ulimit -v {SPACE}; exec \"$@\"");
    let output = Command::new("sh")
        .args(["-c", &program, "sh", env!("CARGO_BIN_EXE_stochc")])
        .args(arguments)
        .output()
        .unwrap();
    let outcome =
        String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        output.status.code(),
        Some(2),
        "{:?}: {outcome}",
        output.status
    );
    outcome
}

/// Results folder with a recording.
struct Results {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl Results {
    fn new() -> Results {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results");
        let line =
            "simulate --quiet --runs 1 --max-ticks 50 --record 0 tests/fixtures/dense.sa --out";
        let outcome = stochc_with(line, &[path.to_str().unwrap()]);
        assert_eq!(outcome.status, 3, "{}", outcome.err);
        let _folder = folder;
        Results { _folder, path }
    }

    fn text(&self) -> &str {
        self.path.to_str().unwrap()
    }

    /// Replaces a file by a sparse file with this beginning and length. Returns the messages of
    /// `show` and `fsck`.
    #[track_caller]
    fn with(&self, name: &str, begins: &str, length: u64) -> [String; 2] {
        let file = self.path.join(name);
        let whole = fs::read(&file).unwrap();
        sparse(&file, begins, length);
        let outcome = ["show", "fsck"].map(|command| refused(&[command, self.text()]));
        fs::write(&file, whole).unwrap();
        outcome
    }
}

/// Writes a sparse file with this beginning and length.
fn sparse(path: &Path, begins: &str, length: u64) {
    let mut file = File::create(path).unwrap();
    file.write_all(begins.as_bytes()).unwrap();
    file.set_len(length).unwrap();
}

#[test]
fn an_endless_journal_is_rejected() {
    let results = Results::new();
    let journal = fs::read_to_string(results.path.join("journal.jsonl")).unwrap();
    let header = journal.lines().next().unwrap().to_owned() + "\n";
    for (begins, length, expected) in [
        (&*header, TIB, "256 GiB or more"),
        ("", TIB, "256 GiB or more"),
        (&*header, TIB / 10, "a line of 65 MiB or more"),
        ("", TIB / 10, "a line of 65 MiB or more"),
    ] {
        for outcome in results.with("journal.jsonl", begins, length) {
            assert!(outcome.contains(expected), "{outcome}");
        }
    }
    // The line consists of characters that can occur in a record.
    let line = format!(
        "{header}{{\"program\":0,\"record\":{{\"run\":0,\"phase_ticks\":[{}",
        "0,".repeat(40 * MIB)
    );
    for outcome in results.with("journal.jsonl", &line, line.len() as u64) {
        assert!(outcome.contains("a line of 65 MiB or more"), "{outcome}");
    }
}

#[test]
fn a_manifest_beyond_its_limit_is_rejected() {
    let results = Results::new();
    let manifest = results.path.join("manifest.json");
    for outcome in results.with("manifest.json", "{", 3 << 30) {
        assert!(outcome.contains("it has a hole"), "{outcome}");
    }
    for outcome in results.with("manifest.json", "{", TIB) {
        assert!(outcome.contains("it has 4 GiB or more"), "{outcome}");
    }
    for length in [1 << 23, TIB] {
        let file = results.path.join("checksums.json");
        let whole = fs::read(&file).unwrap();
        sparse(&file, "{", length);
        assert!(refused(&["fsck", results.text()]).contains("checksums.json"));
        fs::write(&file, whole).unwrap();
    }
    let text = fs::read_to_string(&manifest).unwrap();
    for runs in ["1000000000000000000", "18446744073709551615"] {
        fs::write(
            &manifest,
            text.replace("\"runs\": 1,", &format!("\"runs\": {runs},")),
        )
        .unwrap();
        let path = manifest.to_str().unwrap();
        let _ = fs::remove_file(results.path.join("checksums.json"));
        for arguments in [
            &["show", results.text()][..],
            &["fsck", results.text()],
            &["report", results.text()],
            &["replay", "--run", "0", results.text()],
            &["repeat", path],
        ] {
            let outcome = refused(arguments);
            assert!(
                outcome.contains(runs) && outcome.contains("10000000"),
                "{outcome}"
            );
        }
    }
}

#[test]
fn other_files_beyond_their_limits_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    let path = file.to_str().unwrap();
    let executable = "{\"kind\":\"stochc executable\",\"format\":1,\"programs\":[";
    for (begins, length, arguments, expected) in [
        (executable, 3 << 30, &["simulate"][..], "it has a hole"),
        (executable, TIB, &["simulate"], "it has 4 GiB or more"),
        ("{", 3 << 30, &["repeat"], "it has a hole"),
        ("assembly", TIB, &["check"], "it has 4 GiB or more"),
        ("", TIB, &["simulate"], "it has 4 GiB or more"),
        (
            "program,ticks\n",
            TIB,
            &[
                "fit",
                "tests/fixtures/tower.sa",
                "--vary",
                "free=5..9",
                "--data",
            ],
            "it has 256 MiB or more",
        ),
    ] {
        sparse(&file, begins, length);
        let outcome = refused(&[arguments, &[path]].concat());
        assert!(unfolded(&outcome).contains(expected), "{outcome}");
    }
}

/// Returns a section of a recording, with its checksum.
fn part(tag: &[u8; 4], payload: &[u8]) -> Vec<u8> {
    let length = (payload.len() as u32).to_le_bytes();
    let part = [&tag[..], &length, payload].concat();
    let crc = crc32(&part).to_le_bytes();
    [&part[..], &crc].concat()
}

/// Returns compressed data that consist of a repeated pattern.
fn packed(begins: &str, pattern: &[u8], times: usize) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(begins.as_bytes()).unwrap();
    let many = pattern.repeat(MIB / pattern.len());
    for _ in 0..times * pattern.len() / many.len() {
        encoder.write_all(&many).unwrap();
    }
    encoder.finish().unwrap()
}

#[test]
fn a_recording_that_unpacks_to_gigabytes_is_rejected() {
    let results = Results::new();
    let file = results.path.join("recordings/0-0.rec");
    let whole = fs::read(&file).unwrap();
    let length = u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
    let header = String::from_utf8(whole[16..16 + length].to_vec()).unwrap();
    let header = |bodies: u32| {
        let (before, after) = header.split_once("\"bodies\":").unwrap();
        let after = after.trim_start_matches(|c: char| c.is_ascii_digit());
        let json = format!("{before}\"bodies\":{bodies}{after}");
        let begin = [
            &whole[..12],
            &(json.len() as u32).to_le_bytes(),
            json.as_bytes(),
        ]
        .concat();
        let crc = crc32(&begin).to_le_bytes();
        [&begin[..], &crc].concat()
    };
    // Returns positions with all blocks at one place, for `ticks` ticks.
    let places = |bodies: usize, ticks: u32| {
        let mut payload = [&0u64.to_le_bytes()[..], &ticks.to_le_bytes(), &[0; 4]].concat();
        payload.extend(
            [0.0f64, 0.0, 0.0, 1.0]
                .into_iter()
                .flat_map(f64::to_le_bytes),
        );
        payload.extend((0..ticks).flat_map(u32::to_le_bytes));
        payload.extend(packed("", &[0; 14], bodies * ticks as usize));
        part(b"POSE", &payload)
    };
    let bodies = MIB / 14 * 14;
    let valid = places(bodies, 16);
    let events = |begins: &str, row: &[u8], times| part(b"EVNT", &packed(begins, row, times));
    let huge = 300 * MIB;
    for (name, parts) in [
        ("places, ten times", vec![valid.clone(); 10]),
        ("places beyond the budget", vec![places(bodies, 40)]),
        ("places that are claimed", vec![part(b"POSE", &[0xff; 100])]),
        ("empty events", vec![events("[", b"[],", 80 * MIB)]),
        (
            "an event without an end",
            vec![events("[[", b"[],", 80 * MIB)],
        ),
        (
            "many events",
            vec![events("[[0,\"report\",0],", b"[0,\"report\",0],", 8 * MIB); 8],
        ),
        ("events beyond the budget", vec![events("[", b"[],", huge)]),
        (
            "a record",
            vec![part(
                b"DONE",
                &packed("{\"run\":0,\"phase_ticks\":[", b"0,", 30 * MIB),
            )],
        ),
        (
            "a record beyond the budget",
            vec![part(
                b"DONE",
                &packed("{\"run\":0,\"phase_ticks\":[", b"0,", huge),
            )],
        ),
    ] {
        let bytes = [header(bodies as u32), parts.concat()].concat();
        assert!(bytes.len() < 5 * MIB, "{name}: {}", bytes.len());
        fs::write(&file, bytes).unwrap();
        for command in [&["replay", "--run", "0"][..], &["fsck"]] {
            let outcome = refused(&[command, &[results.text()]].concat());
            assert!(
                outcome.contains("damaged") || outcome.contains("truncated"),
                "{name}: {outcome}"
            );
        }
    }
    // The header and a section claim lengths that are holes in the sparse file.
    let mut claims = whole[..16].to_vec();
    claims[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    let part = [header(1), b"DONE".to_vec(), u32::MAX.to_le_bytes().to_vec()].concat();
    for (begin, length) in [(claims, 5 << 30), (part.clone(), 5 << 30), (part, TIB)] {
        fs::write(&file, begin).unwrap();
        File::options()
            .write(true)
            .open(&file)
            .unwrap()
            .set_len(length)
            .unwrap();
        for command in [&["replay", "--run", "0"][..], &["fsck"]] {
            refused(&[command, &[results.text()]].concat());
        }
    }
    fs::write(&file, whole).unwrap();
    assert_eq!(stochc_with("fsck", &[results.text()]).status, 0);
}
