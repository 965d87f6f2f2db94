//! Results folders and summaries of their runs.
use std::path::Path;

use serde_json::json;
use stochc_experiments::sweep::{Sweep, SweepTally};
use stochc_experiments::trade::{Trade, TradeTally};
use stochc_experiments::{
    CaptureSummary, Comparison, ComparisonTally, WaitsTally, captures, summary_table,
};
use stochc_files::shell::file as shell_file;
use stochc_ir::record::Outcome;
use stochc_ir::table::PhaseId;
use stochc_report::presentation::Presentation;
use stochc_report::tables::{
    KNOWN_BIAS, captures_to_text, comparison_to_text, lower_bounds, pairs_to_text,
    published_comparison, published_sweep, sweep_to_text, trade_to_text,
};
use stochc_results::{Contents, EnsembleProgram, Finished, Folder, MANIFEST, Manifest, Records};
use stochc_runtime::Model;
use stochc_text::visible;
use stochc_text::{Markup, paragraph};

use super::json::document;
use crate::exit::Failure;
use crate::host::Host;

/// Reads a results folder and reports its problems. Returns its manifest and runs.
///
/// # Errors
/// If the folder contains no results.
pub fn read(folder: &Path, host: &dyn Host) -> Result<(Manifest, Records), Failure> {
    let contents = read_contents(folder, host)?;
    Ok((contents.manifest, contents.finished))
}

/// Reads a results folder with all details, and warns about corrupted files.
///
/// # Errors
/// If the folder contains no results.
pub fn read_contents(folder: &Path, host: &dyn Host) -> Result<Contents, Failure> {
    if let Some(parent) = folder.parent().filter(|_| folder.is_file())
        && parent.join(MANIFEST).is_file()
    {
        let parent = match &*parent.to_string_lossy() {
            "" => ".".to_owned(),
            parent => shell_file(&visible(parent)),
        };
        return Err(Failure::usage(format!(
            "`{}` is a file of a results folder; give the folder {parent}",
            folder.display()
        )));
    }
    let contents = Folder::read(folder).map_err(Failure::usage)?;
    warn_of_damage(folder, &contents.damage, host);
    Ok(contents)
}

pub(crate) fn warn_of_damage(folder: &Path, damage: &[String], host: &dyn Host) {
    /// Largest number of files that the warning lists.
    const SHOWN: usize = 5;
    if damage.is_empty() {
        return;
    }
    let mut text = String::new();
    for message in damage.iter().take(SHOWN) {
        text += &format!("warning: {message}\n");
    }
    let rest = damage.len().saturating_sub(SHOWN);
    if rest > 0 {
        text += &format!("warning: so are {rest} more\n");
    }
    let folder = shell_file(&visible(&folder.to_string_lossy()));
    text += &format!(
        "`stochc fsck {folder}` lists the corrupted files; with `--repair`, it repairs the folder\n"
    );
    host.warn(&text);
}

/// Summary of the runs of an ensemble.
#[derive(Debug)]
pub struct EnsembleResults<'a> {
    manifest: &'a Manifest,
    /// Statistics of each program, and comparisons between programs.
    pub comparison: Comparison,
    /// Summary of the sweep. `None` if the ensemble has no sweep.
    pub sweep: Option<Sweep>,
    /// Summary of the trade. `None` if no settings are varied.
    pub trade: Option<Trade>,
    /// Waiting times of the captures of each program. Empty if captures are not listed.
    waits: Vec<WaitsTally>,
    /// Largest number of captures to list per program.
    max_captures: usize,
    /// The first failed run. `None` if no run failed.
    failure: Option<Failed>,
}

/// Returns the captures with the longest waiting times of a program, in descending order. Returns
/// at most `most` captures.
fn longest(program: &EnsembleProgram, waits: WaitsTally, most: usize) -> Vec<CaptureSummary> {
    let mut captures = captures(program, waits);
    if captures.len() > most {
        captures.sort_by(|one, other| other.wait.mean.total_cmp(&one.wait.mean));
        captures.truncate(most);
    }
    captures
}

/// First run of an ensemble whose physics failed.
#[derive(Debug)]
struct Failed {
    program: usize,
    run: u64,
    phase: PhaseId,
    tick: u64,
    reason: String,
}

impl Failed {
    fn from_run(done: &Finished) -> Option<Failed> {
        let record = &done.record;
        let Outcome::Failed { phase, reason, .. } = &record.outcome else {
            return None;
        };
        Some(Failed {
            program: done.program,
            run: record.run,
            phase: *phase,
            tick: record.ticks,
            reason: reason.clone(),
        })
    }
}

