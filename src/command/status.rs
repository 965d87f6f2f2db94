//! `stochc status`.
use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};
use stochc_ensemble::shards::{PieceState, ShardStatus, status};
use stochc_ensemble::text::{ranges, visible};
use stochc_files::shell::file as shell_file;

use super::show::ResultsFormat;
use super::terminal::print;
use crate::exit::{Exit, Failure};
use crate::operations::json::document;

/// What `status` is given.
#[derive(Debug, Args)]
pub struct StatusArguments {
    /// Folder of `simulate --shards`
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Print the numbers of the pieces that are not there, one on each line, and nothing else
    #[arg(long)]
    missing: bool,
    /// Output format
    #[arg(long, value_name = "FORM", default_value = "text")]
    format: ResultsFormat,
}

/// Says which pieces of an ensemble are there.
pub fn run(options: &StatusArguments) -> Result<Exit, Failure> {
    let status = status(&options.folder).map_err(Failure::usage)?;
    let folder = options.folder.to_string_lossy();
    print(&match (options.format, options.missing) {
        (ResultsFormat::Json, true) => {
            let missing: Vec<_> = status.missing().collect();
            document(json!({ "missing": missing }))
        }
        (ResultsFormat::Json, false) => document(content(&status)),
        (ResultsFormat::Text, true) => (status.missing()).map(|it| format!("{it}\n")).collect(),
        (ResultsFormat::Text, false) => text(&status, &folder),
    })?;
    Ok(Exit::Success)
}

fn content(status: &ShardStatus) -> Value {
    let mut content = json!(status);
    content["missing"] = json!(status.missing().collect::<Vec<_>>());
    content
}

fn text(status: &ShardStatus, folder: &str) -> String {
    /// Pieces that are listed one by one.
    const SHOWN: usize = 20;
    let missing: Vec<u64> = status.missing().collect();
    let there = status.pieces.len() - missing.len();
    let mut text = format!(
        "{there} of {} pieces are there, of {} runs in all\n",
        status.shards, status.runs
    );
    let plain = |number: &&u64| status.pieces[**number as usize] == PieceState::Missing;
    let others = missing.iter().filter(|number| !plain(number));
    for &number in others.clone().take(SHOWN) {
        text += &match &status.pieces[number as usize] {
            PieceState::Begun { runs } => format!("piece {number} is begun: {runs} runs\n"),
            PieceState::Damaged { reason } | PieceState::Foreign { reason } => {
                format!("piece {number} {reason}\n")
            }
            PieceState::Whole | PieceState::Missing => String::new(),
        };
    }
    let more = others.count().saturating_sub(SHOWN);
    if more > 0 {
        text += &format!("{more} more are begun, damaged, or of something else\n");
    }
    let nothing: Vec<u64> = missing.iter().filter(plain).copied().collect();
    if !nothing.is_empty() {
        text += &format!("nothing is there of: {}\n", ranges(&nothing, ", "));
    }
    let folder = shell_file(&visible(folder));
    let is_wrong = |state: &PieceState| {
        matches!(
            state,
            PieceState::Damaged { .. } | PieceState::Foreign { .. }
        )
    };
    if status.pieces.iter().any(is_wrong) {
        text += &format!(
            "To save what is sound, before anything is made: stochc verify {folder} --repair\n"
        );
    }
    text += &if missing.is_empty() {
        format!("To put them together: stochc merge {folder}\n")
    } else {
        format!(
            "To make what is missing: for i in $(stochc status {folder} --missing); do stochc shard {folder} $i; done\n"
        )
    };
    text
}
