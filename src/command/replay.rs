//! `stochc replay`.
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use clap::Args;
use stochc_ensemble::text::visible;
use stochc_files::atomic::draft;
use stochc_report::replay::{about, write};

use super::chosen_run::{Choice, ChosenRun, choose};
use super::export::keep;
use super::terminal::print;
use crate::command::interrupt::stop_on_interrupt;
use crate::exit::{Exit, Failure};

/// What `replay` is given.
#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    choice: Choice,
    /// File to write [default: `DIR/replay-PROGRAM-N.html`]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes the page that shows a run.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let stop = stop_on_interrupt()?;
    let chosen = choose(&options.choice)?;
    let recording = chosen.recording(stop)?;
    let program = chosen.entry();
    let path = options.out.clone().unwrap_or_else(|| {
        let name = chosen.file_name("replay-", "html");
        options.choice.folder.join(name)
    });
    let title = format!("{}, run {}", visible(&program.name), chosen.run);
    page(&path, &title, &chosen, recording)
        .map_err(|error| Failure::usage(format!("cannot write `{}`: {error}", path.display())))?;
    print(&format!("{}\n", path.display()))?;
    Ok(Exit::Success)
}

/// Writes the page as a whole or not at all.
fn page(path: &Path, title: &str, chosen: &ChosenRun, recording: impl io::Read) -> io::Result<()> {
    let program = chosen.entry();
    let about = about(&chosen.manifest, program);
    let mut out = BufWriter::new(draft(path)?);
    write(title, &about, recording, &mut out)?;
    keep(out, path)
}
