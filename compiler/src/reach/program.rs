//! Inputs of the check of access paths.
use stochc_grammar::tree::Assembly;
use stochc_grammar::{Cancellation, Symbols};

use super::plane::Plane;
use super::proposal::Trial;
use crate::blocks::liveness::Liveness;
use crate::dependencies::graph::DependencyGraph;
use crate::dependencies::order::Order;
use crate::expand::Patterns;
use crate::expanded::ExpandedProgram;
use crate::shapes::layout::Layout;
use crate::{FileId, Sources};

/// A program without errors of the earlier stages.
#[derive(Clone, Copy)]
pub struct ValidProgram<'a> {
    pub plan: &'a ExpandedProgram,
    /// Earlier events that each event depends on because it uses the name of a block.
    pub liveness: &'a Liveness,
    pub layout: &'a Layout,
    /// Dependency graph, including choices.
    pub graph: &'a DependencyGraph,
    /// Dependencies that hold in every order.
    pub certain: &'a DependencyGraph,
    /// A possible order of the events.
    pub order: &'a Order,
    pub assembly: &'a Assembly,
    pub patterns: &'a Patterns<'a>,
    pub file: FileId,
    /// Function that checks the files with one change. `None` inside such a check, because it needs
    /// only the titles of diagnostics.
    pub trial: Option<&'a Trial<'a>>,
    /// Plane of a planar world.
    pub plane: Option<Plane>,
    /// Whether blocks are known to [pass gaps](stochc_estimate::Rates::passes_gaps) in the scene.
    pub has_passable_gaps: bool,
    pub sources: &'a Sources,
    pub symbols: &'a Symbols,
    pub cancellation: Cancellation<'a>,
}