/// Summarizes the runs of an ensemble. `max_captures` is the number of captures to list per
/// program. `None` lists no captures.
///
/// # Errors
/// If the records cannot be read.
pub fn ensemble_results<'a>(
    manifest: &'a Manifest,
    finished: &Records,
    max_captures: Option<usize>,
) -> Result<EnsembleResults<'a>, Failure> {
    let mut comparison = ComparisonTally::new(manifest);
    let mut sweep = SweepTally::new(manifest);
    let mut trade = TradeTally::new(manifest);
    let mut waits: Vec<WaitsTally> = if max_captures.is_some() {
        vec![WaitsTally::default(); manifest.programs.len()]
    } else {
        Vec::new()
    };
    let mut failure = None;
    let outcome = finished.each(|done| {
        failure = failure.take().or_else(|| Failed::from_run(done));
        comparison.add(done);
        sweep.iter_mut().for_each(|sweep| sweep.add(done));
        trade.iter_mut().for_each(|trade| trade.add(done));
        if let Some(waits) = waits.get_mut(done.program) {
            waits.add(&done.record);
        }
    });
    outcome.map_err(Failure::usage)?;
    let comparison = comparison.finish();
    Ok(EnsembleResults {
        manifest,
        trade: trade.map(|trade| trade.finish(&comparison)),
        comparison,
        sweep: sweep.map(SweepTally::finish),
        waits,
        max_captures: max_captures.unwrap_or(0),
        failure,
    })
}

impl EnsembleResults<'_> {
    /// Replaces the names of programs and the unit of times as `how` requires.
    ///
    /// # Errors
    /// If a label does not belong to a program.
    pub fn shown(mut self, how: &Presentation) -> Result<Self, Failure> {
        if let Some(label) = how.unused(self.manifest.programs.iter()) {
            return Err(Failure::usage(format!(
                "--label: `{}` is not the name of a program",
                label.name
            )));
        }
        let label = |name: &str| how.label(name);
        self.comparison.relabel(label);
        self.sweep.iter_mut().for_each(|sweep| sweep.relabel(label));
        Ok(if how.in_seconds {
            EnsembleResults {
                comparison: self.comparison.in_seconds(),
                sweep: self.sweep.map(Sweep::in_seconds),
                ..self
            }
        } else {
            self
        })
    }

    /// Returns a CSV table with a row for each program, or each point of a sweep.
    pub fn csv(&self) -> String {
        match &self.sweep {
            Some(sweep) => sweep.to_csv(),
            None => summary_table(self.manifest, &self.comparison).csv(),
        }
    }

    /// Returns the tables as LaTeX or Markdown.
    pub fn markup(&self, markup: Markup) -> String {
        match &self.sweep {
            Some(sweep) => published_sweep(sweep, &self.comparison, markup),
            None => published_comparison(&self.comparison, markup),
        }
    }

    /// Returns the tables as text for a width \[columns\].
    pub fn text(self, width: usize) -> String {
        let comparison = &self.comparison;
        let mut text = match &self.sweep {
            None => comparison_to_text(comparison, width),
            Some(sweep) => sweep_to_text(sweep, width) + &pairs_to_text(comparison, width),
        };
        if let Some(trade) = &self.trade {
            text += &format!(
                "\nCost and accuracy\n\n{}",
                trade_to_text(trade, width, false)
            );
        }
        if self.manifest.uses(Model::Rate) {
            text += &format!("\n{}", paragraph(KNOWN_BIAS, width));
        }
        for bound in lower_bounds(self.manifest) {
            text += &paragraph(&bound, width);
        }
        let names = comparison.programs.iter().map(|it| visible(&it.name));
        let programs = self.manifest.programs.iter().zip(names);
        for ((program, name), waits) in programs.zip(self.waits) {
            if program.tables().aggregate.is_some() {
                let none = "an aggregate, has no captures: its blocks bond when they meet.";
                text += &format!("\n{}", paragraph(&format!("{name}, {none}"), width));
                continue;
            }
            text += &format!("\n{name}, capture by capture\n");
            let captures = longest(program, waits, self.max_captures);
            text += &captures_to_text(&captures, program.scene.tick, width);
        }
        text
    }

    /// Returns the results as a JSON document.
    pub fn json(self) -> String {
        let mut content = json!(self.comparison);
        if !self.waits.is_empty() {
            let programs = self.manifest.programs.iter().zip(&self.comparison.programs);
            let bonds = programs.zip(self.waits).map(|((program, summary), waits)| {
                json!({ "program": summary.name, "captures": longest(program, waits, self.max_captures) })
            });
            content["captures"] = bonds.collect();
        }
        document(content)
    }

    /// Returns a message about the first failed run, with a command that shows it. Returns `None`
    /// if no run failed.
    pub fn failure(&self, folder: Option<&Path>) -> Option<String> {
        let first = self.failure.as_ref()?;
        let program = &self.manifest.programs[first.program];
        let programs = self.comparison.programs.iter();
        let all: u64 = programs.map(|column| column.failed).sum();
        let failed = match all {
            1 => "1 run failed:".to_owned(),
            all => format!("{all} runs failed, first of all"),
        };
        let more = match folder {
            Some(folder) => {
                let folder = shell_file(&visible(&folder.to_string_lossy()));
                format!("`stochc show {folder} --run {}`", first.run)
            }
            None => format!(
                "`stochc trace ... --run {}`, with the same programs, seed and settings,",
                first.run
            ),
        };
        Some(format!(
            "{failed} run {} of {}, in phase {}, at tick {}: {}\n{more} shows its events\n",
            first.run,
            visible(&program.name),
            visible(program.phase(first.phase)),
            first.tick,
            visible(&first.reason),
        ))
    }

    /// Returns whether all finished runs completed.
    pub fn are_all_successful(&self) -> bool {
        let mut programs = self.comparison.programs.iter();
        programs.all(|column| column.timed_out + column.censored + column.failed == 0)
    }
}
