//! `stochc replay`.
use std::io;
use std::path::PathBuf;

use clap::Args;
use stochc_compiler::LintLevels;
use stochc_ensemble::Program;
use stochc_ensemble::recording::Outline;
use stochc_ensemble::text::visible;
use stochc_files::atomic::{Draft, Replaces, begins_with};
use stochc_report::replay::{MARK, Statement, about, tour, write};

use super::chosen_run::{Choice, ChosenRun, choose};
use super::terminal::print;
use crate::command::interrupt::stop_on_interrupt;
use crate::exit::{Exit, Failure};

/// What `replay` is given.
#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    choice: Choice,
    /// Another run of the same program, to be shown beside it
    #[arg(long, value_name = "N")]
    against: Option<u64>,
    /// Begin with what decided how long the run took
    #[arg(long)]
    tour: bool,
    /// File to write [default: `DIR/replay-PROGRAM-N.html`, or `DIR/replay-PROGRAM-N-against-N.html`]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes the page that shows a run.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let stop = stop_on_interrupt()?;
    let chosen = choose(&options.choice)?;
    let other = match options.against {
        Some(run) if run == options.choice.run => {
            return Err(Failure::usage("`--against` needs another run than `--run`"));
        }
        Some(run) => Some(choose(&Choice {
            run,
            ..options.choice.clone()
        })?),
        None => None,
    };
    let path = options.out.clone().unwrap_or_else(|| {
        let beside = options.against.map(|run| format!("-against-{run}"));
        let ending = format!("{}.html", beside.unwrap_or_default());
        let name = chosen.file_name("replay-", &ending);
        options.choice.folder.join(name)
    });
    let cannot = |error| Failure::usage(format!("cannot write `{}`: {error}", path.display()));
    // Before the run, which may take long.
    let ours = Replaces::Ours(|file| begins_with(file, MARK.as_bytes()));
    let out = Draft::new(&path, ours).map_err(cannot)?;
    let recording = chosen.recording(stop)?;
    let beside = other.map(|other| other.recording(stop)).transpose()?;
    page(out, &chosen, recording, beside, options.tour).map_err(cannot)?;
    print(&format!("{}\n", path.display()))?;
    Ok(Exit::Success)
}

/// Writes the page as a whole or not at all.
fn page(
    mut out: Draft,
    chosen: &ChosenRun,
    mut recording: impl io::Read + io::Seek,
    beside: Option<impl io::Read>,
    guided: bool,
) -> io::Result<()> {
    let program = chosen.entry();
    let outline = Outline::read(&mut recording, program.tables()).map_err(io::Error::other)?;
    recording.rewind()?;
    let tour = tour(program, outline.record());
    let title = format!("{}, run {}", visible(&program.name), chosen.run);
    let about = about(
        &chosen.manifest,
        program,
        &statements(program),
        tour,
        guided,
    );
    write(&title, &about, recording, beside, &mut out)?;
    out.keep()
}

/// Events beyond which their places are not looked for.
const MOST_STATEMENTS: usize = 50_000;

/// Where each event of the graph is written; nothing, if the texts of the program are not here, or another compiler's.
fn statements(program: &Program) -> Vec<Statement> {
    let texts: Vec<(&str, &str)> = (program.sources.iter())
        .map(|source| (source.path.as_str(), source.text.as_str()))
        .collect();
    if texts.is_empty() || program.compiled.graph.events.len() > MOST_STATEMENTS {
        return Vec::new();
    }
    let checked = crate::check_texts(&texts, &LintLevels::default(), "", &[]);
    let mut same =
        (checked.programs.iter()).filter(|it| it.tables.as_ref() == Some(program.tables()));
    let Some(plan) = same.next().map(|program| &program.plan) else {
        return Vec::new();
    };
    let files: Vec<Option<usize>> = (checked.sources.files().iter())
        .map(|file| texts.iter().position(|(name, _)| *name == file.name))
        .collect();
    let places = (0..).zip(&plan.events).filter_map(|(event, written)| {
        let span = written.site.span;
        Some(Statement {
            file: files[written.site.file.0 as usize]?,
            bytes: span.start as usize..span.end as usize,
            event,
        })
    });
    places.collect()
}
