//! What is known of a file and its programs.
use stochc_grammar::Symbols;
use stochc_grammar::tree::Tree;
use stochc_ir::JamRisk;
use stochc_ir::scene::Scene;
use stochc_ir::scene::warnings::SceneWarning;
use stochc_ir::table::Tables;

use crate::diagnostic::Diagnostic;
use crate::graph::DependencyGraph;
use crate::layout::Layout;
use crate::lint_levels::Allowed;
use crate::load::Module;
use crate::order::Order;
use crate::plan::ProgramPlan;
use crate::{FileId, Sources};

/// Everything that is known of a file after looking at all of it.
#[derive(Debug)]
pub struct Checked {
    /// The texts, for showing findings.
    pub sources: Sources,
    /// Errors, and then warnings: by file and place, each once.
    pub diagnostics: Vec<Diagnostic>,
    /// What is suspicious and allowed to be.
    pub allowed: Vec<Allowed>,
    /// The tree of the file itself; empty if it cannot be read.
    pub tree: Tree,
    /// The files it imports, in the order of reading.
    pub imports: Vec<Module>,
    /// The words of the trees and plans.
    pub symbols: Symbols,
    /// The assemblies and aggregates of the file itself, in source order.
    pub programs: Vec<Program>,
}

/// One assembly or aggregate, as far as it makes sense.
#[derive(Debug)]
pub struct Program {
    /// Written out.
    pub plan: ProgramPlan,
    /// The world it runs in; `None` if that is wrong.
    pub scene: Option<Scene>,
    /// Where every block sits.
    pub layout: Layout,
    /// What waits for what.
    pub graph: DependencyGraph,
    /// An order of it; `None` if there is a cycle.
    pub order: Option<Order>,
    /// What every block knows; `None` unless everything is right.
    pub tables: Option<Tables>,
    /// The tables of a program that is right but for circles and cells out of reach: to show how
    /// it gets stuck, not to be run.
    pub stuck: Option<Tables>,
    /// The reasons why the scene does not work, whether or not they are allowed.
    pub scene_warnings: Vec<SceneWarning>,
    /// Reasons why blocks may jam. The rate model leaves them out.
    pub jam_risks: Vec<JamRisk>,
}

impl Checked {
    /// The trees of all files: imported ones before those that import them, the file's own last.
    pub fn trees(&self) -> impl Iterator<Item = (FileId, &Tree)> {
        let imports = self.imports.iter();
        // The file itself is read first.
        let own = (!self.sources.files().is_empty()).then_some((FileId(0), &self.tree));
        imports.map(|module| (module.file, &module.tree)).chain(own)
    }

    /// Whether anything is wrong, not merely suspicious.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(Diagnostic::is_error)
    }
}
