//! Reading the folder of an ensemble.
use std::path::Path;

use stochc_ensemble::text::visible;
use stochc_ensemble::{Folder, Manifest, Records};
use stochc_files::shell::file as shell_file;

use crate::exit::Failure;
use crate::host::Host;

/// Reads a results folder, and says what is wrong with it.
///
/// # Errors
/// If it holds no results.
pub fn read(folder: &Path, host: &dyn Host) -> Result<(Manifest, Records), Failure> {
    let contents = Folder::read(folder).map_err(Failure::usage)?;
    tell_of_damage(folder, &contents.damage, host);
    Ok((contents.manifest, contents.finished))
}

/// Says what is wrong with the files of a results folder.
pub fn tell_of_damage(folder: &Path, damage: &[String], host: &dyn Host) {
    /// More than these say the same.
    const TOLD: usize = 5;
    if damage.is_empty() {
        return;
    }
    let mut text = String::new();
    for told in damage.iter().take(TOLD) {
        text += &format!("warning: {told}\n");
    }
    let rest = damage.len().saturating_sub(TOLD);
    if rest > 0 {
        text += &format!("warning: so are {rest} more\n");
    }
    let folder = shell_file(&visible(&folder.to_string_lossy()));
    text +=
        &format!("`stochc verify {folder}` says what is sound; with `--repair`, it saves that\n");
    host.warn(&text);
}
