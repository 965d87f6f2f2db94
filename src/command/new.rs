//! `stochc new`: creates a commented program to start from.
use std::path::Path;

use clap::{Args, ValueEnum};
use stochc_files::atomic::{Replaces, replace};
use stochc_files::shell::file as shell_file;
use stochc_text::visible;

use super::terminal::{is_quiet, print};
use crate::exit::{Exit, Failure};

/// Arguments of `new`.
#[derive(Debug, Args)]
pub struct NewArguments {
    /// Name of the program. The file is called NAME.sa
    #[arg(value_name = "NAME")]
    name: String,
    /// Kind of program
    #[arg(long, value_name = "TEMPLATE", default_value = "structure")]
    template: Template,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

/// A program to start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Template {
    /// A structure in two phases
    Structure,
    /// A structure of blocks with valves, in a stirred tank
    Suction,
    /// A structure of blocks with switched magnets, in a stirred tank
    Magnets,
    /// A structure of blocks of micrometres, moved by heat
    Brownian,
    /// A structure on an air table
    Planar,
    /// A shape. `stochc plan` writes the program that builds it
    Plan,
}

impl Template {
    fn text(self) -> &'static str {
        match self {
            Template::Structure => include_str!("new/structure.sa"),
            Template::Suction => include_str!("new/suction.sa"),
            Template::Magnets => include_str!("new/magnets.sa"),
            Template::Brownian => include_str!("new/brownian.sa"),
            Template::Planar => include_str!("new/planar.sa"),
            Template::Plan => include_str!("new/plan.sa"),
        }
    }

    /// Returns commands to try next with the new file, each with a comment.
    fn next(self, file: &str, name: &str) -> [(String, &'static str); 3] {
        let check = |options: &str| format!("stochc check {file}{options}");
        let simulate = |file: &str| format!("stochc simulate {file} -n 20 -o results/{name}");
        match self {
            Template::Structure => [
                (check(""), "proves that it finishes"),
                (simulate(file), "simulates 20 runs"),
                (format!("stochc replay results/{name}"), "shows a run"),
            ],
            Template::Suction | Template::Magnets | Template::Brownian | Template::Planar => [
                (check(" --physics"), "lists the physics of the scene"),
                (simulate(file), "simulates 20 runs"),
                (format!("stochc report results/{name}"), "writes a report"),
            ],
            Template::Plan => {
                let planned = format!("{name}_planned.sa");
                [
                    (
                        format!("stochc plan {file} -o {planned}"),
                        "writes the captures",
                    ),
                    (format!("stochc check {planned}"), "proves that it finishes"),
                    (simulate(&planned), "simulates 20 runs"),
                ]
            }
        }
    }
}

/// Writes the new program and prints the commands to try next.
pub fn run(options: &NewArguments) -> Result<Exit, Failure> {
    let stem = options.name.strip_suffix(".sa").unwrap_or(&options.name);
    let path = format!("{stem}.sa");
    let name = Path::new(stem).file_name().and_then(|it| it.to_str());
    let name = name.filter(|name| stem.ends_with(name) && is_name(name));
    let name = name.ok_or_else(|| {
        Failure::usage(format!(
            "`{}` is not a name: use letters, digits and `_`, and begin with a letter",
            visible(stem)
        ))
    })?;
    let text = options.template.text().replace("NAME", name);
    let path = Path::new(&path);
    let replaced = if options.force {
        Replaces::Ours(|_| Ok(true))
    } else {
        Replaces::Nothing
    };
    replace(path, text.as_bytes(), replaced).map_err(|error| {
        if options.force || !path.is_file() {
            return Failure::not_written(path, error);
        }
        let reason = "the file exists; choose another name, or add `--force` to replace it";
        Failure::not_written(path, reason)
    })?;
    if is_quiet() {
        return Ok(Exit::Success);
    }
    let file = shell_file(&path.to_string_lossy());
    let next = options.template.next(&file, name);
    let width = next.iter().map(|(command, _)| command.len()).max();
    let width = width.unwrap_or(0);
    let lines = next.map(|(command, meaning)| format!("  {command:width$}  # {meaning}\n"));
    print(&format!(
        "Wrote {}. Next:\n{}",
        path.display(),
        lines.concat()
    ))?;
    Ok(Exit::Success)
}

fn is_name(name: &str) -> bool {
    let mut letters = name.chars();
    let is_first = letters.next().is_some_and(|it| it.is_ascii_alphabetic());
    is_first && letters.all(|it| it.is_ascii_alphanumeric() || it == '_')
}
