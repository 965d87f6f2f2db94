//! `stochc check`.
mod cost;
mod exhaustive;
mod fix;
mod scene;

use std::path::PathBuf;

use clap::Args;
use stochc_compiler::diagnostic::Diagnostic;
use stochc_compiler::order::Order;
use stochc_compiler::{Checked, Limits, Program, check_with};
use stochc_files::programs::{STDIN, programs};
use stochc_ir::emit::chain_text;
use stochc_ir::{counted, visible};
use stochc_runtime::rates::Rates;

use self::cost::{costs, summed_up};
use self::scene::scenes;
use super::imports::ImportOptions;
use super::levels::LevelOptions;
use super::terminal::{exit_of, has_colour, message_width, print, warn, warn_drawn};
use crate::diagnostics::{FindingCounts, Format, SarifLog, json_document, show, values};
use crate::exit::{Exit, Failure};
use crate::operations::programs::verdict;
use crate::operations::rates::{UnusedRates, of_files};
use crate::reader::DiskReader;

/// What `check` is given.
#[derive(Debug, Args)]
pub struct CheckArguments {
    /// Programs to check, or folders with programs (`*.sa`) in them; `-` is the standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,
    /// Output format of the findings; all but `graphical` write to standard output
    #[arg(long, value_name = "FORM", default_value = "graphical")]
    format: Format,
    /// Print how deep and wide each phase is and, by the rates of the scene, how long it takes, and what decides that: the N
    /// captures that are waited for longest [default: 10]
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "10", value_parser = at_least_one)]
    cost: Option<usize>,
    /// Rates of scenes for `--cost`, by `stochc calibrate --out`; those of the default scene come with the program, and others are guessed
    #[arg(long, value_name = "FILE.rates", requires = "cost")]
    rates: Vec<PathBuf>,
    /// Print the physics of the scenes of programs without errors: terms, values, absent terms, and
    /// whether the default number of steps in a tick resolves them. Its warnings do not change the
    /// exit status. With `--format json` the document is `{ findings, scenes }`
    #[arg(long)]
    scene: bool,
    /// Apply all safe fixes, and show them as a diff
    #[arg(long)]
    fix: bool,
    /// Show what `--fix` would change without writing it
    #[arg(long, requires = "fix")]
    dry_run: bool,
    #[command(flatten)]
    levels: LevelOptions,
    #[command(flatten)]
    imports: ImportOptions,
    /// Also execute the event tables in every order of messages and captures, up to STATES states
    /// [default: 1000000]; larger programs are executed in random orders
    #[arg(
        long,
        value_name = "STATES",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "1000000",
        value_parser = clap::value_parser!(u64).range(1..)
    )]
    exhaustive: Option<u64>,
}

/// A number of captures to show.
fn at_least_one(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|&number: &usize| number > 0);
    number.ok_or_else(|| {
        "give a whole number from 1, or the file before it: `FILE --cost`".to_owned()
    })
}

/// Checks each file, and says of the right ones what is known before anything moves.
pub fn run(options: &CheckArguments) -> Result<Exit, Failure> {
    let is_written = options.fix && !options.dry_run && options.format != Format::Graphical;
    if is_written && options.files.iter().any(|file| file == STDIN) {
        return Err(Failure::usage(
            "`--fix -` writes the program itself to the standard output, where `--format` puts the findings: \
             leave one of the two out, or add `--dry-run`",
        ));
    }
    let rates = of_files(&options.rates)?;
    let mut unused = UnusedRates::new(&options.rates, &rates);
    let mut exit = Exit::Success;
    let mut document = Vec::new();
    let mut physics = Vec::new();
    let mut log = SarifLog::new(std::env::current_dir().ok().as_deref());
    let mut tally = FindingCounts::default();
    for file in programs(&options.files) {
        let file = match &file {
            Ok(file) => file,
            Err(reason) => {
                exit = exit.or_worse(exit_of(Err(Failure::usage(reason))));
                continue;
            }
        };
        let mut text = None;
        if options.fix
            && let Some(ended) = fix::run(file, options, &mut exit, &mut text)?
        {
            exit = exit.or_worse(ended);
            continue;
        }
        // What is said of a program does not go where the program itself does.
        let is_output_taken = text.is_some();
        let say = |said: &str| match is_output_taken {
            true => {
                warn(said);
                Ok(())
            }
            false => print(said),
        };
        let checked = check(file, text, options);
        let shown = || show(&checked, options.format, has_colour(), message_width());
        match options.format {
            // A machine reads the findings, a person the summary.
            Format::Short => print(&shown())?,
            Format::Json => document.extend(values(&checked)),
            Format::Sarif => log.add(file, &checked),
            Format::Graphical => {
                warn_drawn(&shown());
                tally.add(&checked);
                if !checked.has_errors() {
                    say(&summary(file, &checked, options.cost, &rates))?;
                }
            }
        }
        exit = exit.or_worse(verdict(&checked));
        if options.cost.is_some() && options.format != Format::Graphical && !checked.has_errors() {
            warn(&summary(file, &checked, options.cost, &rates));
        }
        let of_programs = checked
            .programs
            .iter()
            .filter_map(|program| program.scene.as_ref());
        unused.not_of(of_programs);
        if options.scene && !checked.has_errors() {
            for scene in scenes(file, &checked) {
                match options.format {
                    Format::Graphical => say(&scene.text())?,
                    Format::Short | Format::Sarif => warn(&scene.text()),
                    Format::Json => physics.push(scene.json()),
                }
            }
        }
        if let Some(states) = options.exhaustive.filter(|_| !checked.has_errors()) {
            let (said, found) = exhaustive::explore(file, &checked, states);
            match options.format {
                Format::Graphical => say(&said)?,
                Format::Short | Format::Json | Format::Sarif => warn(&said),
            }
            exit = exit.or_worse(found);
        }
    }
    unused.notes().for_each(|note| warn(&note));
    match options.format {
        Format::Json if options.scene => {
            let all = serde_json::json!({ "findings": document, "scenes": physics });
            print(&format!("{all:#}\n"))?;
        }
        Format::Json => print(&json_document(document))?,
        Format::Sarif => print(&log.document())?,
        Format::Graphical => warn(&tally.line()),
        Format::Short => {}
    }
    Ok(exit)
}

