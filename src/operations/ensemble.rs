//! Execution of the runs of an ensemble.
use std::path::Path;
use std::time::Duration;

use stochc_compiler::diagnostic::Code;
use stochc_compiler::{Level, LintLevels};
use stochc_ir::scene::warnings::{SceneWarning, Stepping, scene_warnings};
use stochc_report::figures::Figures;
use stochc_results::recording::Selection;
use stochc_results::{
    Destination, EnsembleProgram, Folder, FolderState, Interval, Manifest, Progress, Records,
    Results, Resume, RunCancelled, RunWatch, check_stored, run as run_all,
};
use stochc_runtime::RunError;
use stochc_text::visible;

use super::recordings::Recordings;
use super::results::warn_of_damage;
use super::runs::{made_again, made_by, threads, warn_of_build, warn_of_checkpoints};
use super::stored_source::StoredSource;
use super::sweep;
use super::watch::watched;
use crate::exit::{Exit, Failure};
use crate::host::{Host, during};
use crate::progress::work_progress;

/// Options for making the runs of a manifest.
#[derive(Clone, Copy, Debug)]
pub struct EnsembleOptions<'a> {
    /// Results folder. `None` if the results stay in memory.
    pub out: Option<&'a Path>,
    /// Rule for runs that the folder already contains.
    pub resume: Resume,
    /// Selection of runs to record. Recordings require a folder.
    pub record: Option<&'a Selection>,
    /// Interval between recorded positions \[ticks\].
    pub record_every: u32,
    /// Interval between checkpoints of running simulations.
    pub checkpoints: Interval,
    /// Number of threads. `None` means one per core.
    pub threads: Option<u16>,
    /// Whether the user has already been warned that other builds made some of the runs.
    pub has_warned_of_build: bool,
    /// Whether the caller may request more runs afterwards. If so, the folder stays open for these
    /// runs.
    pub continues: bool,
    /// Whether to measure the CPU time of each run.
    pub measures_cpu: bool,
    /// Size and format of the figures of a sweep.
    pub figures: &'a Figures,
    /// Whether to rewrite the report of the folder during the work.
    pub watch: bool,
    /// Time limit for starting runs. `None` if there is no limit.
    pub time_limit: Option<Duration>,
}

/// Runs of an ensemble, and an error if recordings are missing.
#[derive(Debug)]
pub struct MadeEnsemble {
    /// All runs, including those of earlier commands.
    pub results: Results,
    /// Reason why recordings are missing. `None` if all recordings exist.
    pub unrecorded: Option<Failure>,
}

/// Checks that the selected runs exist and can be recorded.
///
/// # Errors
/// If a run does not exist, or its model has no positions.
pub fn can_record(manifest: &Manifest, record: Option<&Selection>) -> Result<(), Failure> {
    let Some(runs) = record else { return Ok(()) };
    if let Some(run) = runs.beyond(manifest.runs) {
        return Err(Failure::usage(format!(
            "--record: {}",
            manifest.no_such_run(run)
        )));
    }
    let models = manifest.programs.iter();
    let mut models = models.map(|program| manifest.settings_of(program).model);
    match models.find(|model| !model.has_places()) {
        None => Ok(()),
        Some(model) => Err(Failure::usage(format!(
            "nothing to record: {}",
            RunError::Nowhere(model)
        ))),
    }
}

/// Reports warnings about the scenes of a manifest, each only once.
///
/// `is_checked` states that a check with the same settings has already reported warnings. Then
/// examines only points of a sweep, and programs without stored sources.
///
/// # Errors
/// If the level of a reported warning is "deny".
pub fn judge_scenes(
    manifest: &Manifest,
    is_checked: bool,
    levels: &LintLevels,
    host: &dyn Host,
) -> Result<(), Failure> {
    let is_new = |program: &&EnsembleProgram| {
        !is_checked || program.sources.is_empty() || program.is_point()
    };
    let mut found: Vec<FoundWarning> = Vec::new();
    for program in manifest.programs.iter().filter(is_new) {
        let Some(stepping) = manifest.settings_of(program).stepping() else {
            continue;
        };
        let layers = program.tables().capture_layers();
        for warning in scene_warnings(&program.scene, stepping, layers) {
            if let Some(known) = found.iter_mut().find(|it| it.is_like(&warning)) {
                known.others += 1;
            } else {
                found.push(FoundWarning {
                    program,
                    stepping,
                    warning,
                    others: 0,
                });
            }
        }
    }
    let mut denied = String::new();
    for found in found {
        let code = Code::from(found.warning.kind);
        let levels = levels.clone().for_runs(Some(found.stepping));
        match level(found.program, code, &levels) {
            Level::Allow => {}
            Level::Warn => host.warn(&format!("warning{}", found.text(code))),
            Level::Deny => denied += &format!("error{}", found.text(code)),
        }
    }
    if denied.is_empty() {
        return Ok(());
    }
    Err(Failure {
        exit: Exit::InvalidProgram,
        message: denied,
    })
}

