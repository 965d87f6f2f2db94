//! Checkpoints: states of running runs in a folder next to the journal. Runs resume from them after
//! an interruption of the process.
//!
//! A file is a line of JSON with its checksum, the state as written by [`stochc_ir::state`], and a
//! checksum (CRC-32) of both. The line names the build, ensemble, program and run.
//!
//! Runs of models without [`stochc_runtime::Model::has_state`] have no checkpoints.
use std::cell::Cell;
use std::collections::BTreeSet;
use std::fs::OpenOptions;
use std::io::{self, BufRead as _, BufReader, Read, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use stochc_files::atomic::{Draft, Replaces, make_own_folder, move_aside};
use stochc_files::checksum::{self, LineIntegrity, Summed, sum_file};
use stochc_files::{File, budget, disk, open_own};
use stochc_ir::state::StateWriter;
use stochc_runtime::Save;

use super::{Manifest, this_build};
use crate::execution::now;
use crate::folder::{CHECKPOINTS, DAMAGED};
use crate::integrity::{FileIntegrity, Integrity};
use stochc_text::{duration, visible};

const VERSION: u32 = 1;

const SUFFIX: &str = ".state";
/// Exclusive upper limit on the length of the first line \[bytes\].
const MAX: u64 = 1 << 12;
/// Length of the checksum at the end of a checkpoint file \[bytes\].
const CHECKSUM: u64 = 4;

/// Number of ticks between two readings of the clock.
const LOOK_EVERY: u32 = 16;
/// Reciprocal of the largest fraction of a run's time that checkpoints may take.
const SHARE: u32 = 100;
/// Shortest interval between two checkpoints. A run that is stopped loses at most this time.
const MIN: Duration = Duration::from_secs(10);

/// Interval between two checkpoints of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interval {
    /// Writes a checkpoint when this time has passed since the last checkpoint. Waits longer if
    /// writing takes more than a hundredth of this time.
    ///
    /// The interval is in real time because a kill costs only time. Checkpoints never affect
    /// results.
    Time(Duration),
    /// Writes a checkpoint each time this number of ticks has passed, at any cost.
    Ticks(u64),
    /// Writes no checkpoints.
    Never,
}

impl Interval {
    /// Default interval: five minutes.
    pub const DEFAULT: Interval = Interval::Time(Duration::from_secs(300));
}

impl std::fmt::Display for Interval {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Interval::Time(time) if time.as_secs().is_multiple_of(60) => {
                write!(f, "{}m", time.as_secs() / 60)
            }
            Interval::Time(time) => write!(f, "{}s", time.as_secs_f64()),
            Interval::Ticks(ticks) => write!(f, "{ticks}ticks"),
            Interval::Never => f.write_str("never"),
        }
    }
}

/// Error of an interval between checkpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InvalidInterval {
    /// The text does not have the form of an interval.
    #[error("give a time (90s, 5m, 2h), ticks (20000ticks) or `never`")]
    Form,
    /// The interval is zero.
    #[error("the interval must be at least one tick")]
    Zero,
}

impl FromStr for Interval {
    type Err = InvalidInterval;

    fn from_str(text: &str) -> Result<Interval, InvalidInterval> {
        if text == "never" {
            return Ok(Interval::Never);
        }
        match text.strip_suffix("ticks") {
            Some(ticks) => match ticks.trim_end().parse() {
                Ok(0) => Err(InvalidInterval::Zero),
                parsed => (parsed.map(Interval::Ticks)).map_err(|_| InvalidInterval::Form),
            },
            None => (duration(text).map(Interval::Time)).map_err(|_| InvalidInterval::Form),
        }
    }
}

/// Index of a program, and the number of its run.
type RunKey = (usize, u64);

/// First line of a checkpoint file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct CheckpointHeader {
    checkpoint: u32,
    ensemble: String,
    build: String,
    program: usize,
    run: u64,
    tick: u64,
}

