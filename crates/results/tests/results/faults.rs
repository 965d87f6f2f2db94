//! Tests failures of the disk: every single call fails once, in every way. Resuming always gives
//! the same tables.
//!
//! The ignored test repeats this with other runs each time. CONTRIBUTING.md has the command.
use std::collections::BTreeMap;
use std::fs;
use std::io::Error;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use stochc_files::disk::{Call, CallDecision, Double, replace_by, restore};
use stochc_ir::record::RunRecord;
use stochc_results::integrity::repair;
use stochc_results::shards::{Shard, ShardError, merge, prepare};
use stochc_results::{Destination, Folder, FolderError, Manifest, Records, RunCancelled, RunWatch};

use crate::world::{EVERY, bytes, manifest, run_on, simulate};

/// Kind of failure of a disk call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    /// From this call on, nothing can be written.
    NoSpace,
    /// This call fails.
    InputOutput,
    /// This call writes half of its data and then fails.
    Torn,
    /// This call, a sync, does nothing. The power fails at the end.
    LostSync,
    /// The process ends before this call.
    Kill,
    /// The power fails before this call. Data that were not synced are lost.
    PowerLoss,
    /// The power fails before this call. Names that were not synced are stored, with half of the
    /// data.
    TornPowerLoss,
}

const FAULTS: [Fault; 7] = [
    Fault::NoSpace,
    Fault::InputOutput,
    Fault::Torn,
    Fault::LostSync,
    Fault::Kill,
    Fault::PowerLoss,
    Fault::TornPowerLoss,
];

/// Content of a disk: files by path, and folders as `None`.
type Image = BTreeMap<PathBuf, Option<Vec<u8>>>;

/// Disk that fails at one call.
struct Faulty {
    root: PathBuf,
    /// Number of the failing call, with its fault. `None` means that no call fails.
    plan: Option<(usize, Fault)>,
    state: Mutex<State>,
}

/// Effect of a disk call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The call changes nothing.
    Reads,
    /// The call writes data.
    Writes,
    /// The call makes another change.
    Changes,
    Syncs,
}

impl Kind {
    fn from_call(call: Call) -> Kind {
        match call {
            Call::Open | Call::Read | Call::List | Call::Look | Call::Lock => Kind::Reads,
            Call::Write(_) => Kind::Writes,
            Call::Create
            | Call::SetLength(_)
            | Call::MakeFolder
            | Call::Rename(_)
            | Call::Remove => Kind::Changes,
            Call::Sync | Call::SyncFolder => Kind::Syncs,
        }
    }
}

impl Fault {
    /// Returns whether the fault can affect a call of this kind.
    fn strikes(self, kind: Kind) -> bool {
        match self {
            Fault::NoSpace => matches!(kind, Kind::Writes | Kind::Changes),
            Fault::Torn => kind == Kind::Writes,
            Fault::LostSync => kind == Kind::Syncs,
            Fault::InputOutput | Fault::Kill | Fault::PowerLoss | Fault::TornPowerLoss => true,
        }
    }

    /// Returns whether the process ends with the fault.
    fn is_end(self) -> bool {
        matches!(self, Fault::Kill | Fault::PowerLoss | Fault::TornPowerLoss)
    }
}

#[derive(Default)]
struct State {
    calls: Vec<Kind>,
    /// Whether the fault has occurred.
    is_hit: bool,
    /// Content of the disk after the crash. `None` if it equals the folder.
    after: Option<Image>,
    /// Number of every file and folder. Renaming does not change it.
    numbers: BTreeMap<PathBuf, usize>,
    next: usize,
    /// For each file, the content that would survive a loss of power.
    synced: BTreeMap<usize, Vec<u8>>,
    /// For each folder, the names that would survive a loss of power.
    names: BTreeMap<usize, BTreeMap<PathBuf, (usize, bool)>>,
}

impl State {
    fn number(&mut self, path: &Path) -> usize {
        if let Some(&number) = self.numbers.get(path) {
            return number;
        }
        self.next += 1;
        self.numbers.insert(path.to_owned(), self.next);
        self.next
    }

