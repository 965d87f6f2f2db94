//! `stochc fit`.
use std::path::{Path, PathBuf};

use clap::Args;
use stochc_ensemble::fit::{
    Design, Emulator, Fit, MeasuredProgram, Observed, Posterior, Prior, Simulated, Unit,
};
use stochc_ensemble::{EnsembleProgram, Manifest, completion_time};
use stochc_files::atomic::Replaces;
use stochc_files::budget::TIMES;
use stochc_files::read_file;
use stochc_report::figures::{Figures, fit as fit_figure};
use stochc_report::tables::fit_to_text;
use stochc_runtime::{Settings, Substeps};

use super::figures::FigureOptions;
use super::host::Terminal;
use super::imports::ImportOptions;
use super::interrupt::stop_on_interrupt;
use super::levels::LevelOptions;
use super::measuring::MeasuringOptions;
use super::results::ResultsFormat;
use super::terminal::{output_width, print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::in_memory::all_runs;
use crate::operations::programs::programs;
use crate::operations::sweep::{at_point, share_tables};
use crate::operations::trade::claim;

/// What `fit` is given.
#[derive(Debug, Args)]
#[command(mut_arg("figures", |it| it.requires("out")), mut_arg("figure_format", |it| it.requires("out")))]
pub struct Options {
    /// Programs whose times were measured
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    /// Measured times (CSV): `program,ticks` with a row for each run, or `program,n,mean_ticks,sd_ticks`; `seconds` in
    /// place of ticks
    #[arg(long, value_name = "FILE.csv")]
    data: PathBuf,
    /// A number of the scene to find, and the range that it may be in: `bond.pull=2..12 N`, `free=50..500 log`
    #[arg(long, value_name = "NAME=RANGE", required = true, value_parser = Prior::parse)]
    vary: Vec<Prior>,
    /// Predict the times of this program, and do not use them
    #[arg(long, value_name = "PROGRAM")]
    hold_out: Vec<String>,
    /// Simulate at so many points in each round [default: three for each coefficient of the polynomials]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(8..=200))]
    points: Option<u16>,
    /// Rounds, each within what the one before has left
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=10))]
    rounds: u8,
    /// Runs of each program at each point
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u64).range(4..=10_000))]
    runs: u64,
    /// Steps of the model in each tick; `1/8`: one, and eight for blocks near magnetized faces
    #[arg(long, value_name = "STEPS", default_value_t = Substeps::DEFAULT)]
    substeps: Substeps,
    /// Stop a run after this many ticks; its time then counts for nothing, and is told of
    #[arg(long, value_name = "TICKS", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: u64,
    /// Folder for `fit.json` and the figure `fit.svg`; it must be new or empty
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// What its figure is like.
    #[command(flatten)]
    figures: FigureOptions,
    #[command(flatten)]
    measuring: MeasuringOptions,
    /// What becomes of warnings
    #[command(flatten)]
    levels: LevelOptions,
    #[command(flatten)]
    imports: ImportOptions,
}

/// Finds numbers of scenes that measured times speak for.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let (unit, observed) = data(&options.data)?;
    let host = Terminal::new(options.measuring.work.quiet);
    let (levels, imports) = (&options.levels.levels, &options.imports.folders);
    let programs = programs(&options.files, levels, imports, &host)?;
    let measured = matched(programs, observed, &options.hold_out)?;
    distinct(&options.vary)?;
    for (program, _) in &measured {
        for prior in &options.vary {
            // Both ends have to be values that the scene may have.
            for share in [0.0, 1.0] {
                prior
                    .varied(share, &program.scene)
                    .map_err(Failure::usage)?;
            }
        }
    }
    if let Some(out) = &options.out {
        claim(out, false).map_err(Failure::usage)?;
    }
    stop_on_interrupt()?;
    let fit = rounds(options, &measured, unit, &host)?;
    match options.measuring.format {
        ResultsFormat::Text => print(&fit_to_text(&fit, &options.vary, output_width()))?,
        ResultsFormat::Json => print(&json(&fit))?,
    }
    if let Some(out) = &options.out {
        keep(out, &fit, &options.vary, &options.figures.figures())?;
    }
    Ok(Exit::Success)
}

