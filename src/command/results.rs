//! `stochc results`, and the table that `simulate` ends with.
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::json;
use stochc_ensemble::sweep::Sweep;
use stochc_ensemble::text::visible;
use stochc_ensemble::{Comparison, Finished, Folder, Manifest, captures};
use stochc_files::shell::file as shell_file;
use stochc_report::tables::{
    KNOWN_BIAS, captures_to_text, comparison_to_text, pairs_to_text, sweep_to_text,
};
use stochc_report::text::paragraph;
use stochc_runtime::Model;

use super::terminal::{output_width, print, warn};
use crate::exit::{Exit, Failure};

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
    let (manifest, finished) = read(&options.folder)?;
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

/// Reads a results folder, and says what is wrong with it.
pub(super) fn read(folder: &Path) -> Result<(Manifest, Vec<Finished>), Failure> {
    let contents = Folder::read(folder).map_err(Failure::usage)?;
    tell_of_damage(folder, &contents.damage);
    Ok((contents.manifest, contents.finished))
}

/// Says what is wrong with the files of a results folder.
pub(super) fn tell_of_damage(folder: &Path, damage: &[String]) {
    /// More than these say the same.
    const TOLD: usize = 5;
    if damage.is_empty() {
        return;
    }
    let mut text = String::new();
    for told in damage.iter().take(TOLD) {
        text += &format!("warning: {told}\n");
    }
    let rest = damage.len().saturating_sub(TOLD);
    if rest > 0 {
        text += &format!("warning: so are {rest} more\n");
    }
    let folder = shell_file(&visible(&folder.to_string_lossy()));
    text +=
        &format!("`stochc verify {folder}` says what is sound; with `--repair`, it saves that\n");
    warn(&text);
}

/// Prints the comparison of an ensemble's programs; says whether every run was successful.
pub fn show(manifest: &Manifest, finished: &[Finished], shown: &Shown) -> Result<Exit, Failure> {
    let comparison = Comparison::of(manifest, finished);
    let captures = |program| captures(manifest, finished, program);
    match shown.form {
        Form::Text => {
            let width = output_width();
            print(&match Sweep::of(manifest, finished) {
                None => comparison_to_text(&comparison, width),
                Some(sweep) => sweep_to_text(&sweep, width) + &pairs_to_text(&comparison, width),
            })?;
            if manifest.settings.model == Model::Rate {
                print(&format!("\n{}", paragraph(KNOWN_BIAS, width)))?;
            }
            if shown.bonds {
                for (number, program) in manifest.programs.iter().enumerate() {
                    print(&format!(
                        "\n{}, capture by capture\n",
                        visible(&program.name)
                    ))?;
                    let tick = program.scene.tick;
                    print(&captures_to_text(&captures(number), tick, width))?;
                }
            }
        }
        Form::Json => {
            let value = match shown.bonds {
                false => json!(comparison),
                true => {
                    let programs = manifest.programs.iter().enumerate();
                    let bonds = programs.map(|(number, program)| {
                        json!({ "program": program.name, "captures": captures(number) })
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