    fn sync_folder(&mut self, folder: &Path) {
        let mut names = BTreeMap::new();
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let is_folder = path.is_dir();
            names.insert(path.clone(), (self.number(&path), is_folder));
        }
        let number = self.number(folder);
        self.names.insert(number, names);
    }

    /// Collects the files that survive a loss of power.
    fn left(&mut self, folder: &Path, image: &mut Image) {
        let number = self.number(folder);
        for (path, (number, is_folder)) in self.names.get(&number).cloned().unwrap_or_default() {
            if is_folder {
                image.insert(path.clone(), None);
                self.left(&path, image);
            } else {
                let content = self.synced.get(&number).cloned().unwrap_or_default();
                image.insert(path, Some(content));
            }
        }
    }
}

/// Collects the content of a folder.
fn image(folder: &Path, found: &mut Image) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            image(&path, found);
            found.insert(path, None);
        } else {
            let content = fs::read(&path).unwrap();
            found.insert(path, Some(content));
        }
    }
}

fn now(root: &Path) -> Image {
    let mut found = Image::new();
    image(root, &mut found);
    found
}

impl Faulty {
    fn new(root: &Path, plan: Option<(usize, Fault)>) -> Arc<Faulty> {
        let mut state = State::default();
        state.sync_folder(root);
        Arc::new(Faulty {
            root: root.to_owned(),
            plan,
            state: Mutex::new(state),
        })
    }

    /// Simulates the crash that the fault causes.
    fn crash(&self, state: &mut State, fault: Fault) {
        let mut after = Image::new();
        match fault {
            Fault::Kill => after = now(&self.root),
            Fault::TornPowerLoss => {
                after = now(&self.root);
                for (path, content) in &mut after {
                    let number = state.number(path);
                    let synced = state.synced.get(&number).cloned().unwrap_or_default();
                    if let Some(content) = content {
                        let whole = std::mem::take(content);
                        *content = match whole.strip_prefix(&synced[..]) {
                            Some(more) => [&synced, &more[..more.len() / 2]].concat(),
                            None => synced,
                        };
                    }
                }
            }
            _ => state.left(&self.root, &mut after),
        }
        state.after = Some(after);
    }

    /// Returns the effect of the fault on a call. Returns `None` if the call succeeds.
    fn strike(&self, state: &mut State, fault: Fault, call: Call) -> Option<CallDecision> {
        let writes = matches!(
            call,
            Call::Create
                | Call::Write(_)
                | Call::MakeFolder
                | Call::Rename(_)
                | Call::SetLength(1..)
        );
        let verdict = match fault {
            Fault::NoSpace if writes => CallDecision::Fail(Error::from_raw_os_error(28)),
            Fault::InputOutput => CallDecision::Fail(Error::from_raw_os_error(5)),
            Fault::Torn => match call {
                Call::Write(bytes) => {
                    CallDecision::Torn(bytes.len() / 2, Error::from_raw_os_error(5))
                }
                _ => return None,
            },
            Fault::LostSync if matches!(call, Call::Sync | Call::SyncFolder) => {
                CallDecision::Pretend
            }
            Fault::Kill | Fault::PowerLoss | Fault::TornPowerLoss => {
                self.crash(state, fault);
                CallDecision::Fail(Error::from_raw_os_error(5))
            }
            Fault::NoSpace | Fault::LostSync => return None,
        };
        state.is_hit = true;
        Some(verdict)
    }
}