/// A program, and what was measured of it; whether that is used.
type Known = (EnsembleProgram, (Observed, bool));

fn data(path: &Path) -> Result<(Unit, Vec<Observed>), Failure> {
    let shown = path.display();
    let bytes = read_file(path, TIMES)
        .map_err(|error| Failure::usage(format!("cannot read `{shown}`: {error}")))?;
    Observed::read(&bytes).map_err(|error| Failure::usage(format!("`{shown}`: {error}")))
}

/// Holds names against names: everything that was measured has a program, and the other way round.
fn matched(
    programs: Vec<EnsembleProgram>,
    mut observed: Vec<Observed>,
    held_out: &[String],
) -> Result<Vec<Known>, Failure> {
    let mut known = Vec::new();
    for program in programs {
        let place = observed.iter().position(|it| it.program == program.name);
        let Some(place) = place else {
            let name = &program.name;
            return Err(Failure::usage(format!(
                "the data say nothing of `{name}`; leave its file out, or give its times"
            )));
        };
        if program.sources.is_empty() {
            return Err(Failure::usage(format!(
                "`{}` is compiled already; name the file of its text instead",
                program.name
            )));
        }
        let of = observed.remove(place);
        let is_fitted = !held_out.contains(&of.program);
        known.push((program, (of, is_fitted)));
    }
    if let Some(left) = observed.first() {
        return Err(Failure::usage(format!(
            "the data have times of `{}`, and no file declares it",
            left.program
        )));
    }
    if let Some(name) = held_out
        .iter()
        .find(|&name| known.iter().all(|(it, _)| it.name != *name))
    {
        return Err(Failure::usage(format!(
            "--hold-out: no file declares `{name}`"
        )));
    }
    match known.iter().any(|(_, (_, is_fitted))| *is_fitted) {
        true => Ok(known),
        false => Err(Failure::usage("--hold-out: no program is left to fit to")),
    }
}

fn distinct(priors: &[Prior]) -> Result<(), Failure> {
    for (i, prior) in priors.iter().enumerate() {
        if priors[..i].iter().any(|other| other.of == prior.of) {
            return Err(Failure::usage(format!(
                "--vary: `{}` is given twice",
                prior.of
            )));
        }
    }
    Ok(())
}

/// Simulates at the points of each round, and draws conclusions.
fn rounds(
    options: &Options,
    measured: &[Known],
    unit: Unit,
    host: &Terminal,
) -> Result<Fit, Failure> {
    let priors = &options.vary;
    let numbers = priors.len();
    let least = Emulator::terms(numbers) + 2;
    let points = options
        .points
        .map_or(3 * Emulator::terms(numbers), usize::from);
    if points < least {
        return Err(Failure::usage(format!(
            "--points: {numbers} numbers need {least} points at least"
        )));
    }
    let mut ends = vec![(0.0, 1.0); numbers];
    let mut all: Vec<Vec<Simulated>> = vec![Vec::new(); measured.len()];
    let (mut posterior, mut stopped) = (None, 0);
    for round in 0..u64::from(options.rounds) {
        let seed = options
            .measuring
            .chance
            .seed
            .wrapping_add(1_000_000 * round);
        let design = Design::latin_hypercube(&ends, points, seed);
        let (new, lost) = simulated(options, measured, unit, (&design, seed), host)?;
        stopped += lost;
        for (all, new) in all.iter_mut().zip(new) {
            all.extend(new);
        }
        let emulators: Option<Vec<Emulator>> = (all.iter())
            .map(|points| {
                // Further away, a polynomial would bend for what does not matter any more.
                let near = points.iter().filter(|point| point.is_within(&ends));
                Emulator::of(&near.cloned().collect::<Vec<_>>())
            })
            .collect();
        let Some(emulators) = emulators else {
            return Err(Failure::error(
                Exit::UnsuccessfulRun,
                "at too few points do the runs complete: narrow the ranges, or raise `--max-ticks`",
            ));
        };
        let known = emulators.iter().zip(measured);
        let known: Vec<MeasuredProgram> = known
            .map(|(emulator, (_, (observed, is_fitted)))| MeasuredProgram {
                observed,
                is_fitted: *is_fitted,
                emulator,
            })
            .collect();
        let found = Posterior::of(&ends, &known, seed);
        ends = found.surroundings();
        let predictions = known.iter().map(|it| found.predict(it)).collect();
        posterior = Some((found, predictions));
    }
    let (posterior, predictions): (Posterior, Vec<_>) =
        posterior.expect("there is one round at least");
    let marginals = priors.iter().enumerate();
    Ok(Fit {
        unit,
        numbers: marginals
            .map(|(i, prior)| posterior.marginal(i, prior))
            .collect(),
        correlations: posterior.correlations(),
        predictions,
        points: points * usize::from(options.rounds),
        runs: points * usize::from(options.rounds) * measured.len() * options.runs as usize,
        stopped,
        draws: posterior.values(priors),
    })
}

