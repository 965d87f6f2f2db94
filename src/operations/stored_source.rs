//! Compilation of the sources that a results folder stores for each program.
use stochc_compiler::{Checked, LintLevels, Program};
use stochc_results::{EnsembleProgram, Varied};

use super::programs::recompile;

/// Result of compiling the stored sources of a program.
#[derive(Debug)]
pub struct StoredSource<'a> {
    stored: &'a EnsembleProgram,
    /// Result of the check. If no source is stored, it contains a diagnostic about this.
    pub checked: Checked,
}

impl<'a> StoredSource<'a> {
    /// Compiles the sources of a program, with the parameter values of its point in a sweep.
    pub fn new(stored: &'a EnsembleProgram, levels: &LintLevels) -> StoredSource<'a> {
        StoredSource::with(stored, stored.changes(), levels)
    }

    /// Compiles the sources of a program, without the parameter values of its point in a sweep.
    pub fn as_written(stored: &'a EnsembleProgram) -> StoredSource<'a> {
        StoredSource::with(stored, stored.set.iter(), &LintLevels::default())
    }

    fn with(
        stored: &'a EnsembleProgram,
        values: impl Iterator<Item = &'a Varied>,
        levels: &LintLevels,
    ) -> StoredSource<'a> {
        StoredSource {
            stored,
            checked: recompile(&stored.sources, values, stored.assembly(), levels),
        }
    }

    /// Returns the compiled program. Returns `None` if the sources do not declare it or are
    /// missing.
    pub fn program(&self) -> Option<&Program> {
        let mut programs = self.checked.programs.iter();
        programs.find(|it| it.plan.name == self.stored.assembly())
    }

    /// Returns the compiled program if it equals the stored one. Returns `None` if another version
    /// of the compiler gives another result.
    pub fn same_program(&self) -> Option<&Program> {
        let program = self.program();
        program.filter(|it| it.tables.as_ref() == Some(self.stored.tables()))
    }

    /// Returns the compiled program. Returns `None` if the sources do not declare it or are
    /// missing.
    pub fn into_program(self) -> Option<Program> {
        let mut programs = self.checked.programs.into_iter();
        programs.find(|it| it.plan.name == self.stored.assembly())
    }
}