impl Double for Faulty {
    fn decide(&self, path: &Path, call: Call) -> CallDecision {
        let mut state = self.state.lock().unwrap();
        let state = &mut *state;
        if state.after.is_some() {
            return CallDecision::Fail(Error::from_raw_os_error(5));
        }
        let number = state.calls.len();
        state.calls.push(Kind::from_call(call));
        if let Some((at, fault)) = self.plan {
            let lasts = fault == Fault::NoSpace && number > at;
            if number == at || lasts {
                let verdict = self.strike(state, fault, call);
                if let Some(verdict) = verdict {
                    return verdict;
                }
            }
        }
        match call {
            Call::Create | Call::MakeFolder => {
                state.number(path);
            }
            Call::Sync => {
                let number = state.number(path);
                state.synced.insert(number, fs::read(path).unwrap());
            }
            Call::SyncFolder => state.sync_folder(path),
            Call::Rename(to) => {
                let number = state.number(path);
                state.numbers.remove(path);
                state.numbers.insert(to.to_owned(), number);
            }
            Call::Remove => {
                state.numbers.remove(path);
            }
            _ => {}
        }
        CallDecision::Proceed
    }
}

/// Returns a function that makes the runs of an ensemble. The seed shifts the numbers of the runs.
/// This skips run 3, which panics.
fn runs_of(
    manifest: &Manifest,
) -> impl Fn(usize, u64, &RunWatch) -> Result<RunRecord, RunCancelled> + Sync {
    let first = 16 * manifest.seed;
    move |program, run, watch| {
        let record = simulate(program, first + run, watch)?;
        Ok(RunRecord { run, ..record })
    }
}

/// Function that can be interrupted at any time and then resumed.
type Work = fn(&Path, &Manifest) -> Result<(), String>;

/// Completes some work. Repeats it while a child process of another test still holds inherited
/// locks.
fn patiently(work: Work, root: &Path, manifest: &Manifest) -> Result<(), String> {
    loop {
        match work(root, manifest) {
            Err(message) if message.starts_with("another process is writing") => {
                std::thread::yield_now()
            }
            done => return done,
        }
    }
}

fn in_one_shard(root: &Path, manifest: &Manifest) -> Result<(), String> {
    let folder = Folder::open(root, manifest, true)
        .and_then(|folder| folder.with_checkpoints(EVERY))
        .map_err(|error| error.to_string())?;
    let never = AtomicBool::new(false);
    let done = run_on(1, Destination::Folder(folder), &never, runs_of(manifest));
    let complete = done.map_err(|error| error.to_string())?.complete;
    complete
        .then_some(())
        .ok_or("it is not complete".to_owned())
}

fn in_shards(root: &Path, manifest: &Manifest) -> Result<(), String> {
    let text = |error: ShardError| error.to_string();
    match Folder::read(root) {
        // The shards are already merged. The tables may be missing.
        Ok(contents) if contents.finished.len() as u64 == manifest.total() => {
            return in_one_shard(root, manifest);
        }
        Ok(_) | Err(FolderError::Absent(_) | FolderError::Split { .. }) => {}
        Err(error) => return Err(error.to_string()),
    }
    prepare(root, manifest, 2).map_err(text)?;
    let never = AtomicBool::new(false);
    for number in 0..2 {
        let shard = Shard::open(root, number).and_then(|shard| shard.with_checkpoints(EVERY));
        let shard = shard.map_err(text)?;
        let progress = shard.progress(NonZeroUsize::MIN);
        let made = shard
            .make(&progress, &never, runs_of(manifest))
            .map_err(text)?;
        assert!(made);
    }
    let none = |_: &Manifest, _: &Records| Ok(Vec::new());
    merge(root, none).map(|_| ()).map_err(text)
}

/// Counts of outcomes.
#[derive(Debug, Default)]
struct Count {
    points: usize,
    /// Number of times that the work succeeded in spite of the fault.
    well: usize,
    crashes: usize,
    /// Number of times that the folder was repaired or lost.
    repaired: usize,
    lost: usize,
}

