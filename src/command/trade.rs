//! `stochc trade`.
use std::path::PathBuf;
use std::time::Duration;

use clap::{ArgGroup, Args};
use stochc_ensemble::text::words;
use stochc_ensemble::trade::{Extent, FINEST, Setup};
use stochc_ensemble::{EnsembleProgram, MOST_RUNS, Manifest};
use stochc_ir::counted;
use stochc_report::tables::trade_to_text;
use stochc_runtime::Settings;

use super::figures::FigureOptions;
use super::host::Terminal;
use super::imports::ImportOptions;
use super::interrupt::stop_on_interrupt;
use super::levels::LevelOptions;
use super::run_options::MeasuringOptions;
use super::show::ResultsFormat;
use super::terminal::{output_has_colour, output_width, print, print_drawn};
use crate::exit::{Exit, Failure};
use crate::operations::forecast::forecast_to_text;
use crate::operations::programs::programs;
use crate::operations::runs::threads;
use crate::operations::time;
use crate::operations::trade::{forecast, keep, measured, memory};

/// What `trade` is given.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("extent").args(["runs", "budget"]))]
#[command(mut_arg("figures", |it| it.requires("out")), mut_arg("figure_format", |it| it.requires("out")))]
pub struct TradeArguments {
    /// Programs to simulate; with several, their ranking at each setting is compared as well
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    /// Time limit of the whole measurement, such as 90s, 10m or 2h [default: 10m]
    #[arg(long, value_name = "TIME", value_parser = time)]
    budget: Option<Duration>,
    /// Make N runs of each program at each setting instead, however long they take
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=MOST_RUNS))]
    runs: Option<u64>,
    /// Stop a run after this many ticks; its time is then censored [default: 20 times the mean of the
    /// first runs]
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: Option<u64>,
    /// Refine the reference up to this many substeps
    #[arg(long, value_name = "SUBSTEPS", default_value_t = FINEST, value_parser = clap::value_parser!(u32).range(1..=1000))]
    finest: u32,
    /// Folder for `trade.json` and the figure `trade.svg`; it must be new or empty
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// What its figure is like.
    #[command(flatten)]
    figures: FigureOptions,
    /// Continue a trade in `--out` that was stopped or killed: its runs are not made again
    #[arg(long, requires = "out")]
    resume: bool,
    /// Print the expected CPU time, and measure nothing
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    measuring: MeasuringOptions,
    /// What becomes of warnings
    #[command(flatten)]
    levels: LevelOptions,
    #[command(flatten)]
    imports: ImportOptions,
}

/// Time for everything, where nobody says how long.
const BUDGET: Duration = Duration::from_secs(600);

/// Returns the CPU time that a trade will take, as a line of text.
fn expected(
    programs: &[EnsembleProgram],
    setup: &Setup<'_>,
    threads: Option<u16>,
    host: &Terminal,
) -> Result<String, Failure> {
    Ok(match setup.extent {
        Extent::Runs(runs) => forecast_to_text(&forecast(programs, setup, runs, host)?, threads),
        Extent::Budget(time) => format!(
            "at most {}, the time limit, on {}: {} of CPU time\n",
            words(time),
            counted(setup.threads, "thread"),
            words(time * setup.threads as u32)
        ),
    })
}

/// Measures what accuracy costs.
pub fn run(options: &TradeArguments) -> Result<Exit, Failure> {
    let MeasuringOptions {
        chance,
        format,
        work,
    } = &options.measuring;
    let (seed, host) = (chance.seed, Terminal::new(work.quiet));
    let (levels, imports) = (&options.levels.levels, &options.imports.folders);
    let programs = programs(&options.files, levels, imports, &host)?;
    // Programs of the same name are told apart as in an ensemble.
    let manifest = Manifest::new(Settings::default(), seed, 1, programs);
    manifest.within_limits().map_err(Failure::usage)?;
    let programs = manifest.programs;
    let stop = stop_on_interrupt()?;
    let extent = match (options.runs, options.budget) {
        (Some(runs), _) => Extent::Runs(runs),
        (None, budget) => Extent::Budget(budget.unwrap_or(BUDGET)),
    };
    let mut setup = Setup {
        extent,
        seed,
        threads: threads(work.threads).get(),
        finest: options.finest,
        max_ticks: options.max_ticks,
        memory: None,
        stop,
    };
    if options.dry_run {
        print(&expected(&programs, &setup, work.threads, &host)?)?;
        return Ok(Exit::Success);
    }
    let out = options.out.as_deref();
    let memory = memory(out, options.resume, &programs, seed)?;
    setup.memory = memory.as_ref();
    let trade = measured(&programs, &setup, &host)?;
    // What is kept is kept before anything is said: nobody may be there to listen.
    if let (Some(out), Some(memory)) = (&options.out, memory) {
        keep(out, memory, &trade, &options.figures.figures())?;
    }
    match format {
        ResultsFormat::Text => {
            print_drawn(&trade_to_text(&trade, output_width(), output_has_colour()))?
        }
        ResultsFormat::Json => print(&trade.to_json())?,
    }
    if trade.complete {
        return Ok(Exit::Success);
    }
    Err(Failure {
        exit: Exit::Interrupted,
        message: "stopped; this is what was measured until then\n".to_owned(),
    })
}
