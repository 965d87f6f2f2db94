//! Reads arbitrary bytes as a journal. Valid runs must belong to the manifest, and each must occur
//! only once. All other content must be reported.
//!
//! If the first byte is even, the rest is a whole file. Otherwise it consists of lines without
//! checksums, which are added.
use std::sync::LazyLock;

use stochc_files::checksum::sealed;
use stochc_results::Folder;

static PLACE: LazyLock<(tempfile::TempDir, String)> = LazyLock::new(super::folder);

/// Reads an input as a journal. Panics if the result is wrong.
pub fn read(bytes: &[u8]) {
    let Some((how, bytes)) = bytes.split_first() else {
        return;
    };
    let (folder, identity) = &*PLACE;
    let journal = match how % 2 {
        0 => bytes.to_vec(),
        _ => {
            let header = sealed(format!("{{\"ensemble\":\"{identity}\",\"journal\":1}}"));
            let text = String::from_utf8_lossy(bytes);
            let lines = text.lines().map(|line| {
                if line.ends_with('}') {
                    sealed(line.to_owned()) + "\n"
                } else {
                    line.to_owned() + "\n"
                }
            });
            (header + "\n" + &lines.collect::<String>()).into_bytes()
        }
    };
    std::fs::write(folder.path().join("journal.jsonl"), journal).expect("it can be written");
    let Ok(contents) = Folder::read(folder.path()) else {
        return;
    };
    let finished = contents.finished.to_vec().expect("it is read once more");
    let keys: Vec<_> = contents.finished.keys().collect();
    assert!(keys.is_sorted_by(|a, b| a < b));
    assert!(keys.iter().all(|&(program, run)| program == 0 && run < 3));
    assert!(finished.iter().all(|it| it.record.ticks <= 1000));
}
