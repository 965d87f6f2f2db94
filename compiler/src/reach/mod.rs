//! Whether a free block can still come to every cell, whatever order chance brings.
//!
//! **Cells decide.** A cube that drifts needs, wherever it is, room for its inside. Two empty cells that
//! share only an edge or a corner leave a passage without width, so a block comes to a cell if
//! and only if a chain of empty cells, face to face, leads there from outside. (A hard cube has no clearance
//! in such a chain where it is one cell wide; that is what `clearance.rs` warns of.)
//!
//! **One order decides for all.** Say that nothing is released in a phase. Then what stands only grows,
//! and ways only close. Take a capture `e`. In the worst order everything that does not wait for `e` has
//! happened already. If its cell has a way out then, it has one in every order. If it has none, let the
//! others go first: either they all happen, and `e` is stuck for ever, or one of them gets stuck on the way;
//! the phase does not end in either case. So the phase ends in every order if and only if every capture has a
//! way out in its own worst case: for phases without releases the verdict is exact. "What does not wait
//! for `e`" is everything but its descendants in the dependency graph.
//!
//! **Releases** open ways, but only if they happen. A capture that is not stuck in a state where some
//! release is still to come may be waiting for a block that itself waits for that release. So releases are
//! counted on only when nothing can keep them from happening: all captures that they wait for
//! have been shown to have a way out, counting on earlier releases alone. Suppose that the phase comes to a stand
//! although every capture was shown to be safe. Of the captures that are stuck, take the one that was shown
//! first. Every release counted on for it waits only for captures shown before, none of which is stuck, so
//! it has happened; hence no more stands than was assumed, and the capture has a way out: a
//! contradiction. The verdict is therefore sound. It is not exact: captures that could only be stuck
//! together are told of even if chance can never bring them there, and a block that is released
//! into the closed cell, and stays, is not counted on.
//!
//! **What no order reaches** is told apart (`reachable.rs`): a capture whose own predecessors close it in, and what
//! waits for such a one. For the others a remedy is looked for (`repair.rs`), written as a change of the text (`edit.rs`)
//! and tried (`trial.rs`): it is proposed only if the program so changed has this error no more, and no new one.
//!
//! **It is fast** because a capture has a way out if a neighbour that waits for it has one, and else
//! mostly if it or a neighbouring cell sees the sky. Only the rest is searched for, along the walls
//! (`path_search.rs`). The work is bounded; what was not decided within the bound is told.
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

use crate::diagnostic::{Code, Diagnostic, report};
use crate::expand::Patterns;
use crate::graph::DependencyGraph;
use crate::layout::Layout;
use crate::liveness::Liveness;
use crate::order::Order;
use crate::plan::{EventId, EventKind, ProgramPlan};
use crate::{FileId, Sources, face_turns};
use trial::Proposal;
pub use trial::Trial;

/// Cells that may be searched for every event, besides those that the limits say.
const STEPS_PER_EVENT: u64 = 10;

/// Of the cells that may be searched, the part that counts for events of the programs in which remedies are tried.
const TRIED: u64 = 100;

/// A program in which nothing else is wrong.
#[derive(Clone, Copy)]
pub struct SoundProgram<'a> {
    /// Written out.
    pub plan: &'a ProgramPlan,
    /// Who is anchored when.
    pub liveness: &'a Liveness,
    /// Where every block sits.
    pub layout: &'a Layout,
    /// What waits for what, with its choices.
    pub graph: &'a DependencyGraph,
    /// What surely waits for what, in every order.
    pub certain: &'a DependencyGraph,
    /// An order of it.
    pub order: &'a Order,
    /// Its text, as a tree.
    pub assembly: &'a Assembly,
    /// The patterns of the files.
    pub patterns: &'a Patterns<'a>,
    /// The file of the assembly.
    pub file: FileId,
    /// Checks the files again with a change; `None`: such a check is under way, and only the titles of
    /// findings matter.
    pub trial: Option<&'a Trial<'a>>,
    /// Whether blocks are known to [pass gaps](stochc_estimate::Rates::passes_gaps) in its scene.
    pub has_passable_gaps: bool,
    /// Its texts.
    pub sources: &'a Sources,
    /// Its words.
    pub symbols: &'a Symbols,
    /// Whether anybody still waits for it.
    pub cancellation: Cancellation<'a>,
}

/// Tells of captures that no free block may be able to come to, or only through a narrow gap.
///
/// `search`: cells that may be searched, besides some for every event; 0: none at all.
///
/// # Errors
///
/// [`Cancelled`] if nobody waits for it.
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
    // A search that nobody waits for has been given up.
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
    /// What stands in the worst case of the phase at hand.
    occupancy: OccupiedCells,
    /// Captures that have a way out in every order.
    is_safe: Vec<bool>,
    /// Known ways out, of a cube of one cell and of one of two.
    known_paths: [KnownPaths; 2],
    /// Work done and work allowed, for the proof and for the warning.
    proof: SearchEffort<'a>,
    warning: SearchEffort<'a>,
    /// The same for saying what is wrong and what helps, and events that are written out again to try it.
    remedies: SearchEffort<'a>,
    trials: SearchEffort<'a>,
    /// The errors of the files as they are, once a remedy has been tried.
    untouched: Option<Vec<ReportedFinding>>,
    /// Remedies that have been proposed, each with the errors that it leaves.
    proposed: Vec<(Vec<ReportedFinding>, Proposal)>,
}

/// What is told of an error, without its places.
pub type ReportedFinding = (Code, String);

/// Places searched, and how many may be.
struct SearchEffort<'a> {
    steps: u64,
    budget: u64,
    cancellation: Cancellation<'a>,
}

impl SearchEffort<'_> {
    /// Whether no more is allowed, or nobody waits for it.
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
        // What is attached by hand needs no way.
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

    /// The block of a release has gone for sure.
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

    /// Whether some capture has a choice of those it waits for.
    fn has_choice(&self) -> bool {
        !self.subject.order.unneeded.is_empty()
    }
}

impl<'a> ReachAnalysis<'a> {
    /// The graph with every choice made: one way in which everything can happen, with as little as can be behind
    /// the events that are `late`. What does not wait for any of these in every order does not here.
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

/// What an event waits for.
fn before(graph: &DependencyGraph, id: EventId) -> impl Iterator<Item = EventId> {
    (graph.edges_directed(NodeIndex::new(id.0 as usize), Incoming)).map(|edge| graph[edge.source()])
}

/// What waits for an event.
fn after(graph: &DependencyGraph, id: EventId) -> impl Iterator<Item = EventId> {
    (graph.edges_directed(NodeIndex::new(id.0 as usize), Outgoing)).map(|edge| graph[edge.target()])
}

/// Events and all that they wait for.
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
