//! `stochc test`.
use clap::{Args, ValueEnum};
use serde_json::json;
use stochc_experiments::Verdict;
use stochc_report::tables::{ReportedClaim, claims_to_text};
use stochc_results::MAX_RUNS;
use stochc_text::share;

use super::ensemble::ProgramOptions;
use super::host::Terminal;
use super::interrupt::stop_on_interrupt;
use super::junit::claims_to_junit;
use super::run_options::{JsonOption, ThreadsOption};
use super::terminal::{output_width, print};
use crate::exit::{Exit, Failure};
use crate::operations::claims::{ClaimOptions, tested_claims};
use crate::operations::json::document;
use crate::operations::programs::programs;
use crate::operations::rates::{rates_for_scenes, read_rates_for};
use stochc_runtime::Model;

/// Arguments of `test`.
#[derive(Debug, Args)]
#[command(mut_arg("model", |it| it.help("Model of the motion of blocks [default: `rate` if its errors cannot change the verdict, otherwise `rigid`]")))]
pub struct TestArguments {
    #[command(flatten)]
    programs: ProgramOptions,
    /// Largest probability that any claim is decided wrongly
    #[arg(long, value_name = "SHARE", default_value = "5%", value_parser = share, help_heading = "Test")]
    alpha: f64,
    /// Allow any decision about a probability that differs from its bound by less than this. A margin makes tests shorter
    #[arg(long, value_name = "SHARE", value_parser = share, help_heading = "Test")]
    margin: Option<f64>,
    /// Largest number of runs of each program
    #[arg(long, short = 'n', value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=MAX_RUNS), help_heading = "Test")]
    runs: u64,
    #[command(flatten)]
    work: ThreadsOption,
    /// Format of the verdicts
    #[arg(
        long,
        value_name = "FORMAT",
        default_value = "text",
        conflicts_with = "json",
        help_heading = "Output"
    )]
    format: Format,
    #[command(flatten)]
    output: JsonOption,
}

/// Format of the verdicts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Table
    Text,
    /// The same as `--json`
    Json,
    /// XML for continuous integration. A test case for each claim
    Junit,
}

pub fn run(options: &TestArguments) -> Result<Exit, Failure> {
    let host = Terminal::default();
    let given = &options.programs;
    if options.alpha >= 0.5 {
        return Err(Failure::usage("--alpha must be below 50 %"));
    }
    let is_model_given = given.model.gives("model");
    let mut settings = given.model.settings();
    if is_model_given {
        given.model.are_used(&settings)?;
    }
    settings = settings.resolved();
    let mut source = given.source.settings();
    source.levels = source.levels.for_runs(settings.stepping());
    let programs = programs(&given.files, &source, &host)?;
    stop_on_interrupt()?;
    let scenes = programs.iter().map(|it| &it.scene);
    let rates = read_rates_for(&given.model.rates, scenes, &host)?;
    if settings.model == Model::Rate {
        settings.rates = rates_for_scenes(&rates, &programs, options.work.threads, &host)?;
    }
    let how = ClaimOptions {
        alpha: options.alpha,
        margin: options.margin.unwrap_or(0.0),
        tries_rates: !is_model_given,
        settings,
        rates,
        runs: options.runs,
        seed: given.chance.seed,
        threads: options.work.threads,
    };
    let claims = tested_claims(&programs, &how, &host)?;
    let format = if options.output.json {
        Format::Json
    } else {
        options.format
    };
    print(&match format {
        Format::Text => claims_to_text(&claims, output_width()),
        Format::Json => {
            let claims: Vec<_> = claims.iter().map(ReportedClaim::to_json).collect();
            document(json!({ "alpha": options.alpha, "claims": claims }))
        }
        Format::Junit => claims_to_junit(&claims).map_err(Failure::usage)?,
    })?;
    let hold = claims.iter().all(|it| it.tested.verdict == Verdict::Holds);
    Ok(Exit::from_runs(hold))
}