/// Warning about the scene of a program. Other programs may have the same warning.
struct FoundWarning<'a> {
    program: &'a EnsembleProgram,
    stepping: Stepping,
    warning: SceneWarning,
    /// Number of other programs with the same warning.
    others: usize,
}

impl FoundWarning<'_> {
    fn is_like(&self, other: &SceneWarning) -> bool {
        (self.warning.kind, self.warning.symbol) == (other.kind, other.symbol)
    }

    /// Returns the warning as one line of text, without its level.
    fn text(&self, code: Code) -> String {
        let others = match self.others {
            0 => String::new(),
            1 => " and another program".to_owned(),
            more => format!(" and {more} other programs"),
        };
        let name = visible(&self.program.name);
        let SceneWarning {
            figure,
            effect,
            remedy,
            ..
        } = &self.warning;
        format!("[{code}]: {name}{others}: {figure}: {effect}; {remedy}\n")
    }
}

/// Returns the level of a warning about a program's scene. A level in the source has precedence
/// over the command line.
fn level(program: &EnsembleProgram, code: Code, levels: &LintLevels) -> Level {
    let checked = StoredSource::new(program, levels).checked;
    let mut allowed = checked.allowed.iter().map(|it| it.diagnostic.code);
    let mut reported = checked.diagnostics.iter();
    match reported.find(|it| it.code == code) {
        Some(diagnostic) if diagnostic.is_error() => Level::Deny,
        Some(_) => Level::Warn,
        None if allowed.any(|it| it == code) => Level::Allow,
        None => levels.level(code),
    }
}

/// Makes the missing runs of a manifest.
///
/// # Errors
/// If the results folder cannot be used. Finished runs are not lost.
pub fn make(
    manifest: &Manifest,
    how: &EnsembleOptions<'_>,
    host: &dyn Host,
) -> Result<MadeEnsemble, Failure> {
    make_more(manifest, Records::default(), how, host)
}

/// Makes the missing runs of a manifest like [`make`]. `existing` contains the runs that are in
/// memory.
///
/// # Errors
/// See [`make`].
pub(super) fn make_more(
    manifest: &Manifest,
    existing: Records,
    how: &EnsembleOptions<'_>,
    host: &dyn Host,
) -> Result<MadeEnsemble, Failure> {
    let stop = host.stop();
    let at_once = threads(how.threads);
    let mut checkpoints = None;
    let destination = match how.out {
        None => Destination::MoreInMemory(manifest, existing),
        Some(out) => {
            let folder = Folder::open(out, manifest, how.resume).map_err(Failure::usage)?;
            warn_of_damage(out, folder.damage(), host);
            match folder.state() {
                FolderState::New if how.resume != Resume::No => host.note(&format!(
                    "there is nothing to resume in `{}`; all runs are made\n",
                    visible(&out.to_string_lossy())
                )),
                FolderState::New => {}
                FolderState::Finished if how.continues => {}
                FolderState::Finished => host.note(&format!(
                    "`{}` is finished already\n",
                    visible(&out.to_string_lossy())
                )),
                FolderState::Resumed if how.has_warned_of_build => {}
                FolderState::Resumed => warn_of_build(folder.builds(), host),
            }
            if folder.state() == FolderState::Resumed {
                check_stored(&folder, made_again(manifest, stop)).map_err(Failure::usage)?;
            }
            let folder = folder.with_checkpoints(how.checkpoints);
            let folder = folder.map_err(Failure::usage)?;
            checkpoints = folder.checkpoints().cloned();
            warn_of_checkpoints(checkpoints.as_deref(), host);
            Destination::Folder({
                let figures = how.figures.clone();
                let further =
                    move |manifest: &_, finished: &_| sweep::files(manifest, finished, &figures);
                folder.with(further)
            })
        }
    };
    let progress = Progress::new(manifest, at_once)
        .within(how.time_limit)
        .measuring_cpu(how.measures_cpu);
    let recordings = Recordings::new(how.out.zip(how.record), how.record_every, manifest);
    let unrecorded = made_by(manifest);
    let simulate = |program: usize, number, mut watch: &RunWatch| match recordings
        .recording(program, number)
    {
        Some(place) => {
            let record = place.record(&manifest.programs[program], &mut watch);
            record.map_err(|_| RunCancelled)
        }
        None => unrecorded(program, number, watch),
    };
    let is_all_there = destination.existing() == manifest.total();
    let state = |elapsed| work_progress(manifest, &progress, elapsed);
    let work = || run_all(destination, &progress, stop, simulate);
    let results = match how.out.filter(|_| how.watch) {
        // All runs already exist, so there is no progress to show.
        _ if is_all_there => work(),
        None => during(host, state, work),
        Some(out) => watched(out, how.figures, host, || during(host, state, work))?,
    };
    let results = results.map_err(Failure::usage)?;
    warn_of_checkpoints(checkpoints.as_deref(), host);
    Ok(MadeEnsemble {
        unrecorded: recordings.comment(&results.finished, host),
        results,
    })
}