/// The times of every program at every point of a design, and how many runs were stopped.
fn simulated(
    options: &Options,
    measured: &[Known],
    unit: Unit,
    (design, seed): (&Design, u64),
    host: &Terminal,
) -> Result<(Vec<Vec<Simulated>>, usize), Failure> {
    let entries = at_points(options, measured, design, host)?;
    let settings = Settings {
        max_ticks: Some(options.max_ticks),
        ..Settings::default().with_steps(options.substeps)
    };
    let manifest = Manifest::new(settings, seed, options.runs, entries);
    let points = design.points.len();
    let results = all_runs(
        &manifest,
        options.measuring.work.threads,
        "nothing was fitted",
        host,
    )?;
    let mut found: Vec<Vec<Simulated>> = vec![Vec::new(); measured.len()];
    let mut stopped = 0;
    let mut observed = vec![Vec::new(); manifest.programs.len()];
    let read = results.finished.each(|done| {
        let time = completion_time(&done.record).filter(|time| time.completed);
        observed[done.program].extend(time.map(|time| time.time));
    });
    read.map_err(Failure::usage)?;
    for (entry, program) in manifest.programs.iter().enumerate() {
        let scale = match unit {
            Unit::Ticks => 1.0,
            Unit::Seconds => program.scene.tick,
        };
        let times: Vec<f64> = observed[entry].iter().map(|time| time * scale).collect();
        stopped += options.runs as usize - times.len();
        // A point where many runs are stopped has times of the fast ones.
        if times.len() * 10 >= options.runs as usize * 9 {
            let at = design.points[entry % points].clone();
            found[entry / points].push(Simulated { at, times });
        }
    }
    Ok((found, stopped))
}

/// Each program at each point, the points of the first program first.
fn at_points(
    options: &Options,
    measured: &[Known],
    design: &Design,
    host: &Terminal,
) -> Result<Vec<EnsembleProgram>, Failure> {
    let mut entries = Vec::new();
    for (program, _) in measured {
        for point in &design.points {
            let mut entry = program.clone();
            let pairs = options.vary.iter().zip(point);
            let varied: Result<_, String> = pairs
                .map(|(prior, share)| prior.varied(*share, &program.scene))
                .collect();
            entry.varied = varied.map_err(Failure::usage)?;
            entry.name += &entry.point();
            at_point(&mut entry, &options.levels.levels, host)?;
            entries.push(entry);
        }
    }
    share_tables(&mut entries);
    Ok(entries)
}

fn json(fit: &Fit) -> String {
    let text = serde_json::to_string_pretty(fit).expect("a fit is plain data");
    text + "\n"
}

fn keep(out: &Path, fit: &Fit, priors: &[Prior], figures: &Figures) -> Result<(), Failure> {
    let drawn = figures.files(&fit_figure(figures.medium, fit, priors));
    let mut files = drawn.map_err(Failure::usage)?;
    files.push(("fit.json".to_owned(), json(fit).into_bytes()));
    for (name, content) in files {
        let path = out.join(name);
        stochc_files::atomic::replace(&path, &content, Replaces::Nothing)
            .map_err(|error| Failure::not_written(&path, error))?;
    }
    if fit.stopped > 0 {
        warn(&format!(
            "note: {} of {} runs were stopped before they completed, and count for nothing\n",
            fit.stopped, fit.runs
        ));
    }
    Ok(())
}
