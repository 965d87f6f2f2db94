//! `stochc replay`.
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;

use super::chosen::{Choice, Chosen, choose, usage};
use super::terminal::print;
use crate::cli::Exit;
use crate::ensemble::stop_on_interrupt;
use crate::replay::{about, visible, write};

/// What `replay` is given.
#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    choice: Choice,
    /// The page to write; `DIR/replay-PROGRAM-N.html` if left out
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
    let program = &chosen.manifest.programs[chosen.program];
    let path = options.out.clone().unwrap_or_else(|| {
        // Its name may be any text, in a manifest that somebody has edited; an assembly's is a word.
        let programs = &chosen.manifest.programs;
        let twins = programs
            .iter()
            .filter(|twin| twin.assembly == program.assembly);
        let which = match twins.count() {
            1 => String::new(),
            _ => format!("-{}", chosen.program),
        };
        let name = format!("replay-{}{which}-{}.html", program.assembly, chosen.run);
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
    let program = &chosen.manifest.programs[chosen.program];
    let about = about(
        &chosen.manifest,
        program,
        &chosen.ready.tables,
        &chosen.graph,
    );
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder.tempfile_in(folder.unwrap_or(Path::new(".")))?;
    let mut out = BufWriter::new(file);
    write(title, &about, recording, &mut out)?;
    out.flush()?;
    let file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}
