//! Checkpoints: the states of runs under way, in a folder beside the journal, from which they go on after whatever has
//! ended the process.
//!
//! A file is a line of JSON with its checksum, the state as [`stochc_ir::state`] writes it, and a checksum (CRC-32) of both.
//! The line names the build, ensemble, program and run.
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
use stochc_files::checksum::{self, LineIntegrity, Summed, of_file};
use stochc_files::{File, budget, disk, open_own};
use stochc_ir::state::StateWriter;
use stochc_runtime::Save;

use super::{Manifest, this_build};
use crate::execution::now;
use crate::folder::{CHECKPOINTS, DAMAGED};
use crate::integrity::{FileIntegrity, Integrity};
use stochc_text::{duration, visible};

/// Of the file.
const VERSION: u32 = 1;

/// How the name of a checkpoint ends.
const SUFFIX: &str = ".state";
/// Bytes of the first line, fewer than which it has.
const MAX: u64 = 1 << 12;
/// Bytes of the checksum at the end.
const CHECKSUM: u64 = 4;

/// Ticks between two looks at the clock.
const LOOK_EVERY: u32 = 16;
/// At most one part in so many of a run's time goes into its checkpoints.
const SHARE: u32 = 100;
/// A run that is told to stop loses less than this, if it is asked for checkpoints at all.
const MIN: Duration = Duration::from_secs(10);

/// How often the state of a run is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interval {
    /// So much time after the last one, or after a hundred times as long as that took.
    ///
    /// When it is kept changes nothing of a run, so that the clock may decide it: what a kill costs is time.
    Time(Duration),
    /// At every so many ticks, whatever that takes.
    Ticks(u64),
    /// Never.
    Never,
}

impl Interval {
    /// Five minutes.
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

impl FromStr for Interval {
    type Err = String;

    fn from_str(text: &str) -> Result<Interval, String> {
        let wrong = || "give a time (90s, 5m, 2h), ticks (20000ticks) or `never`".to_owned();
        if text == "never" {
            return Ok(Interval::Never);
        }
        match text.strip_suffix("ticks") {
            Some(ticks) => match ticks.trim_end().parse() {
                Ok(0) => Err("no ticks are too few".to_owned()),
                parsed => parsed.map(Interval::Ticks).map_err(|_| wrong()),
            },
            None => duration(text).map(Interval::Time).map_err(|_| wrong()),
        }
    }
}

/// A run, by the number of its program and its own.
type RunKey = (usize, u64);

/// The first line of a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct CheckpointHeader {
    checkpoint: u32,
    ensemble: String,
    build: String,
    program: usize,
    run: u64,
    tick: u64,
}

/// What a file is.
enum CheckpointFile {
    /// A state of this ensemble by this build: its tick, and where the state begins and ends.
    Sound(u64, [u64; 2]),
    /// A state of something else; what.
    Foreign(&'static str),
    /// Why.
    Damaged(String),
}

/// The checkpoints of an ensemble.
#[derive(Debug)]
pub struct Checkpoints {
    /// Of the results.
    path: PathBuf,
    ensemble: String,
    build: String,
    /// Of the programs.
    names: Vec<String>,
    interval: Interval,
    /// The runs of which there is one.
    there: Mutex<BTreeSet<RunKey>>,
    notes: Mutex<Vec<String>>,
}

impl Checkpoints {
    /// Looks through the checkpoints in a folder of results: what is damaged is moved aside. Of runs that nobody `wants` any
    /// more they are left alone.
    ///
    /// # Errors
    /// Those of the file system.
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
                CheckpointFile::Sound(tick, _) => {
                    checkpoints.there().insert(key);
                    checkpoints.note(format!("{run} goes on from its checkpoint at tick {tick}"));
                }
                CheckpointFile::Foreign(what) => checkpoints.note(format!(
                    "the checkpoint of {run} is not used, for it is {what}; the run begins anew"
                )),
                CheckpointFile::Damaged(why) => checkpoints.refuse(key, &why)?,
            }
        }
        Ok(checkpoints)
    }

    /// Takes out what there is to be told: sentences without their ends.
    pub fn notes(&self) -> Vec<String> {
        std::mem::take(&mut *self.notes.lock().expect("nobody panics while it is held"))
    }

    fn note(&self, note: String) {
        let mut notes = self.notes.lock().expect("nobody panics while it is held");
        // A disk that is full is so every time.
        if !notes.contains(&note) {
            notes.push(note);
        }
    }

    fn there(&self) -> std::sync::MutexGuard<'_, BTreeSet<RunKey>> {
        self.there.lock().expect("nobody panics while it is held")
    }

    fn shown(&self, (program, run): RunKey) -> String {
        format!("run {run} of `{}`", visible(&self.names[program]))
    }

    fn file(&self, key: RunKey) -> PathBuf {
        file(&self.path, key)
    }

    /// Moves a checkpoint aside that nothing can go on from.
    fn refuse(&self, key: RunKey, why: &str) -> io::Result<()> {
        self.there().remove(&key);
        let moved = move_aside(&self.file(key), &self.path.join(DAMAGED))?;
        let run = self.shown(key);
        self.note(format!(
            "the checkpoint of {run} {why}; it is now `{}`, and the run begins anew",
            visible(&moved.to_string_lossy())
        ));
        Ok(())
    }

    /// Removes the checkpoint of a run that is done, after `sync` has made what is known of that survive a loss of power.
    ///
    /// # Errors
    /// Those of the file system.
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
        gone(disk::remove(&self.file(key)))
    }

    /// Has the states kept of a run that begins.
    pub(crate) fn of_run(&self, program: usize, run: u64) -> RunCheckpoints<'_> {
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
            Err(why) => return Ok(CheckpointFile::Damaged(why.to_owned())),
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
            return Ok(CheckpointFile::Sound(header.tick, place));
        };
        Ok(CheckpointFile::Foreign(foreign))
    }

    /// Writes a file whole, or leaves the one that is there.
    fn write(&self, (program, run): RunKey, tick: u64, save: &mut Save<'_>) -> io::Result<()> {
        make_own_folder(&self.path.join(CHECKPOINTS))?;
        // Several machines may make one piece: what each writes is a state of the same run.
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

/// The checkpoints of one run, for as long as a thread makes it.
pub(crate) struct RunCheckpoints<'a> {
    all: &'a Checkpoints,
    key: RunKey,
    /// That was told last.
    tick: Cell<u64>,
    calls: Cell<u32>,
    /// When and at which tick it began, or its state was kept last.
    since: Cell<(Instant, u64)>,
    /// How long it has to be since then.
    wait: Cell<Duration>,
    is_due: Cell<bool>,
    /// It has begun with what was kept.
    has_begun: Cell<bool>,
}