/// Content of a checkpoint file.
enum CheckpointFile {
    /// Valid state of this ensemble and build: its tick, and its range in the file.
    Valid(u64, [u64; 2]),
    /// Valid state of another run or build. Contains a description of the difference.
    Foreign(&'static str),
    /// Corrupted file. Contains the reason.
    Corrupted(String),
}

/// Checkpoints of an ensemble.
#[derive(Debug)]
pub struct Checkpoints {
    /// Path of the results folder that contains the checkpoints.
    path: PathBuf,
    ensemble: String,
    build: String,
    /// Names of the programs.
    names: Vec<String>,
    interval: Interval,
    /// Runs with a checkpoint.
    there: Mutex<BTreeSet<RunKey>>,
    notes: Mutex<Vec<String>>,
}

impl Checkpoints {
    /// Opens the checkpoints in a results folder and moves corrupted ones aside. Ignores
    /// checkpoints of runs that `wants` rejects.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn open(
        path: &Path,
        manifest: &Manifest,
        interval: Interval,
        wants: impl Fn(usize, u64) -> bool,
    ) -> io::Result<Checkpoints> {
        let names = manifest.programs.iter().map(|it| it.name.clone());
        let mut checkpoints = Checkpoints {
            path: path.to_owned(),
            ensemble: manifest.identity(),
            build: this_build(),
            names: names.collect(),
            interval,
            there: Mutex::default(),
            notes: Mutex::default(),
        };
        if !manifest.settings.model.has_state() {
            checkpoints.interval = Interval::Never;
            return Ok(checkpoints);
        }
        for (key, file) in list(path)? {
            if key.0 >= checkpoints.names.len() || !wants(key.0, key.1) {
                continue;
            }
            let run = checkpoints.shown(key);
            match checkpoints.identify(key, &opened(&file)?)? {
                CheckpointFile::Valid(tick, _) => {
                    checkpoints.there().insert(key);
                    checkpoints.note(format!("{run} resumes from its checkpoint at tick {tick}"));
                }
                CheckpointFile::Foreign(what) => checkpoints.note(format!(
                    "the checkpoint of {run} is not used because it is {what}; the run restarts"
                )),
                CheckpointFile::Corrupted(why) => checkpoints.refuse(key, &why)?,
            }
        }
        Ok(checkpoints)
    }

    /// Returns the messages since the last call: sentences without a period. Removes them.
    pub fn notes(&self) -> Vec<String> {
        std::mem::take(&mut *self.notes.lock().expect("no panic while it is locked"))
    }

    fn note(&self, note: String) {
        let mut notes = self.notes.lock().expect("no panic while it is locked");
        // On a full disk, every checkpoint fails with the same error.
        if !notes.contains(&note) {
            notes.push(note);
        }
    }

    fn there(&self) -> std::sync::MutexGuard<'_, BTreeSet<RunKey>> {
        self.there.lock().expect("no panic while it is locked")
    }

    fn shown(&self, (program, run): RunKey) -> String {
        format!("run {run} of `{}`", visible(&self.names[program]))
    }

    fn file(&self, key: RunKey) -> PathBuf {
        file(&self.path, key)
    }

    /// Moves an unusable checkpoint aside.
    fn refuse(&self, key: RunKey, why: &str) -> io::Result<()> {
        self.there().remove(&key);
        let moved = move_aside(&self.file(key), &self.path.join(DAMAGED))?;
        let run = self.shown(key);
        self.note(format!(
            "the checkpoint of {run} {why}; it is now `{}`, and the run restarts",
            visible(&moved.to_string_lossy())
        ));
        Ok(())
    }

    /// Removes the checkpoint of a finished run. Before that, calls `sync` to make the run's record
    /// survive a power failure.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub(crate) fn remove(
        &self,
        program: usize,
        run: u64,
        sync: impl FnOnce() -> io::Result<()>,
    ) -> io::Result<()> {
        let key = (program, run);
        if !self.there().remove(&key) {
            return Ok(());
        }
        sync()?;
        ignore_missing(disk::remove(&self.file(key)))
    }

    /// Returns the checkpoints of a run that begins now.
    pub(crate) fn for_run(&self, program: usize, run: u64) -> RunCheckpoints<'_> {
        RunCheckpoints {
            all: self,
            key: (program, run),
            tick: Cell::new(0),
            calls: Cell::new(0),
            since: Cell::new((now(), 0)),
            wait: Cell::new(match self.interval {
                Interval::Time(time) => time,
                Interval::Ticks(_) | Interval::Never => Duration::MAX,
            }),
            is_due: Cell::new(false),
            has_begun: Cell::new(false),
        }
    }

    fn identify(&self, (program, run): RunKey, file: &File) -> io::Result<CheckpointFile> {
        let found = match read(file)? {
            Ok(found) => found,
            Err(why) => return Ok(CheckpointFile::Corrupted(why.to_owned())),
        };
        let (header, place) = found;
        let foreign = if header.checkpoint != VERSION {
            "in another format"
        } else if header.ensemble != self.ensemble {
            "of another ensemble"
        } else if header.build != self.build {
            "of another build of `stochc`"
        } else if (header.program, header.run) != (program, run) {
            "of another run"
        } else {
            return Ok(CheckpointFile::Valid(header.tick, place));
        };
        Ok(CheckpointFile::Foreign(foreign))
    }

    /// Writes a checkpoint atomically.
    fn write(&self, (program, run): RunKey, tick: u64, save: &mut Save<'_>) -> io::Result<()> {
        make_own_folder(&self.path.join(CHECKPOINTS))?;
        // Several machines may run one shard. Each writes a valid state of the same run.
        let draft = Draft::new(&self.file((program, run)), Replaces::Same)?;
        let mut draft = Summed::new(draft);
        let header = CheckpointHeader {
            checkpoint: VERSION,
            ensemble: self.ensemble.clone(),
            build: self.build.clone(),
            program,
            run,
            tick,
        };
        draft.write_all(crate::journal::line(&header).as_bytes())?;
        save(&mut StateWriter::new(&mut draft)).map_err(io::Error::other)?;
        let (mut draft, sum) = draft.finish();
        draft.write_all(&sum.crc32.to_le_bytes())?;
        draft.keep()?;
        self.there().insert((program, run));
        Ok(())
    }
}

