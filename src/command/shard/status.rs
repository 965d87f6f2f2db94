//! `stochc shard status`.
use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};
use stochc_files::shell::file as shell_file;
use stochc_results::shards::{ShardState, ShardStatus, status};
use stochc_text::{ranges, visible};

use super::super::run_options::JsonOption;
use super::super::terminal::print;
use crate::exit::{Exit, Failure};
use crate::operations::json::document;

/// Arguments of `shard status`.
#[derive(Debug, Args)]
pub struct StatusArguments {
    /// Folder of `stochc shard new`
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Print only the numbers of the missing shards, one per line
    #[arg(long)]
    missing: bool,
    #[command(flatten)]
    output: JsonOption,
}

pub fn run(options: &StatusArguments) -> Result<Exit, Failure> {
    let status = status(&options.folder).map_err(Failure::usage)?;
    let folder = options.folder.to_string_lossy();
    print(&match (options.output.json, options.missing) {
        (true, true) => {
            let missing: Vec<_> = status.missing().collect();
            document(json!({ "missing": missing }))
        }
        (true, false) => document(content(&status)),
        (false, true) => (status.missing()).map(|it| format!("{it}\n")).collect(),
        (false, false) => text(&status, &folder),
    })?;
    Ok(Exit::Success)
}

fn content(status: &ShardStatus) -> Value {
    let mut content = json!(status);
    content["missing"] = json!(status.missing().collect::<Vec<_>>());
    content
}

fn text(status: &ShardStatus, folder: &str) -> String {
    /// Largest number of shards in the list.
    const SHOWN: usize = 20;
    let missing: Vec<u64> = status.missing().collect();
    let there = status.states.len() - missing.len();
    let mut text = format!(
        "{there} of {} shards are complete; {} runs in all\n",
        status.shards, status.runs
    );
    let plain = |number: &&u64| status.states[**number as usize] == ShardState::Missing;
    let others = missing.iter().filter(|number| !plain(number));
    for &number in others.clone().take(SHOWN) {
        text += &match &status.states[number as usize] {
            ShardState::Begun { runs } => format!("shard {number} is begun: {runs} runs\n"),
            ShardState::Corrupted { reason } | ShardState::Foreign { reason } => {
                format!("shard {number} {reason}\n")
            }
            ShardState::Whole | ShardState::Missing => String::new(),
        };
    }
    let more = others.count().saturating_sub(SHOWN);
    if more > 0 {
        text += &format!("{more} more are begun, damaged or foreign\n");
    }
    let nothing: Vec<u64> = missing.iter().filter(plain).copied().collect();
    if !nothing.is_empty() {
        text += &format!("missing: {}\n", ranges(&nothing, ", "));
    }
    let folder = shell_file(&visible(folder));
    let is_wrong = |state: &ShardState| {
        matches!(
            state,
            ShardState::Corrupted { .. } | ShardState::Foreign { .. }
        )
    };
    if status.states.iter().any(is_wrong) {
        text += &format!("First repair the folder: stochc fsck {folder} --repair\n");
    }
    text += &if missing.is_empty() {
        format!("Next: stochc shard merge {folder}\n")
    } else {
        format!(
            "To run the missing shards:\n  for i in $(stochc shard status {folder} --missing); do stochc shard run {folder} $i; done\n"
        )
    };
    text
}
