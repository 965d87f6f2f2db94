//! `stochc fsck`.
use std::path::PathBuf;

use clap::Args;
use stochc_files::shell::file as shell_file;
use stochc_results::DAMAGED;
use stochc_results::integrity::{FileIntegrity, Integrity, repair, verify};
use stochc_results::{Folder, FolderError};
use stochc_text::visible;

use super::terminal::{print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::sweep::files_for_screens;

/// Arguments of `fsck`.
#[derive(Debug, Args)]
pub struct FsckArguments {
    /// Results folder
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Repair the folder. This moves corrupted files into `DIR/damaged`, and writes the journal and the tables again
    /// from valid lines
    #[arg(long)]
    repair: bool,
}

/// Reports whether each file of a results folder is valid.
pub fn run(options: &FsckArguments) -> Result<Exit, Failure> {
    let path = &options.folder;
    let health = verify(path).map_err(Failure::usage)?;
    let is_corrupted =
        |files: &[FileIntegrity]| files.iter().any(|file| file.health.is_corrupted());
    print(&table(&health))?;
    if !is_corrupted(&health) {
        return Ok(Exit::Success);
    }
    if !options.repair {
        warn("some files are corrupted; `--repair` keeps the valid parts, and deletes nothing\n");
        return Ok(Exit::Usage);
    }
    repair(path, files_for_screens).map_err(Failure::usage)?;
    let valid = match Folder::read(path) {
        Err(FolderError::Split { .. }) => {
            let folder = shell_file(&visible(&path.to_string_lossy()));
            format!("`stochc shard status {folder}` lists the shards that are missing")
        }
        contents => {
            let contents = contents.map_err(Failure::usage)?;
            let (valid, all) = (contents.finished.len(), contents.manifest.total());
            format!("{valid} of {all} runs are kept")
        }
    };
    let folder = visible(&path.join(DAMAGED).to_string_lossy());
    print(&format!(
        "repaired: {valid}; corrupted files are in `{folder}`\n"
    ))?;
    if is_corrupted(&verify(path).map_err(Failure::usage)?) {
        Err(Failure::usage(
            "some files are still corrupted; run `stochc fsck` again",
        ))
    } else {
        Ok(Exit::Success)
    }
}

/// Returns the report as text: a line for each file and each problem.
fn table(files: &[FileIntegrity]) -> String {
    let mut text = String::new();
    for FileIntegrity { name, health } in files {
        let name = visible(name);
        match health {
            Integrity::Valid => text += &format!("{name}: valid\n"),
            Integrity::Unprotected => {
                text += &format!("{name}: has no checksum, and can be read\n")
            }
            Integrity::Corrupted(reasons) => {
                let lines = reasons.iter();
                text.extend(lines.map(|reason| format!("{name}: damaged: {reason}\n")));
            }
        }
    }
    text
}
