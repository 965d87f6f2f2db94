//! Result of a check.
use stochc_grammar::Symbols;
use stochc_grammar::tree::Tree;
use stochc_ir::JamRisk;
use stochc_ir::claim::Claim;
use stochc_ir::scene::Scene;
use stochc_ir::scene::warnings::SceneWarning;
use stochc_ir::table::Tables;

use crate::blocks::bond_loads::PhaseLoad;
use crate::dependencies::graph::DependencyGraph;
use crate::dependencies::order::Order;
use crate::diagnostic::Diagnostic;
use crate::diagnostic::lint_levels::Allowed;
use crate::expanded::ExpandedProgram;
use crate::shapes::layout::Layout;
use crate::sources::load::Module;
use crate::{FileId, Sources};

/// Result of checking a file.
#[derive(Debug)]
pub struct Checked {
    /// Sources, for showing diagnostics.
    pub sources: Sources,
    /// Errors, then warnings. Both are sorted by file and location.
    pub diagnostics: Vec<Diagnostic>,
    /// Warnings that an `allow` suppresses.
    pub allowed: Vec<Allowed>,
    /// Syntax tree of the file. Empty if it cannot be read.
    pub tree: Tree,
    /// Imported files in the order of reading.
    pub imports: Vec<Module>,
    /// Words that occur in the syntax trees and plans.
    pub symbols: Symbols,
    /// Assemblies and aggregates of the file, in source order.
    pub programs: Vec<Program>,
}

/// An assembly or aggregate. Stages with errors leave their results empty.
#[derive(Debug)]
pub struct Program {
    /// The expanded program.
    pub plan: ExpandedProgram,
    /// Scene of the program. `None` if the scene has errors.
    pub scene: Option<Scene>,
    /// Cells of all blocks.
    pub layout: Layout,
    /// Dependencies between events.
    pub graph: DependencyGraph,
    /// A possible order of the events. `None` if their dependencies have a cycle.
    pub order: Option<Order>,
    /// Event tables. `None` if the program has errors.
    pub tables: Option<Tables>,
    /// Event tables of a program whose only errors are cycles and closed cells. These tables show
    /// how the program gets stuck.
    pub stuck: Option<Tables>,
    /// Reasons why the scene does not work. Includes warnings that an `allow` suppresses.
    pub scene_warnings: Vec<SceneWarning>,
    /// Largest load of a bond at the end of each phase. Empty if bonds do not break, or if the
    /// program has errors.
    pub bond_loads: Vec<PhaseLoad>,
    /// Claims about runs. Empty if the program has errors.
    pub claims: Vec<Claim>,
    /// Reasons why blocks may jam. The rate model ignores them.
    pub jam_risks: Vec<JamRisk>,
}

impl Checked {
    /// Returns the trees of all files. Imported files come before the files that import them.
    pub fn trees(&self) -> impl Iterator<Item = (FileId, &Tree)> {
        let imports = self.imports.iter();
        // The file itself is read first.
        let own = (!self.sources.files().is_empty()).then_some((FileId(0), &self.tree));
        imports.map(|module| (module.file, &module.tree)).chain(own)
    }

    /// Returns whether there are errors.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(Diagnostic::is_error)
    }
}
