//! Constructors of [`Names`].
use stochc_grammar::tree::Tree;
use stochc_grammar::{Cancellation, Cancelled};

use super::definition::Keep;
use super::index::Names;
use super::resolve;
use crate::FileId;
use crate::check::checked::Checked;

impl Names {
    /// Resolves the names of all files of a program.
    ///
    /// # Errors
    ///
    /// Returns [`Cancelled`] if the check was cancelled.
    pub fn new(checked: &Checked, cancellation: Cancellation<'_>) -> Result<Names, Cancelled> {
        Names::from_trees(checked.trees(), Keep::All, cancellation)
    }

    /// Resolves names of declarations only, without blocks, instances and phases.
    pub(crate) fn from_declarations(checked: &Checked) -> Names {
        let names = Names::from_trees(checked.trees(), Keep::Declarations, Cancellation::NEVER);
        names.expect("there is no cancellation")
    }

    /// Resolves the names of syntax trees. Imported files come before the files that import them.
    ///
    /// # Errors
    ///
    /// Returns [`Cancelled`] if the check was cancelled.
    pub(crate) fn from_trees<'a>(
        trees: impl Iterator<Item = (FileId, &'a Tree)>,
        keep: Keep,
        cancellation: Cancellation<'_>,
    ) -> Result<Names, Cancelled> {
        resolve::resolve(trees, keep, cancellation)
    }
}