/// Checkpoints of one run, for the thread that makes it.
pub(crate) struct RunCheckpoints<'a> {
    all: &'a Checkpoints,
    key: RunKey,
    /// Tick of the last call of [`Self::tick`].
    tick: Cell<u64>,
    calls: Cell<u32>,
    /// Time and tick of the last checkpoint, or of the start of the run.
    since: Cell<(Instant, u64)>,
    /// Required time between the last checkpoint and the next one.
    wait: Cell<Duration>,
    is_due: Cell<bool>,
    /// Whether the run was resumed from a checkpoint.
    has_begun: Cell<bool>,
}

impl RunCheckpoints<'_> {
    /// Records that a tick begins, and decides whether a checkpoint is due. `is_stopped` states
    /// whether the run was requested to stop.
    pub fn tick(&self, tick: u64, is_stopped: bool) {
        self.tick.set(tick);
        let (then, at) = self.since.get();
        let due = match self.all.interval {
            Interval::Never => false,
            Interval::Ticks(every) => tick - at.min(tick) >= every || (is_stopped && tick > at),
            Interval::Time(_) if is_stopped => now() - then >= self.wait.get().min(MIN),
            Interval::Time(_) => {
                self.calls.set(self.calls.get() + 1);
                self.calls.get().is_multiple_of(LOOK_EVERY) && now() - then >= self.wait.get()
            }
        };
        self.is_due.set(due);
    }

    pub fn is_due(&self) -> bool {
        self.is_due.get()
    }

    /// Writes a checkpoint. Errors become messages and do not stop the run.
    pub fn keep(&self, save: &mut Save<'_>) {
        let (tick, begun) = (self.tick.get(), now());
        if let Err(error) = self.all.write(self.key, tick, save) {
            let run = self.all.shown(self.key);
            (self.all).note(format!("cannot write a checkpoint of {run}: {error}"));
        }
        let now = now();
        self.since.set((now, tick));
        if let Interval::Time(time) = self.all.interval {
            self.wait.set(time.max((now - begun) * SHARE));
        }
    }

    /// Returns the checkpoint that the run can resume from, if there is one.
    pub fn begin(&self) -> Option<Box<dyn Read>> {
        if !self.all.there().contains(&self.key) {
            return None;
        }
        let opened = opened(&self.all.file(self.key)).and_then(|mut file| {
            let found = self.all.identify(self.key, &file)?;
            let CheckpointFile::Valid(tick, [begins, ends]) = found else {
                return Err(io::ErrorKind::InvalidData.into());
            };
            file.seek(SeekFrom::Start(begins))?;
            Ok((tick, BufReader::new(file.take(ends - begins))))
        });
        match opened {
            Ok((tick, state)) => {
                self.since.set((now(), tick));
                self.has_begun.set(true);
                Some(Box::new(state))
            }
            // Another process has finished the run or changed the file in the meantime.
            Err(_) => {
                self.all.there().remove(&self.key);
                None
            }
        }
    }

    /// Moves a checkpoint aside that does not fit the run's recording, so that the run restarts.
    /// Returns whether there was one.
    pub fn begins_anew(&self) -> bool {
        if !self.has_begun.replace(false) {
            return false;
        }
        let why = "does not fit its present recording";
        if let Err(error) = self.all.refuse(self.key, why) {
            let run = self.all.shown(self.key);
            (self.all).note(format!("the checkpoint of {run} {why}: {error}"));
        }
        self.since.set((now(), 0));
        true
    }
}

fn file(path: &Path, (program, run): RunKey) -> PathBuf {
    path.join(CHECKPOINTS)
        .join(format!("{program}-{run}{SUFFIX}"))
}

