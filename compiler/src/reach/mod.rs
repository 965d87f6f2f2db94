//! Whether free blocks can reach every cell, in whatever order the events happen.
//!
//! **Cells decide.** A drifting cube needs space for its inside. Two empty cells that share only an
//! edge or a corner leave a passage without width. So a block reaches a cell if and only if a chain
//! of empty cells leads there from outside, face to face. A chain that is one cell wide leaves a
//! hard cube no clearance; `clearance.rs` warns of it.
//!
//! **One order decides for all.** Consider a phase without releases. Its structure only grows, and
//! paths only close. Take a capture `e`. In its worst order, everything that does not wait for `e`
//! has already happened. If the cell of `e` has a path then, it has one in every order. If it has
//! none, let the other events go first. Either they all happen and `e` is stuck, or one of them
//! gets stuck. The phase does not end in either case. So the phase ends in every order if and only
//! if every capture has a path in its own worst order. For phases without releases, the verdict is
//! exact. The events that wait for `e` are its descendants in the dependency graph.
//!
//! **Releases** open paths, but only if they happen. A stuck capture may wait for a block that
//! itself waits for the release. So the proof counts on a release only if nothing can prevent it:
//! all captures that it waits for have been shown to have a path, counting on earlier releases
//! only. This is sound. Suppose that a phase gets stuck although every capture was shown to be
//! safe. Take the stuck capture that was shown first. Every release that its proof counts on waits
//! only for captures shown earlier, which are not stuck, so the release has happened. So the
//! structure is no larger than assumed, and the capture has a path: a contradiction. The verdict is
//! not exact. It reports captures that could only be stuck together, even if no order leads there.
//! It does not count on a block that is released into the closed cell.
//!
//! **Captures that no order reaches** are reported separately (`reachable.rs`): captures that are
//! closed by blocks that they wait for, and captures that wait for those. For the others, a change
//! of the source is searched (`repair.rs`), written (`edit.rs`) and tried (`trial.rs`). It is
//! proposed only if the changed program does not have this error and no new one.
//!
//! **Speed.** A capture has a path if a neighbour that waits for it has one. Most others are next
//! to a column that is open to the sky. The remaining cells are searched along the walls
//! (`path_search.rs`). The work is bounded, and undecided cells are reported.
mod clearance;
mod closable_phase;
mod crowding;
mod descendants;
mod diagnose;
mod edit;
mod known_paths;
mod moving_cube;
mod occupancy;
mod path_search;
mod picture;
mod reachable;
mod repair;
mod sealed;
mod trial;

use std::borrow::Cow;

use descendants::DescendantIndex;
use known_paths::KnownPaths;
use occupancy::OccupiedCells;
use petgraph::Direction::{Incoming, Outgoing};
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use rustc_hash::FxHashSet;
use stochc_grammar::tree::Assembly;
use stochc_grammar::{Cancellation, Cancelled, Symbols};
use stochc_ir::Cell;

use crate::blocks::liveness::Liveness;
use crate::dependencies::face_turns;
use crate::dependencies::graph::DependencyGraph;
use crate::dependencies::order::Order;
use crate::diagnostic::{Code, Diagnostic, report};
use crate::expand::Patterns;
use crate::plan::{EventId, EventKind, ProgramPlan};
use crate::shapes::layout::Layout;
use crate::{FileId, Sources};
use trial::Proposal;
pub use trial::Trial;

/// Number of cells that may be searched for every event, in addition to the limit.
const STEPS_PER_EVENT: u64 = 10;

/// Share of the search that may be used to try remedies.
const TRIED: u64 = 100;

/// A program without errors of the earlier stages.
#[derive(Clone, Copy)]
pub struct SoundProgram<'a> {
    /// Expanded program.
    pub plan: &'a ProgramPlan,
    /// Attachment of each block over time.
    pub liveness: &'a Liveness,
    /// Cells of all blocks.
    pub layout: &'a Layout,
    /// Dependency graph, including choices.
    pub graph: &'a DependencyGraph,
    /// Dependencies that hold in every order.
    pub certain: &'a DependencyGraph,
    /// An order of the events.
    pub order: &'a Order,
    /// Syntax tree of the assembly.
    pub assembly: &'a Assembly,
    /// Patterns of all files.
    pub patterns: &'a Patterns<'a>,
    /// File of the assembly.
    pub file: FileId,
    /// Checks the files with a change. `None` inside such a check, where only titles of diagnostics
    /// matter.
    pub trial: Option<&'a Trial<'a>>,
    /// Whether blocks are known to [pass gaps](stochc_estimate::Rates::passes_gaps) in the scene.
    pub has_passable_gaps: bool,
    /// Sources of the files.
    pub sources: &'a Sources,
    /// Words of the files.
    pub symbols: &'a Symbols,
    /// Cancellation of the check.
    pub cancellation: Cancellation<'a>,
}

