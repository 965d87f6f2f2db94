//! Checks programs and prints their diagnostics.

use stochc_compiler::order::Order;
use stochc_compiler::{Checked, Program};
use stochc_files::programs::{STDIN, STDIN_NAME, programs, read};
use stochc_ir::emit::chain_text;
use stochc_runtime::rates::Rates;
use stochc_text::visible;

use super::arguments::CheckArguments;
use super::cost::{cost_json, costs, summed_up};
use super::fix;
use super::scene::scenes;
use crate::SourceSettings;
use crate::command::terminal::{
    exit_of, has_colour, message_width, output_width, print, print_folded, warn, warn_drawn,
};
use crate::diagnostics::{CheckDocument, DiagnosticCounts, Format, SarifLog, show};
use crate::exit::{Exit, Failure};
use crate::facade::check_read;
use crate::operations::programs::{cannot_read, is_readable, plan_advice, verdict};
use crate::operations::rates::{UnusedRates, read_rate_files};
use crate::operations::summary::{status_lines, warnings};
use crate::reader::DiskReader;
use crate::source_settings::UnusedValues;

/// Checks each file and prints its diagnostics. Prints a summary of files without errors.
pub fn run(options: &CheckArguments) -> Result<Exit, Failure> {
    let is_written = options.fix && !options.dry_run && options.format() != Format::Graphical;
    if is_written && options.files.iter().any(|file| file == STDIN) {
        return Err(Failure::usage(
            "`--fix -` writes the program itself to the standard output, where `--format` writes the diagnostics: \
             leave one of the two out, or add `--dry-run`",
        ));
    }
    let rates = read_rate_files(&options.rates)?;
    let mut unused = UnusedRates::new(&options.rates, &rates);
    let mut exit = Exit::Success;
    let mut document = CheckDocument::default();
    document.scenes = options.physics.then(Vec::new);
    let mut log = SarifLog::new(std::env::current_dir().ok().as_deref());
    let mut tally = DiagnosticCounts::default();
    // With `--set`, a later file can use a value. Summaries are printed after the check of all values.
    let mut summaries = String::new();
    let source = options.source.settings();
    let mut unset = UnusedValues::new(&source);
    let (files, unread) = readable(&options.files);
    let are_many = files.len() + usize::from(unread) > 1;
    if unread {
        exit = Exit::Usage;
        log.leave_out();
    }
    for file in &files {
        let mut text = None;
        if options.fix
            && let Some(ended) = fix::run(file, options, &source, &mut exit, &mut text)?
        {
            exit = exit.or_worse(ended);
            continue;
        }
        // If the fixed source goes to standard output, summaries go to standard error.
        let is_output_taken = text.is_some();
        let mut print_summary = |summary: &str| {
            if is_output_taken {
                warn(summary);
            } else if source.set.is_empty() {
                return print_folded(summary);
            } else {
                summaries += summary;
            }
            Ok(())
        };
        let checked = match check(file, text, &source) {
            Ok(checked) => checked,
            Err(failure) => {
                exit = exit.or_worse(exit_of(Err(failure)));
                log.leave_out();
                continue;
            }
        };
        unset.remove_used_by(&checked.programs);
        let name = if are_many {
            format!("{}: ", visible(file))
        } else {
            String::new()
        };
        let shown = || show(&checked, options.format(), has_colour(), message_width());
        match options.format() {
            // In this format, standard output has only diagnostics, which other applications read.
            Format::Short => print(&shown())?,
            Format::Json => document.add(file, &checked, "cost", |program| {
                let most = options.cost.filter(|_| !checked.has_errors())?;
                Some(cost_json(program, &checked.symbols, most, &rates))
            }),
            Format::Sarif => log.add(file, &checked),
            Format::Graphical => {
                warn_drawn(&shown());
                tally.add(&checked);
                if !checked.has_errors() {
                    print_summary(&summary(file, &name, &checked, options.cost, &rates))?;
                }
            }
        }
        exit = exit.or_worse(verdict(&checked));
        let has_text = matches!(options.format(), Format::Short | Format::Sarif);
        if options.cost.is_some() && has_text && !checked.has_errors() {
            warn(&summary(file, &name, &checked, options.cost, &rates));
        }
        unused.remove_used(checked.programs.iter().filter_map(|it| it.scene.as_ref()));
        if options.physics {
            for scene in scenes(file, &checked) {
                match options.format() {
                    Format::Graphical => print_summary(&scene.text())?,
                    Format::Short | Format::Sarif => warn(&scene.text()),
                    Format::Json => document.scenes.get_or_insert_default().push(scene.json()),
                }
            }
        }
    }
    exit = exit.or_worse(print_if_used(&summaries, unset, exit)?);
    unused.notes().for_each(|note| warn(&note));
    match options.format() {
        Format::Json => print(&document.text())?,
        Format::Sarif => print(&log.document())?,
        Format::Graphical => warn(&tally.lines()),
        Format::Short => {}
    }
    Ok(exit)
}