/// Returns the runs with checkpoints in a results folder, with their files, sorted.
fn list(path: &Path) -> io::Result<Vec<(RunKey, PathBuf)>> {
    let of = |path: &Path| {
        let name = path.file_name()?.to_str()?;
        let (program, run) = name.strip_suffix(SUFFIX)?.split_once('-')?;
        let key = (program.parse().ok()?, run.parse().ok()?);
        let is_canonical = name == format!("{}-{}{SUFFIX}", key.0, key.1);
        is_canonical.then_some(key)
    };
    let files = files(path)?.into_iter();
    let mut found: Vec<_> = files.filter_map(|path| Some((of(&path)?, path))).collect();
    found.sort_unstable();
    Ok(found)
}

fn opened(file: &Path) -> io::Result<File> {
    open_own(file, OpenOptions::new().read(true))
}

/// Returns all files in the checkpoint folder.
fn files(path: &Path) -> io::Result<Vec<PathBuf>> {
    match disk::list(&path.join(CHECKPOINTS)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        listed => listed,
    }
}

/// Removes leftover files and all checkpoints that `wants` rejects. Must not be called while a
/// simulation uses the folder.
///
/// # Errors
///
/// Errors of the file system.
pub(crate) fn clear(path: &Path, wants: impl Fn(usize, u64) -> bool) -> io::Result<()> {
    let listed = list(path)?.into_iter();
    let listed: BTreeSet<PathBuf> = listed
        .filter(|((program, run), _)| wants(*program, *run))
        .map(|(_, path)| path)
        .collect();
    let mut left = 0;
    for file in files(path)? {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let is_ours = name.ends_with(SUFFIX) || name.contains(".draft-");
        if is_ours && !listed.contains(&file) {
            ignore_missing(disk::remove(&file))?
        } else {
            left += 1
        }
    }
    match left {
        0 => ignore_missing(disk::remove_folder(&path.join(CHECKPOINTS))),
        _ => Ok(()),
    }
}

/// Returns the integrity of a folder's checkpoints.
pub(crate) fn health(path: &Path) -> Vec<FileIntegrity> {
    let health = |((program, run), file): (RunKey, PathBuf)| {
        let name = format!("{CHECKPOINTS}/{program}-{run}{SUFFIX}");
        let found = opened(&file).and_then(|file| read(&file));
        let why = match found {
            Ok(Ok(_)) => None,
            Ok(Err(why)) => Some(why.to_owned()),
            Err(error) => Some(error.to_string()),
        };
        let health = why.map_or(Integrity::Valid, |why| {
            Integrity::Corrupted(vec![format!("`{name}` {why}")])
        });
        FileIntegrity { name, health }
    };
    match list(path) {
        Ok(files) => files.into_iter().map(health).collect(),
        Err(error) => vec![FileIntegrity {
            name: CHECKPOINTS.to_owned(),
            health: Integrity::Corrupted(vec![format!("`{CHECKPOINTS}`: {error}")]),
        }],
    }
}

/// Reads the first line of a file and checks the checksum of the rest. Returns the reason if the
/// file is invalid.
fn read(file: &File) -> io::Result<Result<(CheckpointHeader, [u64; 2]), &'static str>> {
    let corrupted = Ok(Err("is damaged"));
    let bytes = file.metadata()?.len();
    if budget::CHECKPOINT.admits(bytes).is_err() {
        return Ok(Err("is too large"));
    }
    let mut line = Vec::new();
    let mut from = file;
    from.seek(SeekFrom::Start(0))?;
    BufReader::new(from.take(MAX)).read_until(b'\n', &mut line)?;
    let begins = line.len() as u64;
    let header = line
        .strip_suffix(b"\n")
        .filter(|line| checksum::check(line) == LineIntegrity::Valid);
    let header = header.and_then(|line| serde_json::from_slice(line).ok());
    let ends = bytes.checked_sub(CHECKSUM).filter(|it| *it >= begins);
    let (Some(header), Some(ends)) = (header, ends) else {
        return corrupted;
    };
    from.seek(SeekFrom::Start(0))?;
    let sum = sum_file(from, ends)?;
    let mut checksum = [0; CHECKSUM as usize];
    from.seek(SeekFrom::Start(ends))?;
    from.read_exact(&mut checksum)?;
    if sum.crc32 == u32::from_le_bytes(checksum) {
        Ok(Ok((header, [begins, ends])))
    } else {
        corrupted
    }
}

/// Converts a "not found" error to success: another process has already removed the file.
fn ignore_missing(removed: io::Result<()>) -> io::Result<()> {
    match removed {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}