/// Reports captures whose cells free blocks may not reach, or only through a narrow gap.
///
/// `search` is the number of cells that may be searched, in addition to some for every event. 0
/// disables the search.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn check(
    subject: SoundProgram,
    search: u64,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<(), Cancelled> {
    let plan = subject.plan;
    let count = plan.events.len();
    let cancellation = subject.cancellation;
    let effort = |share| SearchEffort {
        steps: 0,
        budget: search / share + STEPS_PER_EVENT * count as u64 * u64::from(search > 0),
        cancellation,
    };
    let mut survey = ReachAnalysis {
        subject,
        occupancy: OccupiedCells::with_capacity(count + plan.seeds.len()),
        is_safe: vec![false; count],
        known_paths: Default::default(),
        proof: effort(1),
        warning: effort(10),
        remedies: effort(1),
        trials: SearchEffort {
            steps: 0,
            budget: search / TRIED,
            cancellation,
        },
        untouched: None,
        proposed: Vec::new(),
    };
    let events = subject.order.by_phase(plan);
    for (number, events) in events.iter().enumerate() {
        cancellation.check()?;
        let first = plan.phases[number].events.start;
        let descendants = DescendantIndex::new(subject.certain, first, events);
        survey.phase(number, events, &descendants, diagnostics);
    }
    // A cancelled search has stopped early.
    cancellation.check()?;
    let is_undecided = |diagnostic: &Diagnostic| diagnostic.code == Code::ReachUndecided;
    if survey.warning.is_spent() && !diagnostics.iter().any(is_undecided) {
        let title = "stochc could not decide for all blocks whether they enter through narrow gaps";
        let diagnostic = Diagnostic::new(Code::ReachUndecided, title)
            .label(plan.location, "the search for gaps reached its limit")
            .help("split the program, or build it in fewer phases");
        report(diagnostics, diagnostic);
    }
    Ok(())
}

struct ReachAnalysis<'a> {
    subject: SoundProgram<'a>,
    /// Occupied cells in the worst order of the current phase.
    occupancy: OccupiedCells,
    /// Whether each capture has been shown to have a path in every order.
    is_safe: Vec<bool>,
    /// Known paths of cubes of one and of two block lengths.
    known_paths: [KnownPaths; 2],
    /// Work for the proof and for the warnings.
    proof: SearchEffort<'a>,
    warning: SearchEffort<'a>,
    /// Work for messages and remedies, and for trials of remedies.
    remedies: SearchEffort<'a>,
    trials: SearchEffort<'a>,
    /// Errors of the unchanged files, once a remedy was tried.
    untouched: Option<Vec<ReportedError>>,
    /// Proposed remedies, each with the errors that remain.
    proposed: Vec<(Vec<ReportedError>, Proposal)>,
}

/// Code and title of an error.
pub type ReportedError = (Code, String);

/// Number of searched positions, with its limit.
struct SearchEffort<'a> {
    steps: u64,
    budget: u64,
    cancellation: Cancellation<'a>,
}

impl SearchEffort<'_> {
    /// Returns whether the limit is reached or the check was cancelled.
    fn is_spent(&self) -> bool {
        self.steps > self.budget || self.cancellation.is_cancelled()
    }
}

impl ReachAnalysis<'_> {
    fn phase(
        &mut self,
        number: usize,
        events: &[EventId],
        descendants: &DescendantIndex,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        for &id in events {
            if let (Some(cell), true) = (self.cell(id), self.is_capture(id)) {
                self.occupancy.fill(cell, id);
            }
        }
        // Pre-attached blocks need no path.
        if self.subject.plan.phases[number].planted {
            return;
        }
        self.known_paths
            .iter_mut()
            .for_each(KnownPaths::begin_phase);
        let blocked = self.blocked(events, descendants);
        if !blocked.is_empty() {
            self.report_sealed(events, descendants, &blocked, diagnostics);
        }
        if blocked.is_empty() {
            self.report_narrow(number, events, descendants, diagnostics);
            self.report_crowded(number, events, descendants, diagnostics);
        }
        for &id in events {
            if !self.is_capture(id) {
                self.depart(id);
            }
        }
    }

    /// Removes a block whose release certainly happens.
    fn depart(&mut self, release: EventId) {
        let on = self.subject.layout.parents[release.0 as usize];
        if let (Some(cell), Some(on)) = (self.cell(release), on) {
            self.occupancy.empty(cell, on.capture);
        }
    }

    fn cell(&self, id: EventId) -> Option<Cell> {
        self.subject.layout.cells[id.0 as usize]
    }

    fn is_capture(&self, id: EventId) -> bool {
        matches!(self.subject.plan.event(id).kind, EventKind::Capture { .. })
    }

    /// Returns whether a capture has a choice of events to wait for.
    fn has_choice(&self) -> bool {
        !self.subject.order.unneeded.is_empty()
    }
}

impl<'a> ReachAnalysis<'a> {
    /// Returns the graph with every choice made, so that as few events as possible follow the
    /// `late` ones. An event that can happen before all of them has no path from them.
    fn straight(&self, is_late: impl Fn(EventId) -> bool) -> Cow<'a, DependencyGraph> {
        let graph = self.subject.graph;
        if !self.has_choice() {
            return Cow::Borrowed(graph);
        }
        let length = |i: usize| match EventId(i as u32) {
            id if is_late(id) => f64::INFINITY,
            id => f64::from(u8::from(self.is_capture(id))),
        };
        let unneeded = face_turns::unneeded(graph, &face_turns::earliest(graph, length));
        Cow::Owned(face_turns::straight(graph, &unneeded))
    }
}

/// Returns the events that an event waits for.
fn before(graph: &DependencyGraph, id: EventId) -> impl Iterator<Item = EventId> {
    (graph.edges_directed(NodeIndex::new(id.0 as usize), Incoming)).map(|edge| graph[edge.source()])
}

/// Returns the events that wait for an event.
fn after(graph: &DependencyGraph, id: EventId) -> impl Iterator<Item = EventId> {
    (graph.edges_directed(NodeIndex::new(id.0 as usize), Outgoing)).map(|edge| graph[edge.target()])
}

/// Returns these events and all their ancestors.
fn all_before(
    graph: &DependencyGraph,
    events: impl IntoIterator<Item = EventId>,
) -> FxHashSet<EventId> {
    let mut open: Vec<EventId> = events.into_iter().collect();
    let mut found: FxHashSet<EventId> = open.iter().copied().collect();
    while let Some(id) = open.pop() {
        open.extend(before(graph, id).filter(|&first| found.insert(first)));
    }
    found
}
