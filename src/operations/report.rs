//! Report on results folders, with its figures.
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use stochc_files::address::address;
use stochc_files::atomic::{self, Draft, Replaces, begins_with};
use stochc_files::{budget, disk, open, read_file};
use stochc_report::ensemble_report::{
    CRITICAL_PATHS, Figures, Input, MARK, Report, ReportError, ReportLocation, report,
};
use stochc_results::{Folder, Manifest, recording};
use stochc_text::visible;

use super::results::read as read_folder;
use crate::exit::{Exit, Failure};
use crate::host::Host;

/// Default file name of the report.
const PAGE: &str = "report.html";

/// Writes a report on results folders. Writes its figures to a folder next to the page.
///
/// # Errors
/// If a results folder cannot be read, or the page would replace a file that is not a report.
pub fn write(
    folders: &[PathBuf],
    out: Option<&Path>,
    figures: &Figures,
    host: &dyn Host,
) -> Result<PathBuf, Failure> {
    let folders = read(folders, host)?;
    write_page(&folders, out, figures, None)
}

/// Writes the report on a results folder into this folder, without messages. A browser reloads the
/// page after the time `reload`.
///
/// # Errors
/// If the folder cannot be read, or its `report.html` is not a report.
pub(super) fn write_of_one(
    folder: &Path,
    figures: &Figures,
    reload: Option<Duration>,
) -> Result<PathBuf, Failure> {
    let contents = Folder::read(folder).map_err(Failure::usage)?;
    let input = Input {
        path: folder.to_string_lossy().into_owned(),
        manifest: contents.manifest,
        finished: contents.finished,
    };
    write_page(&[(folder.to_owned(), input)], None, figures, reload)
}

fn write_page(
    folders: &[(PathBuf, Input)],
    out: Option<&Path>,
    figures: &Figures,
    reload: Option<Duration>,
) -> Result<PathBuf, Failure> {
    let page = match (out, folders) {
        (Some(out), _) => out.to_owned(),
        (None, [(folder, _)]) => folder.join(PAGE),
        (None, _) => PathBuf::from(PAGE),
    };
    let programs = (folders.iter()).flat_map(|(_, input)| &input.manifest.programs);
    if let Some(label) = figures.presentation.unused(programs) {
        let reason = format!("--label: `{}` is not the name of a program", label.name);
        return Err(Failure::usage(reason));
    }
    let beside = claim(&page).map_err(Failure::usage)?;
    let inputs: Vec<Input> = folders.iter().map(|(_, input)| input.clone()).collect();
    let name = beside
        .folder
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    let surroundings = ReportLocation {
        folder: &name,
        figures,
        reload,
        replay: &|folder, program, run| {
            let (path, input) = &folders[folder];
            let names = replay_names(&input.manifest, program, run);
            replay(&page, path, folders.len() == 1, &names)
        },
        recordings: &|folder, program, run| {
            let path = recording::path(&folders[folder].0, program, run);
            match open(&path) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => None,
                opened => Some(opened.and_then(|file| {
                    budget::RECORDING.admits(file.metadata()?.len())?;
                    Ok(Box::new(file) as Box<dyn io::Read>)
                })),
            }
        },
    };
    let refuse = |error: io::Error| Failure::not_written(&page, error);
    let mut critical_paths = beside.begin(CRITICAL_PATHS).map_err(refuse)?;
    let report =
        report(&inputs, &surroundings, &mut critical_paths).map_err(|error| match error {
            ReportError::Write(error) => refuse(error),
            ReportError::Runs(error) => Failure::usage(error),
        })?;
    keep(&page, &beside, &report, critical_paths).map_err(refuse)?;
    Ok(page)
}

/// Reads results folders, without duplicates. Reports the problems of all folders, not only the
/// first one.
fn read(paths: &[PathBuf], host: &dyn Host) -> Result<Vec<(PathBuf, Input)>, Failure> {
    let mut seen = Vec::new();
    let mut folders = Vec::new();
    let mut wrong = false;
    for path in paths {
        let real = std::fs::canonicalize(path).unwrap_or_else(|_| path.clone());
        if seen.contains(&real) {
            host.note(&format!(
                "note: `{}` is given twice\n",
                visible(&path.to_string_lossy())
            ));
            continue;
        }
        seen.push(real);
        match read_folder(path, host) {
            Ok((manifest, finished)) => {
                let (done, total) = (finished.len() as u64, manifest.total());
                if done < total {
                    let shown = path.display();
                    host.warn(&format!(
                        "warning: `{shown}` is not finished: {done} of {total} runs\n"
                    ));
                }
                let path_text = path.to_string_lossy().into_owned();
                let input = Input {
                    path: path_text,
                    manifest,
                    finished,
                };
                folders.push((path.clone(), input));
            }
            Err(failure) => {
                host.report_failure(&failure.message);
                wrong = true;
            }
        }
    }
    let versions: Vec<&str> = (folders.iter())
        .map(|(_, input)| input.manifest.stochc.as_str())
        .collect();
    if versions.windows(2).any(|pair| pair[0] != pair[1]) {
        host.warn(&format!(
            "warning: the folders were made by different versions of stochc: {}\n",
            stochc_text::visible(&versions.join(", "))
        ));
    }
    if wrong {
        Err(Failure::silent(Exit::Usage))
    } else {
        Ok(folders)
    }
}

