//! `stochc trade`.
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{ArgGroup, Args};
use stochc_ensemble::text::duration;
use stochc_ensemble::trade::{Extent, FINEST, MEMORY, Memory, Progress, Setup, Trade, measure};
use stochc_ensemble::{FolderError, JournalError, MOST_RUNS, Manifest, Program};
use stochc_files::atomic::{self, Replaces};
use stochc_report::figures::trade as trade_figure;
use stochc_report::tables::trade_to_text;
use stochc_runtime::Settings;

use super::imports::ImportOptions;
use super::interrupt::stop_on_interrupt;
use super::levels::LevelOptions;
use super::progress::{Display, of_trade};
use super::results::Form;
use super::simulate;
use super::terminal::{output_has_colour, output_width, print, print_drawn};
use crate::exit::{Exit, Failure};

/// What `trade` is given.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("extent").args(["runs", "budget"]))]
pub struct Options {
    /// Programs to simulate; with several, their ranking at each setting is compared as well
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    /// Time limit of the whole measurement, such as 90s, 10m or 2h [default: 10m]
    #[arg(long, value_name = "TIME", value_parser = duration)]
    budget: Option<Duration>,
    /// Make N runs of each program at each setting instead, however long they take
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=MOST_RUNS))]
    runs: Option<u64>,
    /// Seed of the random numbers, the same at every setting
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Stop a run after this many ticks; its time is then censored [default: 20 times the mean of the
    /// first runs]
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: Option<u64>,
    /// Refine the reference up to this many substeps
    #[arg(long, value_name = "SUBSTEPS", default_value_t = FINEST, value_parser = clap::value_parser!(u32).range(1..=1000))]
    finest: u32,
    /// Number of runs at the same time [default: number of cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Folder for `trade.json` and `trade.svg`; it must be new or empty
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Continue a trade in `--out` that was stopped or killed: its runs are not made again
    #[arg(long, requires = "out")]
    resume: bool,
    /// Output format of the table
    #[arg(long, value_name = "FORM", default_value = "text")]
    format: Form,
    /// Do not show progress
    #[arg(long, short)]
    quiet: bool,
    /// What becomes of warnings
    #[command(flatten)]
    levels: LevelOptions,
    #[command(flatten)]
    imports: ImportOptions,
}

/// Time for everything, where nobody says how long.
const BUDGET: Duration = Duration::from_secs(600);

/// Measures what accuracy costs.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let programs = simulate::programs(&options.files, &options.levels.levels, &options.imports)?;
    // Programs of the same name are told apart as in an ensemble.
    let manifest = Manifest::new(Settings::default(), options.seed, 1, programs);
    manifest.within_limits().map_err(Failure::usage)?;
    let programs = manifest.programs;
    let memory = match &options.out {
        Some(out) => {
            claim(out, options.resume).map_err(Failure::usage)?;
            let memory = Memory::open(out, &programs, options.seed);
            Some(memory.map_err(|error| cannot_go_on(out, &error))?)
        }
        None => None,
    };
    let stop = stop_on_interrupt()?;
    let extent = match (options.runs, options.budget) {
        (Some(runs), _) => Extent::Runs(runs),
        (None, budget) => Extent::Budget(budget.unwrap_or(BUDGET)),
    };
    let setup = Setup {
        extent,
        seed: options.seed,
        threads: threads(options.threads).get(),
        finest: options.finest,
        max_ticks: options.max_ticks,
        memory: memory.as_ref(),
        stop,
    };
    let trade = of(&programs, &setup, options.quiet)?;
    // What is kept is kept before anything is said: nobody may be there to listen.
    if let (Some(out), Some(memory)) = (&options.out, memory) {
        let cannot = |error: &dyn std::fmt::Display| {
            Failure::usage(format!("cannot write to `{}`: {error}", out.display()))
        };
        memory.close().map_err(|error| cannot(&error))?;
        keep(out, &trade).map_err(|error| cannot(&error))?;
    }
    match options.format {
        Form::Text => print_drawn(&trade_to_text(&trade, output_width(), output_has_colour()))?,
        Form::Json => print(&trade.to_json())?,
    }
    if trade.complete {
        return Ok(Exit::Success);
    }
    Err(Failure {
        exit: Exit::Interrupted,
        message: "stopped; this is what was measured until then\n".to_owned(),
    })
}

/// Measures programs, and shows how far it is.
pub(super) fn of(programs: &[Program], setup: &Setup, quiet: bool) -> Result<Trade, Failure> {
    let progress = Progress::default();
    let state = |elapsed| of_trade(setup.extent, &progress, elapsed);
    let display = Display::on_standard_error(quiet);
    let trade = display.during(state, || measure(programs, setup, &progress));
    trade.map_err(|(program, error)| {
        Failure::wrong_program(format!("{}: {error}", programs[program].name))
    })
}

/// How many runs to do at the same time.
pub(super) fn threads(asked: Option<u16>) -> NonZeroUsize {
    let cores = || std::thread::available_parallelism().ok();
    let threads = asked.map_or_else(cores, |asked| NonZeroUsize::new(asked.into()));
    threads.unwrap_or(NonZeroUsize::MIN)
}

fn cannot_go_on(out: &Path, error: &FolderError) -> Failure {
    let shown = out.display();
    Failure::usage(match error {
        FolderError::Journal(JournalError::Foreign) => format!(
            "`{shown}` holds the trade of other programs, of another seed or of another build of `stochc`; choose \
             another folder"
        ),
        error => error.to_string(),
    })
}

/// Makes a folder, or takes an empty one; to `resume`, one that holds a trade.
pub(super) fn claim(out: &Path, resume: bool) -> Result<(), String> {
    let shown = out.display();
    let io = |error: std::io::Error| format!("cannot use `{shown}`: {error}");
    if out.exists() && !out.is_dir() {
        return Err(format!(
            "`{shown}` is a file; choose another name for the folder"
        ));
    }
    atomic::make_folder(out).map_err(io)?;
    let is_ours = out.join(MEMORY).is_file();
    let mut entries = std::fs::read_dir(out).map_err(io)?;
    match entries.next() {
        None => Ok(()),
        Some(_) if is_ours && resume => Ok(()),
        Some(_) if is_ours => Err(format!(
            "`{shown}` is not empty; choose an empty or a new folder, or go on with the trade in it by `--resume`"
        )),
        Some(_) => Err(format!(
            "`{shown}` is not empty; choose an empty or a new folder"
        )),
    }
}

fn keep(out: &Path, trade: &Trade) -> std::io::Result<()> {
    let files = [
        ("trade.json", trade.to_json()),
        ("trade.svg", trade_figure(trade).file()),
    ];
    let mut files = files.iter();
    files.try_for_each(|(name, text)| {
        atomic::replace(&out.join(name), text.as_bytes(), Replaces::Ordinary)
    })
}
