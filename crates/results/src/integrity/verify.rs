//! Verification and repair of a results folder.
use std::io::{self, BufReader};
use std::path::Path;

use stochc_files::atomic::move_aside;
use stochc_files::{budget, disk, open, read_file};

use crate::checkpoint;
use crate::folder::FolderChecksums;
use crate::folder::{CHECKSUMS_FILE, JOURNAL, MANIFEST, RECORDINGS, SHARDS, SHARDS_FILE};
use crate::folder::{lock, retain_valid_lines, without_manifest, write_manifest};
use crate::journal::JournalError;
use crate::journal::read as read_journal;
use crate::recording::{Outline, RecordingError, path as recording_path};
use crate::shards::{self, Split};
use crate::{Folder, FolderError, Further, Manifest, ManifestError, Records, Resume};
use stochc_text::visible;

pub use crate::folder::DAMAGED;
pub use crate::integrity::{FileIntegrity, Integrity};

/// Compares every file of a results folder with its checksum. Changes nothing.
///
/// # Errors
///
/// If the folder contains no results, or a file cannot be read, also for lack of memory.
pub fn verify(path: &Path) -> Result<Vec<FileIntegrity>, FolderError> {
    let in_manifest = FolderError::at(path.join(MANIFEST));
    let mut files = Vec::new();
    let mut report = |name: &str, health| {
        let name = name.to_owned();
        files.push(FileIntegrity { name, health });
    };
    if !path.join(MANIFEST).exists() {
        return Err(without_manifest(path, FolderError::Absent));
    }
    let bytes = read_file(&path.join(MANIFEST), budget::MANIFEST).map_err(&in_manifest)?;
    let (checksums, damage) = FolderChecksums::read(path);
    if checksums.is_some() || damage.is_some() {
        report(
            CHECKSUMS_FILE,
            Integrity::new(damage.into_iter().collect(), true),
        );
    }
    let checksums = checksums.unwrap_or_default();
    let read = parsed(&bytes);
    let mut damage: Vec<String> = checksums
        .damage(path, MANIFEST, false)
        .into_iter()
        .collect();
    if let (Err(reason), true) = (&read, damage.is_empty()) {
        damage.push(format!("`{MANIFEST}`: {reason}"));
    }
    // A damaged manifest is used only if it still belongs to the journal.
    let manifest = if damage.is_empty() {
        read
    } else {
        saved(path).map_err(in_manifest)?
    };
    report(MANIFEST, Integrity::new(damage, checksums.knows(MANIFEST)));
    let known = checksums.names().filter(|it| *it != MANIFEST);
    let by_checksum = |name: &str| {
        let damage = checksums.damage(path, name, name == JOURNAL);
        Integrity::new(damage.into_iter().collect(), true)
    };
    let Ok(manifest) = manifest else {
        // Without a manifest, files can only be compared with their checksums.
        known.for_each(|name| report(name, by_checksum(name)));
        return Ok(files);
    };
    let mut finished = Records::default();
    let journal = path.join(JOURNAL);
    if journal.exists() || checksums.knows(JOURNAL) {
        let health = match read_journal(&journal, &manifest, &manifest.identity()) {
            Ok(stored) => {
                let mut damage = stored.damage;
                if damage.is_empty() {
                    damage.extend(checksums.damage(path, JOURNAL, true));
                }
                finished = stored.finished;
                Integrity::new(damage, true)
            }
            Err(JournalError::Io(error)) if is_short_of_memory(&error) => {
                return Err(FolderError::at(journal)(error));
            }
            Err(error) => Integrity::Corrupted(vec![error.to_string()]),
        };
        report(JOURNAL, health);
    }
    for name in known.filter(|it| *it != JOURNAL) {
        report(name, by_checksum(name));
    }
    let split = Split::read(path).ok().flatten();
    if let Some(split) = &split {
        files.extend(shards::health(path, &manifest, split));
    }
    let mut report = |name: &str, health| {
        let name = name.to_owned();
        files.push(FileIntegrity { name, health });
    };
    for table in crate::tables() {
        let name = format!("{}.parquet", table.name);
        if !checksums.knows(&name) && path.join(&name).exists() {
            report(&name, Integrity::Unprotected);
        }
    }
    files.extend(checkpoint::health(path));
    let mut report = |name: &str, health| {
        let name = name.to_owned();
        files.push(FileIntegrity { name, health });
    };
    for (program, run) in recordings(&manifest, path) {
        let name = format!("{RECORDINGS}/{program}-{run}.rec");
        let health = recording(path, &manifest, &finished, program, run);
        report(&name, health.map_err(FolderError::at(path.join(&name)))?);
    }
    Ok(files)
}

