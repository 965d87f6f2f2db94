//! The page that shows a run.
use std::io::{self, Read, Write};
use std::path::Path;

use stochc_ensemble::text::visible;
use stochc_files::atomic::{Draft, Replaces, begins_with};
use stochc_report::replay::{MARK, about, write as write_page};

use super::chosen_run::ChosenRun;
use crate::exit::Failure;
use crate::host::Host;

/// Writes the page of a run as a whole or not at all.
///
/// # Errors
/// If the run cannot be shown, or the file cannot be written.
pub fn write(chosen: &ChosenRun, path: &Path, host: &dyn Host) -> Result<(), Failure> {
    let cannot = |error| Failure::usage(format!("cannot write `{}`: {error}", path.display()));
    // Before the run, which may take long.
    let ours = Replaces::Ours(|file| begins_with(file, MARK.as_bytes()));
    let mut out = Draft::new(path, ours).map_err(cannot)?;
    let recording = chosen.recording(host)?;
    to(&mut out, chosen, recording).map_err(cannot)?;
    out.keep().map_err(cannot)
}

/// The page of a run.
///
/// # Errors
/// If the run cannot be shown.
pub fn page(chosen: &ChosenRun, host: &dyn Host) -> Result<String, Failure> {
    let recording = chosen.recording(host)?;
    let mut page = Vec::new();
    to(&mut page, chosen, recording).map_err(Failure::usage)?;
    String::from_utf8(page).map_err(Failure::usage)
}

fn to(out: &mut impl Write, chosen: &ChosenRun, recording: impl Read) -> io::Result<()> {
    let program = chosen.entry();
    let title = format!("{}, run {}", visible(&program.name), chosen.run);
    let about = about(&chosen.manifest, program);
    write_page(&title, &about, recording, out)
}
