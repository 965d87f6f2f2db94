//! The `stochc` command, and its pieces for Rust programs.
//!
//! ```no_run
//! # fn main() -> Result<(), stochc::Wrong> {
//! let checked = stochc::check("examples/five_tower.sa");
//! let tables = checked.programs[0].tables.as_ref().ok_or(stochc::Wrong)?;
//! println!("{}", stochc::ir::emit::table_text(tables));
//! # Ok(())
//! # }
//! ```
pub mod cli;
pub mod command;
pub mod ensemble;
pub mod export;
mod figures;
pub mod files;
pub mod findings;
pub mod fix;
pub mod lsp;
pub mod orders;
pub mod recording;
pub mod replay;
pub mod report;
pub mod statistics;
pub mod sweep;
pub mod trade;
mod wrong;

pub use stochc_compiler as compiler;
pub use stochc_ir as ir;
pub use stochc_protocol as protocol;
pub use stochc_runtime as runtime;
pub use wrong::Wrong;

use compiler::{Checked, Levels, Limits};
use ir::scene::scalars::Change;

/// Checks a file of the disk and all it imports, and compiles its assemblies.
///
/// Never fails: a file that cannot be read is a finding as well.
pub fn check(path: &str) -> Checked {
    check_with(path, &Levels::default())
}

/// [`check`], with levels for the warnings that the files say nothing of.
///
/// Small programs are tried [in every order of events](orders) as well.
pub fn check_with(path: &str, levels: &Levels) -> Checked {
    let mut checked = compiler::check_with(path, &mut files::read, Limits::default(), levels);
    orders::try_out(&mut checked);
    checked
}

/// [`check_with`], from texts instead of the disk, the program's own first; with other numbers for the scene of the
/// assembly of a name.
pub fn check_texts(
    texts: &[(&str, &str)],
    levels: &Levels,
    assembly: &str,
    changes: &[Change],
) -> Checked {
    let mut reader = |path: &str| {
        let found = texts.iter().find(|(name, _)| *name == path);
        found
            .map(|(_, text)| text.as_bytes().to_vec())
            .ok_or("it is not among the texts".to_owned())
    };
    let root = texts.first().map_or("", |(name, _)| name);
    let limits = Limits::default();
    let mut checked = compiler::check_changed(root, &mut reader, limits, levels, assembly, changes);
    orders::try_out(&mut checked);
    checked
}
