//! Checks the access paths of all captures, phase by phase.
use std::borrow::Cow;

use stochc_grammar::Cancelled;
use stochc_ir::{Cell, Face};

use super::descendants::DescendantIndex;
use super::effort::SearchEffort;
use super::known_paths::KnownPaths;
use super::occupancy::OccupiedCells;
use super::program::ValidProgram;
use super::proposal::{Proposal, ReportedError};
use crate::dependencies::face_turns;
use crate::dependencies::graph::DependencyGraph;
use crate::diagnostic::{Code, Diagnostic, report};
use crate::expanded::{EventId, EventKind};

/// Number of cells that the search may visit per event, in addition to the limit.
const STEPS_PER_EVENT: u64 = 10;

/// Divisor of the search limit. The trial of remedies may use one `TRIED`th of all steps.
const TRIED: u64 = 100;

/// Reports captures whose cells free blocks may not reach, or only through a narrow gap.
///
/// `search` is the number of cells that may be searched, in addition to 10 for
/// every event. 0 disables the search.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn check(
    subject: ValidProgram,
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
    survey.occupancy.plane = subject.plane;
    if subject.plane.is_some() {
        for seed in &plan.seeds {
            let cell = survey.in_search(seed.cell);
            survey.occupancy.fill_by_seed(cell);
        }
    }
    let events = subject.order.by_phase(plan);
    for (number, events) in events.iter().enumerate() {
        cancellation.check()?;
        let first = plan.phases[number].events.start;
        let descendants = DescendantIndex::new(subject.certain, first, events);
        survey.phase(number, events, &descendants, diagnostics);
    }
    // A cancelled search is incomplete.
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

pub(super) struct ReachAnalysis<'a> {
    pub(super) subject: ValidProgram<'a>,
    /// Occupied cells of the current phase. In the worst order of a capture, everything that does
    /// not depend on it happens first.
    pub(super) occupancy: OccupiedCells,
    /// Whether each capture has been shown to have a path in every order.
    pub(super) is_safe: Vec<bool>,
    /// Known paths of cubes of one and of two block lengths.
    pub(super) known_paths: [KnownPaths; 2],
    /// Search effort for the proof and for the warnings.
    pub(super) proof: SearchEffort<'a>,
    pub(super) warning: SearchEffort<'a>,
    /// Search effort for messages, remedies, and trials of remedies.
    pub(super) remedies: SearchEffort<'a>,
    pub(super) trials: SearchEffort<'a>,
    /// Errors of the unchanged files. `None` before the first trial.
    pub(super) untouched: Option<Vec<ReportedError>>,
    /// Proposed remedies, each with the errors that remain.
    pub(super) proposed: Vec<(Vec<ReportedError>, Proposal)>,
}

impl ReachAnalysis<'_> {
    pub(super) fn phase(
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
        if self.subject.plan.phases[number].pre_attached {
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
    pub(super) fn depart(&mut self, release: EventId) {
        let on = self.subject.layout.parents[release.0 as usize];
        if let (Some(cell), Some(on)) = (self.cell(release), on) {
            self.occupancy.empty(cell, on.capture);
        }
    }

    /// Returns the cell of an event in the frame of the search.
    pub(super) fn cell(&self, id: EventId) -> Option<Cell> {
        let cell = self.subject.layout.cells[id.0 as usize]?;
        Some(self.in_search(cell))
    }

    /// Returns a cell in the frame of the search. See [`OccupiedCells`].
    pub(super) fn in_search(&self, cell: Cell) -> Cell {
        let plane = self.subject.plane;
        plane.map_or(cell, |plane| plane.turn(cell))
    }

    /// Returns a face in the frame of the search.
    pub(super) fn face_in_search(&self, face: Face) -> Face {
        let plane = self.subject.plane;
        plane.map_or(face, |plane| plane.turn_face(face))
    }

    pub(super) fn is_capture(&self, id: EventId) -> bool {
        matches!(self.subject.plan.event(id).kind, EventKind::Capture { .. })
    }

    /// Returns whether some capture has a choice: it needs only some of the events that it can wait
    /// for.
    pub(super) fn has_choice(&self) -> bool {
        !self.subject.order.unneeded.is_empty()
    }
}

impl<'a> ReachAnalysis<'a> {
    /// Returns the dependency graph without the edges that a choice does not need. Where possible,
    /// the choices avoid the events that `is_late` selects. If an event can happen before all these
    /// late events, no path leads from a late event to it.
    pub(super) fn straight(&self, is_late: impl Fn(EventId) -> bool) -> Cow<'a, DependencyGraph> {
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
