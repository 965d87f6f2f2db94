//! `stochc man`.
use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use clap_mangen::Man;
use stochc_files::atomic::{Replaces, begins_with, make_folder, replace};

use super::terminal::print;
use crate::exit::{Exit, Failure};

/// Arguments of `man`.
#[derive(Debug, Args)]
pub struct ManArguments {
    /// Write a page for each command into DIR, instead of printing the main page
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Prints the manual, or writes its pages into a folder.
pub fn run(options: &ManArguments, command: clap::Command) -> Result<Exit, Failure> {
    // The subcommand `help` gets no pages, because they would repeat the others.
    let mut command = command.disable_help_subcommand(true);
    // This call sets the full names of all subcommands.
    command.build();
    let refuse = |error| Failure::usage(format!("cannot write the manual: {error}"));
    match &options.out {
        None => print(&String::from_utf8_lossy(&page(command).map_err(refuse)?))?,
        Some(folder) => pages(command, folder).map_err(refuse)?,
    }
    Ok(Exit::Success)
}

fn page(command: clap::Command) -> io::Result<Vec<u8>> {
    let mut page = Vec::new();
    Man::new(command).render(&mut page)?;
    Ok(page)
}

/// Writes the pages of a command and its subcommands, except `help`.
fn pages(command: clap::Command, folder: &Path) -> io::Result<()> {
    make_folder(folder)?;
    let mut left = vec![command];
    while let Some(command) = left.pop() {
        let subcommands = command.get_subcommands();
        left.extend(subcommands.filter(|it| it.get_name() != "help").cloned());
        let name = command.get_display_name().unwrap_or(command.get_name());
        let name = name.to_owned();
        write(folder, &name, &page(command)?)?;
    }
    Ok(())
}

fn write(folder: &Path, name: &str, page: &[u8]) -> io::Result<()> {
    let ours = Replaces::Ours(|file| begins_with(file, b".TH stochc"));
    let path = folder.join(format!("{name}.1"));
    replace(&path, page, ours)
        .map_err(|error| io::Error::new(error.kind(), format!("`{}`: {error}", path.display())))
}