/// Prints the summaries if all checks succeeded and used all values of `--set`. Reports unused values.
fn print_if_used(summaries: &str, unset: UnusedValues<'_>, exit: Exit) -> Result<Exit, Failure> {
    let unset = match exit {
        Exit::Success => unset.check(),
        _ => Ok(()),
    };
    if unset.is_ok() {
        print_folded(summaries)?;
    }
    Ok(exit_of(unset.map(|()| Exit::Success)))
}

/// Returns the arguments that are readable files. Reports other arguments, and returns whether
/// there are any.
fn readable(arguments: &[String]) -> (Vec<String>, bool) {
    let opened = |file: String| {
        if file != STDIN_NAME {
            is_readable(&file)?;
        }
        Ok(file)
    };
    let found = programs(arguments).into_iter();
    let found = found.map(|file| file.map_err(Failure::usage).and_then(opened));
    let mut files = Vec::new();
    let mut unread = false;
    for file in found {
        match file {
            Ok(file) => files.push(file),
            Err(failure) => {
                exit_of(Err(failure));
                unread = true;
            }
        }
    }
    (files, unread)
}

/// Checks a file. `text` replaces the content of the file.
///
/// # Errors
/// If the file cannot be read.
pub(super) fn check(
    file: &str,
    text: Option<Vec<u8>>,
    source: &SourceSettings,
) -> Result<Checked, Failure> {
    let text = text.map_or_else(|| read(file), Ok);
    let text = text.map_err(|reason| cannot_read(file, reason))?;
    let mut reader = DiskReader::new(file, Some(&text), &source.imports);
    Ok(check_read(file, &mut reader, source))
}

/// Returns the summary of a file without errors. Each line begins with `name`.
fn summary(
    file: &str,
    name: &str,
    checked: &Checked,
    cost: Option<usize>,
    rates: &[Rates],
) -> String {
    if checked.programs.is_empty() {
        let warnings = warnings(checked, |_| true);
        let warnings = warnings.map_or_else(String::new, |it| format!(", {it}"));
        let advice = plan_advice(file, checked);
        return format!("{name}no assembly or aggregate to check{advice}{warnings}\n");
    }
    let mut out = String::new();
    for (number, program) in checked.programs.iter().enumerate() {
        out.push_str(name);
        out.push_str(&status_lines(checked, number));
        out.push_str(&critical_paths(program, checked));
        if cost.is_none() {
            out.push_str(&summed_up(program, rates));
        }
        out.push_str(&costs(program, &checked.symbols, cost, rates));
    }
    if let Some(warnings) = warnings(checked, |diagnostic| diagnostic.programs.is_empty()) {
        out.push_str(&format!(
            "{name}{warnings} outside of assemblies and aggregates\n"
        ));
    }
    out
}

/// Returns the critical path of each phase as text, one per line.
fn critical_paths(program: &Program, checked: &Checked) -> String {
    let plan = &program.plan;
    let phases = || plan.phases.iter().filter(|phase| !phase.pre_attached);
    let has_phases = plan.aggregate.is_none() && phases().next().is_some();
    let Some(order) = program.order.as_ref().filter(|_| has_phases) else {
        return String::new();
    };
    let width = phases().map(|phase| phase.name.len()).max().unwrap_or(0);
    let total = order.critical_path_length(plan);
    let mut out = format!("  longest serial chain (critical path), {total} in total:\n");
    let chains = plan.phases.iter().zip(&order.chains);
    for (phase, chain) in chains.filter(|(phase, _)| !phase.pre_attached) {
        let describe = |at: usize| plan.describe(chain[at], &checked.symbols);
        let length = Order::length(plan, chain);
        let mut line = format!("    {:width$}  {length}: ", phase.name);
        let whole = chain_text(chain, |&id| plan.describe(id, &checked.symbols));
        let is_wide = line.chars().count() + whole.chars().count() > output_width();
        if is_wide && chain.len() > 2 {
            line += &format!("{}, ..., {}", describe(0), describe(chain.len() - 1));
        } else {
            line += &whole;
        }
        out.push_str(&(line + "\n"));
    }
    out
}
