//! Any bytes are read as a journal: what is sound is a run that the manifest allows, each once, and all else is told.
//!
//! The first byte says whether the bytes are the whole file, lines of one without checksums, or lines that get theirs.
use std::path::PathBuf;
use std::sync::LazyLock;

use stochc_ensemble::{Folder, Manifest};
use stochc_files::checksum::sealed;

struct Place {
    _folder: tempfile::TempDir,
    path: PathBuf,
    identity: String,
}

static PLACE: LazyLock<Place> = LazyLock::new(|| {
    let memory = PathBuf::from("/dev/shm");
    let above = if memory.is_dir() {
        memory
    } else {
        std::env::temp_dir()
    };
    let folder = tempfile::tempdir_in(above).expect("a folder can be made");
    let path = folder.path().to_owned();
    let manifest: Manifest = super::ensemble();
    std::fs::write(path.join("manifest.json"), manifest.to_json()).expect("it can be written");
    Place {
        _folder: folder,
        path,
        identity: manifest.identity(),
    }
});

/// Reads an input, and panics where something is wrong with what comes of it.
pub fn read(bytes: &[u8]) {
    let Some((how, bytes)) = bytes.split_first() else {
        return;
    };
    let place = &*PLACE;
    let identity = &place.identity;
    let journal = match how % 3 {
        0 => bytes.to_vec(),
        1 => [
            format!("{{\"ensemble\":\"{identity}\"}}\n").as_bytes(),
            bytes,
        ]
        .concat(),
        _ => {
            let header = sealed(&format!("{{\"ensemble\":\"{identity}\",\"journal\":2}}"));
            let text = String::from_utf8_lossy(bytes);
            let lines = text.lines().map(|line| match line.ends_with('}') {
                true => sealed(line) + "\n",
                false => line.to_owned() + "\n",
            });
            (header + "\n" + &lines.collect::<String>()).into_bytes()
        }
    };
    std::fs::write(place.path.join("journal.jsonl"), journal).expect("it can be written");
    let Ok(contents) = Folder::read(&place.path) else {
        return;
    };
    let finished = contents.finished.to_vec().expect("it is read once more");
    let keys: Vec<_> = contents.finished.keys().collect();
    assert!(keys.is_sorted_by(|a, b| a < b));
    assert!(keys.iter().all(|&(program, run)| program == 0 && run < 3));
    assert!(finished.iter().all(|it| it.record.ticks <= 1000));
}