/// Moves corrupted files to [`DAMAGED`] and writes them again. The journal is restored from its
/// valid lines. Tables and `further` files are restored from the journal. If the journal lost
/// lines, the earlier tables also move to [`DAMAGED`]. Recordings are not made again.
///
/// # Errors
///
/// If the manifest cannot be restored, another process writes to the folder, or the file system
/// fails.
pub fn repair(path: &Path, further: Further) -> Result<(), FolderError> {
    let of = |name: &str| FolderError::at(path.join(name));
    let health = verify(path)?;
    let is_corrupted =
        |name: &str| (health.iter()).any(|file| file.name == name && file.health.is_corrupted());
    let aside = |name: &str| {
        let moved = move_aside(&path.join(name), &path.join(DAMAGED));
        moved.map(|_| ()).map_err(of(DAMAGED))
    };
    let lock = lock(path)?;
    let manifest = if !is_corrupted(MANIFEST) {
        manifest(path).map_err(of(MANIFEST))?
    } else {
        saved(path).map_err(of(MANIFEST))?
    };
    let manifest = manifest.map_err(|reason| {
        if is_corrupted(MANIFEST) {
            FolderError::LostManifest(path.to_owned())
        } else {
            FolderError::Unreadable {
                path: path.to_owned(),
                reason,
            }
        }
    })?;
    if is_corrupted(MANIFEST) {
        aside(MANIFEST)?;
        write_manifest(path, &manifest)?;
    }
    if is_corrupted(SHARDS_FILE) && path.join(SHARDS_FILE).exists() {
        if path.join(SHARDS).exists() {
            // Without `shards.json`, the shards could not be found.
            return Err(FolderError::LostSplit(path.to_owned()));
        }
        aside(SHARDS_FILE)?;
    }
    if is_corrupted(JOURNAL) && path.join(JOURNAL).exists() {
        retain_valid_lines(path, &manifest)?;
    }
    // Tables with runs that the journal lost contain more than tables from the present journal.
    let is_lost = |name: &str| is_corrupted(JOURNAL) && !name.contains('/');
    for file in &health {
        let is_done = [MANIFEST, JOURNAL, SHARDS_FILE, CHECKSUMS_FILE].contains(&&*file.name);
        let is_removed = file.health.is_corrupted() || is_lost(&file.name);
        if is_removed && !is_done && path.join(&file.name).exists() {
            aside(&file.name)?;
        }
    }
    // The checksums describe the earlier files.
    if path.join(CHECKSUMS_FILE).exists() && health.iter().any(|file| file.health.is_corrupted()) {
        aside(CHECKSUMS_FILE)?;
    }
    if let Ok(Some(split)) = Split::read(path) {
        return split.write(path);
    }
    drop(lock);
    let folder = Folder::open(path, &manifest, Resume::MixedBuilds)?.with(further);
    folder.write_tables(folder.existing())
}

/// Reads the manifest, ignoring its checksum. The inner error explains why the manifest is
/// unreadable.
fn manifest(path: &Path) -> std::io::Result<Result<Manifest, ManifestError>> {
    let bytes = read_file(&path.join(MANIFEST), budget::MANIFEST)?;
    Ok(parsed(&bytes))
}

fn parsed(bytes: &[u8]) -> Result<Manifest, ManifestError> {
    let json = std::str::from_utf8(bytes)?;
    Manifest::from_json(json)
}

/// Reads a damaged manifest. A manifest that does not match the journal is also an inner error.
fn saved(path: &Path) -> std::io::Result<Result<Manifest, ManifestError>> {
    // The identity determines the runs and must match the journal.
    let belongs = |manifest: &Manifest| {
        let identity = manifest.identity();
        read_journal(&path.join(JOURNAL), manifest, &identity).is_ok_and(|stored| stored.whole > 0)
    };
    Ok(manifest(path)?.and_then(|manifest| {
        if belongs(&manifest) {
            Ok(manifest)
        } else {
            Err(ManifestError::NotOfTheJournal)
        }
    }))
}

/// Returns the runs that have a recording, each as program index and run number.
fn recordings(manifest: &Manifest, path: &Path) -> Vec<(usize, u64)> {
    let Ok(entries) = disk::list(&path.join(RECORDINGS)) else {
        return Vec::new();
    };
    let of = |name: &str| {
        let (program, run) = name.strip_suffix(".rec")?.split_once('-')?;
        let (program, run) = (program.parse().ok()?, run.parse().ok()?);
        let is_canonical = name == format!("{program}-{run}.rec");
        (program < manifest.programs.len() && is_canonical).then_some((program, run))
    };
    let names = entries
        .iter()
        .filter_map(|entry| entry.file_name()?.to_str());
    let mut found: Vec<_> = names.filter_map(of).collect();
    found.sort_unstable();
    found
}

/// Returns whether a file could not be read for lack of memory. The file itself can be valid.
fn is_short_of_memory(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::OutOfMemory
}

fn recording(
    path: &Path,
    manifest: &Manifest,
    finished: &Records,
    program: usize,
    run: u64,
) -> io::Result<Integrity> {
    let name = visible(&format!("{RECORDINGS}/{program}-{run}.rec"));
    let corrupted =
        |reason: &dyn std::fmt::Display| Integrity::Corrupted(vec![format!("`{name}`: {reason}")]);
    let opened = open(&recording_path(path, program, run)).and_then(|file| {
        budget::RECORDING.admits(file.metadata()?.len())?;
        Ok(file)
    });
    let file = match opened {
        Ok(file) => file,
        Err(error) if is_short_of_memory(&error) => return Err(error),
        Err(error) => return Ok(corrupted(&error)),
    };
    let recording = match Outline::read(BufReader::new(file), manifest.programs[program].tables()) {
        Ok(recording) => recording,
        Err(RecordingError::Io(error)) if is_short_of_memory(&error) => return Err(error),
        Err(error) => return Ok(corrupted(&error)),
    };
    let known = match finished.get(program, run) {
        Ok(known) => known,
        Err(JournalError::Io(error)) if is_short_of_memory(&error) => return Err(error),
        Err(error) => return Ok(corrupted(&error)),
    };
    Ok(
        if !recording.is_of(manifest, known.as_ref(), program, run) {
            corrupted(&"it is the recording of another run")
        } else {
            Integrity::Valid
        },
    )
}