/// Folder next to the page of a report, which receives the figures.
struct Beside {
    folder: PathBuf,
    /// Content of an earlier report with the same path. Empty if there is none.
    earlier: Vec<u8>,
}

/// Returns the folder for the figures of a page.
///
/// # Errors
/// If the page or the folder would replace other files. The error is a message for the user.
fn claim(page: &Path) -> Result<Beside, String> {
    let shown = page.display();
    let (Some(stem), false) = (page.file_stem(), page.is_dir()) else {
        return Err(format!("`{shown}` is a folder; give the name of a file"));
    };
    let mut name = stem.to_os_string();
    name.push("-figures");
    let folder = page.with_file_name(name);
    let earlier = match read_file(page, budget::PAGE) {
        Ok(earlier) if earlier.starts_with(MARK.as_bytes()) => earlier,
        Ok(_) => {
            return Err(format!(
                "`{shown}` is not a report of stochc; choose another name with `--out`"
            ));
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(format!("cannot use `{shown}`: {error}")),
    };
    let shown = folder.display();
    if folder.is_symlink() {
        return Err(format!(
            "`{shown}` is a link; remove it, or choose another name with `--out`"
        ));
    }
    match disk::list(&folder) {
        // An interrupted report may have left an incomplete file.
        Ok(there)
            if earlier.is_empty()
                && !there.is_empty()
                && !there.iter().any(|it| atomic::is_partial(it)) =>
        {
            return Err(format!(
                "`{shown}` holds other files; choose another name with `--out`"
            ));
        }
        Ok(_) => {}
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(format!("cannot use `{shown}`: {error}")),
    }
    Ok(Beside { folder, earlier })
}

impl Beside {
    /// Begins a file in the folder. Creates the folder if needed.
    fn begin(&self, name: &str) -> io::Result<Draft> {
        // Create only this folder: a missing parent may be a typing error.
        if !self.folder.is_dir() {
            std::fs::create_dir(&self.folder)?;
        }
        Draft::new(&self.folder.join(name), Replaces::Ordinary)
    }
}

/// Writes the figures, and then the page that refers to them. Deletes figures of an earlier report
/// that the new one does not have. Renames `critical_paths` last, because a folder without a page
/// cannot be recognized as part of a report.
fn keep(page: &Path, beside: &Beside, report: &Report, critical_paths: Draft) -> io::Result<()> {
    let Beside { folder, earlier } = beside;
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let extension = Path::new(&name).extension();
        let is_figure =
            extension.is_some_and(|it| ["svg", "pdf", "csv"].iter().any(|one| it == *one));
        let stays = (report.has_critical_paths && name == CRITICAL_PATHS)
            || report.files.iter().any(|(file, _)| name == file.as_str());
        // Files that the earlier page does not mention are kept.
        let address = format!("/{}\"", name.to_string_lossy());
        if is_figure && !stays && atomic::holds(&earlier[..], address.as_bytes())? {
            std::fs::remove_file(entry.path())?;
        }
    }
    for (name, content) in &report.files {
        atomic::replace(&folder.join(name), content, Replaces::Ordinary)?;
    }
    let ours = Replaces::Ours(|file| begins_with(file, MARK.as_bytes()));
    atomic::replace(page, report.page.as_bytes(), ours)?;
    if report.has_critical_paths {
        critical_paths.keep()
    } else {
        Ok(())
    }
}

/// Returns the address of a run's replay, relative to the page of a report. For a report on a
/// `single` folder, a replay next to the page has precedence. Otherwise, the replay is in the
/// results folder. Returns `None` if there is no replay.
fn replay(page: &Path, folder: &Path, single: bool, names: &[String]) -> Option<String> {
    let here = match page.parent()? {
        empty if empty == Path::new("") => Path::new("."),
        here => here,
    };
    let beside = names.iter().find(|name| here.join(name).is_file());
    if let (true, Some(name)) = (single, beside) {
        return Some(address(name));
    }
    let name = names.iter().find(|name| folder.join(name).is_file())?;
    // An absolute path would break if the report were moved to another computer.
    let (here, folder) = (here.canonicalize().ok()?, folder.canonicalize().ok()?);
    let below = folder.strip_prefix(here).ok()?.join(name);
    Some(address(&below.to_string_lossy().replace('\\', "/")))
}

/// Returns the possible file names of a run's replay. They contain the assembly or only the run
/// number.
fn replay_names(manifest: &Manifest, program: usize, run: u64) -> Vec<String> {
    let assembly = manifest.programs[program].assembly();
    let twins = manifest.programs.iter();
    let twins = twins.filter(|twin| twin.assembly() == assembly).count();
    let which = match twins {
        1 => String::new(),
        _ => format!("-{program}"),
    };
    let mut names = Vec::new();
    // An edited manifest may contain a path in place of a name.
    if assembly.chars().all(|c| c.is_alphanumeric() || c == '_') {
        names.push(format!("replay-{assembly}{which}-{run}.html"));
    }
    if manifest.programs.len() == 1 {
        names.push(format!("replay-{run}.html"));
    }
    names
}
