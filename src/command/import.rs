//! `stochc import`.
use std::path::PathBuf;

use clap::Args;
use stochc_files::shell::file as shell_file;
use stochc_results::EnsembleProgram;
use stochc_text::{counted, visible};

use super::host::Terminal;
use super::interrupt::stop_on_interrupt;
use super::source_options::SourceOptions;
use super::terminal::{is_quiet, print};
use crate::exit::{Exit, Failure};
use crate::operations::chosen_run::index;
use crate::operations::import::import;
use crate::operations::programs::programs;

/// Arguments of `import`.
#[derive(Debug, Args)]
pub struct ImportArguments {
    /// Log of the experiment, in CSV or JSON Lines. The columns are `run`, `seconds` or `ticks`, `event`, `block`, `by`
    /// and optionally `body`
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// Program of the experiment (`*.sa`), or a compiled program
    #[arg(long, value_name = "FILE")]
    program: String,
    /// Assembly of the experiment, if FILE has several
    #[arg(long, value_name = "NAME")]
    assembly: Option<String>,
    /// Folder for the results. It must be new or empty
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    source: SourceOptions,
}

pub fn run(options: &ImportArguments) -> Result<Exit, Failure> {
    let host = Terminal::default();
    stop_on_interrupt()?;
    let source = options.source.settings();
    let programs = programs(std::slice::from_ref(&options.program), &source, &host)?;
    let program = chosen(programs, options.assembly.as_deref(), &options.program)?;
    let (manifest, _) = import(&options.log, &program, &options.out, &host)?;
    if !is_quiet() {
        let shown = visible(&options.out.to_string_lossy());
        print(&format!(
            "`{shown}` contains {}. Next: stochc show {}\n",
            counted(manifest.runs as usize, "measured run"),
            shell_file(&shown)
        ))?;
    }
    Ok(Exit::Success)
}

/// Returns the program of an assembly. The assembly may be `None` if there is only one program.
fn chosen(
    mut programs: Vec<EnsembleProgram>,
    assembly: Option<&str>,
    file: &str,
) -> Result<EnsembleProgram, Failure> {
    let names: Vec<&str> = programs.iter().map(EnsembleProgram::assembly).collect();
    let number = match assembly {
        None if names.len() > 1 => {
            let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
            return Err(Failure::usage(format!(
                "`{file}` has several programs; choose one with `--assembly`: {}",
                names.join(", ")
            )));
        }
        assembly => index(&names, assembly, "file").map_err(Failure::usage)?,
    };
    Ok(programs.swap_remove(number))
}
