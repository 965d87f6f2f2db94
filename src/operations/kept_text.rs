//! The texts that are kept with a program, compiled again for what is about the text.
use stochc_compiler::{Checked, LintLevels, Program};
use stochc_results::{EnsembleProgram, Varied};

use super::programs::recompile;

/// What the compiler says of the texts of a program.
#[derive(Debug)]
pub struct KeptText<'a> {
    kept: &'a EnsembleProgram,
    /// All of it; where no text is kept, that there is none.
    pub checked: Checked,
}

impl<'a> KeptText<'a> {
    /// Compiles the texts of a program, with the numbers that a sweep has chosen for it.
    pub fn new(kept: &'a EnsembleProgram, levels: &LintLevels) -> KeptText<'a> {
        KeptText::varied(kept, &kept.varied, levels)
    }

    /// The same with the numbers of the text.
    pub fn as_written(kept: &'a EnsembleProgram) -> KeptText<'a> {
        KeptText::varied(kept, &[], &LintLevels::default())
    }

    fn varied(kept: &'a EnsembleProgram, varied: &[Varied], levels: &LintLevels) -> KeptText<'a> {
        KeptText {
            kept,
            checked: recompile(&kept.sources, varied, kept.assembly(), levels),
        }
    }

    /// Returns the program. `None` means the texts do not declare it, or there are none.
    pub fn program(&self) -> Option<&Program> {
        let mut programs = self.checked.programs.iter();
        programs.find(|it| it.plan.name == self.kept.assembly())
    }

    /// The same, if it compiles to what is kept; another version of the compiler may do otherwise.
    pub fn same_program(&self) -> Option<&Program> {
        let program = self.program();
        program.filter(|it| it.tables.as_ref() == Some(self.kept.tables()))
    }

    /// Returns the program.
    pub fn into_program(self) -> Option<Program> {
        let mut programs = self.checked.programs.into_iter();
        programs.find(|it| it.plan.name == self.kept.assembly())
    }
}