/// Makes every call of some work fail once, and resumes the work each time.
fn every_call_fails(work: Work, runs: u64, seed: u64) -> Count {
    let mut manifest = manifest(runs);
    manifest.seed = seed;
    let memory = PathBuf::from("/dev/shm");
    let above = if memory.is_dir() {
        memory
    } else {
        std::env::temp_dir()
    };
    let root = tempfile::tempdir_in(above).unwrap();
    let root = root.path().join("folder");
    let fresh = || {
        let _ = fs::remove_dir_all(&root);
        fs::create_dir(&root).unwrap();
    };
    let undisturbed = || {
        fresh();
        let quiet = Faulty::new(&root, None);
        replace_by(&root, quiet.clone());
        patiently(work, &root, &manifest).unwrap();
        restore(&root);
        quiet.state.lock().unwrap().calls.clone()
    };
    // The first execution in a process also removes leftovers of killed processes, which adds
    // calls.
    undisturbed();
    let calls = undisturbed();
    let (tables, names): (_, Vec<_>) = (bytes(&root), now(&root).into_keys().collect());
    let mut count = Count::default();
    for fault in FAULTS {
        for (at, &kind) in calls.iter().enumerate() {
            // A crash between two calls that only read leaves the same files as the previous crash.
            let is_same = at > 0 && calls[at - 1] == Kind::Reads && fault.is_end();
            if is_same || !fault.strikes(kind) {
                continue;
            }
            fresh();
            let disk = Faulty::new(&root, Some((at, fault)));
            replace_by(&root, disk.clone());
            let done = work(&root, &manifest);
            restore(&root);
            let mut state = disk.state.lock().unwrap();
            if !state.is_hit {
                continue;
            }
            let what = format!("{fault:?} at call {at}");
            count.points += 1;
            if fault == Fault::LostSync {
                disk.crash(&mut state, Fault::PowerLoss);
            }
            match state.after.take() {
                Some(after) => {
                    count.crashes += 1;
                    fresh();
                    for (path, content) in after {
                        match content {
                            None => fs::create_dir_all(path).unwrap(),
                            Some(content) => {
                                fs::create_dir_all(path.parent().unwrap()).unwrap();
                                fs::write(path, content).unwrap();
                            }
                        }
                    }
                }
                None if done.is_ok() => {
                    count.well += 1;
                    assert!(bytes(&root) == tables, "{what}: success with other tables");
                }
                None => {}
            }
            let again = patiently(work, &root, &manifest);
            if let Err(error) = again {
                // A disk that ignores a sync may lose data without a copy. The loss must be
                // reported.
                assert_eq!(fault, Fault::LostSync, "{what}: {error}");
                let none = |_: &Manifest, _: &Records| Ok(Vec::new());
                let repaired =
                    repair(&root, none).is_ok() && patiently(work, &root, &manifest).is_ok();
                if repaired {
                    count.repaired += 1
                } else {
                    count.lost += 1;
                    fresh();
                    patiently(work, &root, &manifest).unwrap();
                }
            }
            assert!(bytes(&root) == tables, "{what}: other tables");
            if fault != Fault::LostSync {
                let left: Vec<_> = now(&root).into_keys().collect();
                assert_eq!(left, names, "{what}: files are left over");
            }
        }
    }
    count
}

#[test]
fn any_failed_call_leads_to_the_same_tables() {
    let count = every_call_fails(in_one_shard, 2, 0);
    println!("without shards: {count:?}");
    assert!(count.points > 500 && count.crashes > 200, "{count:?}");
    assert!(count.lost + count.repaired < 10, "{count:?}");
}

#[test]
fn any_failed_call_in_shards_leads_to_the_same_tables() {
    let count = every_call_fails(in_shards, 2, 0);
    println!("in shards: {count:?}");
    assert!(count.points > 1000 && count.crashes > 400, "{count:?}");
    assert!(count.lost + count.repaired < 20, "{count:?}");
}

/// Repeats the test with other runs. `STOCHC_FAULTS` is the number of repetitions.
#[test]
#[ignore = "takes an hour; CONTRIBUTING.md has the command"]
fn long_failures_lead_to_the_same_tables() {
    let times = std::env::var("STOCHC_FAULTS").expect("it says how many times");
    for seed in 1..=times.parse().unwrap() {
        for (name, work) in [
            ("in one shard", in_one_shard as Work),
            ("in shards", in_shards),
        ] {
            let count = every_call_fails(work, 2, seed);
            println!("{seed}, {name}: {count:?}");
            assert!(count.points > 500 && count.crashes > 200, "{count:?}");
        }
    }
}
