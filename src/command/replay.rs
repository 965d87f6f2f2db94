//! `stochc replay`.
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use clap::Args;

use super::chosen::{Choice, Chosen, choose};
use super::export::keep;
use super::terminal::{print, usage};
use crate::cli::Exit;
use crate::ensemble::stop_on_interrupt;
use crate::figures::visible;
use crate::files::atomic::draft;
use crate::replay::{about, write};

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
pub fn run(options: &Options) -> Exit {
    let stop = match stop_on_interrupt() {
        Ok(stop) => stop,
        Err(error) => return usage(&format!("cannot listen for Ctrl-C: {error}")),
    };
    let recorded = choose(&options.choice).and_then(|chosen| {
        let recording = chosen.recording(stop)?;
        Ok((chosen, recording))
    });
    let (chosen, recording) = match recorded {
        Ok(recorded) => recorded,
        Err(exit) => return exit,
    };
    let program = chosen.entry();
    let path = options.out.clone().unwrap_or_else(|| {
        let name = chosen.file_name("replay-", "html");
        options.choice.folder.join(name)
    });
    let title = format!("{}, run {}", visible(&program.name), chosen.run);
    match page(&path, &title, &chosen, recording) {
        Ok(()) => {
            print(&format!("{}\n", path.display()));
            Exit::Success
        }
        Err(error) => usage(&format!("cannot write `{}`: {error}", path.display())),
    }
}

/// Writes the page as a whole or not at all.
fn page(path: &Path, title: &str, chosen: &Chosen, recording: impl io::Read) -> io::Result<()> {
    let program = chosen.entry();
    let about = about(&chosen.manifest, program);
    let mut out = BufWriter::new(draft(path)?);
    write(title, &about, recording, &mut out)?;
    keep(out, path)
}
