//! `stochc results`, and the table that `simulate` ends with.
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::json;
use stochc_ensemble::sweep::SweepTally;
use stochc_ensemble::text::visible;
use stochc_ensemble::{ComparisonTally, Manifest, Records, WaitsTally, captures};
use stochc_report::tables::{
    KNOWN_BIAS, captures_to_text, comparison_to_text, pairs_to_text, sweep_to_text,
};
use stochc_report::text::paragraph;
use stochc_runtime::Model;

use super::terminal::{Terminal, output_width, print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::results::read;

/// What `results` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// Results folder of `simulate --out`
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Output format of the table
    #[arg(long, value_name = "FORM", default_value = "text")]
    format: Form,
    /// Also print every capture: waits, entries into the field, origin of the blocks
    #[arg(long)]
    bonds: bool,
}

/// A form of the table of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Form {
    /// For people
    Text,
    /// For programs
    Json,
}

/// What to show of an ensemble.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// In which form.
    pub form: Form,
    /// The captures as well.
    pub bonds: bool,
}

/// Shows what a folder holds, finished or not.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let (manifest, finished) = read(&options.folder, &Terminal::new(false))?;
    let missing = manifest.total().saturating_sub(finished.len() as u64);
    if missing > 0 {
        warn(&format!(
            "{missing} of {} runs are still to do\n",
            manifest.total()
        ));
    }
    show(
        &manifest,
        &finished,
        &Shown {
            form: options.format,
            bonds: options.bonds,
        },
    )
}

/// Prints the comparison of an ensemble's programs; says whether every run was successful.
pub fn show(manifest: &Manifest, finished: &Records, shown: &Shown) -> Result<Exit, Failure> {
    let mut comparison = ComparisonTally::new(manifest);
    let mut sweep = SweepTally::new(manifest).filter(|_| shown.form == Form::Text);
    let mut waits: Vec<WaitsTally> = match shown.bonds {
        true => vec![WaitsTally::default(); manifest.programs.len()],
        false => Vec::new(),
    };
    let told = finished.each(|done| {
        comparison.add(done);
        sweep.iter_mut().for_each(|sweep| sweep.add(done));
        if let Some(waits) = waits.get_mut(done.program) {
            waits.add(&done.record);
        }
    });
    told.map_err(Failure::usage)?;
    let comparison = comparison.finish();
    let waits = manifest.programs.iter().zip(waits);
    match shown.form {
        Form::Text => {
            let width = output_width();
            print(&match sweep.map(SweepTally::finish) {
                None => comparison_to_text(&comparison, width),
                Some(sweep) => sweep_to_text(&sweep, width) + &pairs_to_text(&comparison, width),
            })?;
            if manifest.settings.model == Model::Rate {
                print(&format!("\n{}", paragraph(KNOWN_BIAS, width)))?;
            }
            for (program, waits) in waits {
                let name = visible(&program.name);
                print(&format!("\n{name}, capture by capture\n"))?;
                let captures = captures(program, waits);
                print(&captures_to_text(&captures, program.scene.tick, width))?;
            }
        }
        Form::Json => {
            let value = match shown.bonds {
                false => json!(comparison),
                true => {
                    let bonds = waits.map(|(program, waits)| {
                        json!({ "program": program.name, "captures": captures(program, waits) })
                    });
                    let bonds: Vec<_> = bonds.collect();
                    json!({ "comparison": comparison, "captures": bonds })
                }
            };
            print(&format!("{value:#}\n"))?;
        }
    }
    let unsuccessful = comparison
        .programs
        .iter()
        .any(|column| column.timed_out + column.stopped + column.failed > 0);
    Ok(match unsuccessful {
        true => Exit::UnsuccessfulRun,
        false => Exit::Success,
    })
}