impl RunCheckpoints<'_> {
    /// Takes in that a tick begins, and whether the run is told to stop.
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

    /// A state that is not kept costs no run.
    pub fn keep(&self, save: &mut Save<'_>) {
        let (tick, begun) = (self.tick.get(), now());
        if let Err(error) = self.all.write(self.key, tick, save) {
            let run = self.all.shown(self.key);
            (self.all).note(format!("the state of {run} cannot be kept: {error}"));
        }
        let now = now();
        self.since.set((now, tick));
        if let Interval::Time(time) = self.all.interval {
            self.wait.set(time.max((now - begun) * SHARE));
        }
    }

    /// What the run begins with.
    pub fn begin(&self) -> Option<Box<dyn Read>> {
        if !self.all.there().contains(&self.key) {
            return None;
        }
        let opened = opened(&self.all.file(self.key)).and_then(|mut file| {
            let found = self.all.identify(self.key, &file)?;
            let CheckpointFile::Sound(tick, [begins, ends]) = found else {
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
            // Somebody else has made the run to its end, or has changed it.
            Err(_) => {
                self.all.there().remove(&self.key);
                None
            }
        }
    }

    /// Takes back that the run began with what was kept, because nothing came of that; whether it did.
    pub fn begins_anew(&self) -> bool {
        if !self.has_begun.replace(false) {
            return false;
        }
        let why = "is no state of it as it is recorded now";
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

/// The checkpoints in a folder of results, sorted.
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

/// All files beside each other.
fn files(path: &Path) -> io::Result<Vec<PathBuf>> {
    match disk::list(&path.join(CHECKPOINTS)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        listed => listed,
    }
}

/// Removes all checkpoints that nobody `wants`, and what kills have left of some, from a folder in which nobody makes any.
///
/// # Errors
/// Those of the file system.
pub(crate) fn clear(path: &Path, wants: impl Fn(usize, u64) -> bool) -> io::Result<()> {
    let wanted = list(path)?.into_iter();
    let wanted: BTreeSet<PathBuf> = wanted
        .filter(|((program, run), _)| wants(*program, *run))
        .map(|(_, path)| path)
        .collect();
    let mut left = 0;
    for file in files(path)? {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let is_ours = name.ends_with(SUFFIX) || name.contains(".draft-");
        if is_ours && !wanted.contains(&file) {
            gone(disk::remove(&file))?
        } else {
            left += 1
        }
    }
    match left {
        0 => gone(disk::remove_folder(&path.join(CHECKPOINTS))),
        _ => Ok(()),
    }
}

/// How the checkpoints of a folder are.
pub(crate) fn health(path: &Path) -> Vec<FileIntegrity> {
    let health = |((program, run), file): (RunKey, PathBuf)| {
        let name = format!("{CHECKPOINTS}/{program}-{run}{SUFFIX}");
        let found = opened(&file).and_then(|file| read(&file));
        let why = match found {
            Ok(Ok(_)) => None,
            Ok(Err(why)) => Some(why.to_owned()),
            Err(error) => Some(error.to_string()),
        };
        let health = why.map_or(Integrity::Sound, |why| {
            Integrity::Damaged(vec![format!("`{name}` {why}")])
        });
        FileIntegrity { name, health }
    };
    match list(path) {
        Ok(files) => files.into_iter().map(health).collect(),
        Err(error) => vec![FileIntegrity {
            name: CHECKPOINTS.to_owned(),
            health: Integrity::Damaged(vec![format!("`{CHECKPOINTS}`: {error}")]),
        }],
    }
}

/// Reads the first line of a file and holds all of it against its checksum; or what is wrong with it.
fn read(file: &File) -> io::Result<Result<(CheckpointHeader, [u64; 2]), &'static str>> {
    let damaged = Ok(Err("is damaged"));
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
        .filter(|line| checksum::check(line) == LineIntegrity::Sound);
    let header = header.and_then(|line| serde_json::from_slice(line).ok());
    let ends = bytes.checked_sub(CHECKSUM).filter(|it| *it >= begins);
    let (Some(header), Some(ends)) = (header, ends) else {
        return damaged;
    };
    from.seek(SeekFrom::Start(0))?;
    let sum = of_file(from, ends)?;
    let mut checksum = [0; CHECKSUM as usize];
    from.seek(SeekFrom::Start(ends))?;
    from.read_exact(&mut checksum)?;
    if sum.crc32 == u32::from_le_bytes(checksum) {
        Ok(Ok((header, [begins, ends])))
    } else {
        damaged
    }
}

/// What somebody else has removed is gone as well.
fn gone(removed: io::Result<()>) -> io::Result<()> {
    match removed {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}