/// Checks a program, which has another text than the one to read if `text` says so.
fn check(file: &str, text: Option<Vec<u8>>, options: &CheckArguments) -> Checked {
    let mut reader = DiskReader::new(file, text.as_deref(), &options.imports.folders);
    let levels = &options.levels.levels;
    check_with(file, &mut reader, Limits::default(), levels)
}

fn summary(file: &str, checked: &Checked, cost: Option<usize>, rates: &[Rates]) -> String {
    let file = visible(file);
    if checked.programs.is_empty() {
        let verdict = judgement(checked, |_| true);
        return format!("{file}: {verdict}; it declares no assembly or aggregate\n");
    }
    let mut out = String::new();
    for (place, program) in checked.programs.iter().enumerate() {
        let verdict = judgement(checked, |finding| finding.programs.contains(&place));
        out.push_str(&format!("{file}: {}", describe(program, checked, &verdict)));
        if cost.is_none() {
            out.push_str(&summed_up(program, rates));
        }
        out.push_str(&costs(program, &checked.symbols, cost, rates));
    }
    let of_file = |finding: &Diagnostic| finding.programs.is_empty();
    let allowed = checked.allowed.iter().map(|allowed| &allowed.diagnostic);
    if checked.diagnostics.iter().chain(allowed).any(of_file) {
        let verdict = judgement(checked, of_file);
        out.push_str(&format!(
            "{file}: outside of assemblies and aggregates: {verdict}\n"
        ));
    }
    out
}

/// What can be said of a file without errors, or of a part of it: whether its findings are `part`.
fn judgement(checked: &Checked, part: impl Fn(&Diagnostic) -> bool) -> String {
    let warnings = checked
        .diagnostics
        .iter()
        .filter(|&finding| part(finding))
        .count();
    let verdict = match warnings {
        0 => "all is well".to_owned(),
        warnings => counted(warnings, "warning"),
    };
    let allowed = checked
        .allowed
        .iter()
        .filter(|allowed| part(&allowed.diagnostic));
    match allowed.count() {
        0 => verdict,
        allowed => format!("{verdict}, {} allowed", counted(allowed, "warning")),
    }
}

fn describe(program: &Program, checked: &Checked, verdict: &str) -> String {
    let plan = &program.plan;
    let scene = program.scene.as_ref().map_or("?", |scene| &scene.name);
    let Some(order) = &program.order else {
        return format!("{}\n", plan.name);
    };
    if let Some(size) = plan.aggregate {
        let free = program.scene.as_ref().map_or(0, |scene| scene.free.count);
        return format!(
            "aggregate {} in {scene}: complete when {size} of {free} free blocks are bonded; {verdict}\n",
            plan.name,
        );
    }
    let (captures, releases) = plan.counts();
    let by_hand = plan.phases.iter().filter(|phase| phase.planted);
    let planted = by_hand.map(|phase| phase.events.len()).sum::<usize>();
    let mut out = format!(
        "assembly {} in {scene}: {}, {}, {}; {verdict}\n",
        plan.name,
        counted(plan.phases.len() - usize::from(planted > 0), "phase"),
        counted(captures - planted, "capture"),
        counted(releases, "release"),
    );
    let width = plan
        .phases
        .iter()
        .map(|phase| phase.name.len())
        .max()
        .unwrap_or(0);
    if planted > 0 {
        out.push_str(&format!(
            "  {} attached by hand\n",
            counted(planted, "block")
        ));
    }
    for (phase, chain) in plan
        .phases
        .iter()
        .zip(&order.chains)
        .filter(|(phase, _)| !phase.planted)
    {
        out.push_str(&format!(
            "  phase {:width$}  longest serial chain {}: {}\n",
            phase.name,
            Order::length(plan, chain),
            chain_text(chain, |&id| plan.describe(id, &checked.symbols)),
        ));
    }
    let all: usize = order
        .chains
        .iter()
        .map(|chain| Order::length(plan, chain))
        .sum();
    if let Some((number, chain)) = order.longest(plan)
        && !plan.phases[number].planted
    {
        out.push_str(&format!(
            "  the program's longest serial chain is {} (phase {}); one phase after the other, {all}\n",
            Order::length(plan, chain),
            plan.phases[number].name,
        ));
    }
    out
}
