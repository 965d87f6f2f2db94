//! Warns of captures that may wait close together, so that incoming blocks jam.
use petgraph::graph::NodeIndex;
use rustc_hash::FxHashMap;
use stochc_ir::Cell;

use super::analysis::ReachAnalysis;
use super::descendants::DescendantIndex;
use crate::diagnostic::{Code, Diagnostic, report};
use crate::expanded::EventId;

/// Largest number of captures of a phase in the message.
const MAX_SHOWN: usize = 5;

/// Largest number of visited squares of a phase.
const MAX_SQUARES: usize = 10_000;

impl ReachAnalysis<'_> {
    /// Warns of three or more faces that may be open at the same time in a square of 2 by 2 cells.
    pub fn report_crowded(
        &mut self,
        number: usize,
        events: &[EventId],
        descendants: &DescendantIndex,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let crowded = self.crowded(events, descendants);
        let Some(first) = crowded.first() else { return };
        let plan = self.subject.plan;
        let name = |id: EventId| plan.roles.name(plan.event(id).role, self.subject.symbols);
        let title = match crowded.len() {
            3 => {
                let [one, two, three] = [0, 1, 2].map(|i| name(crowded[i]));
                format!("the blocks for `{one}`, `{two}` and `{three}` may jam each other")
            }
            count => format!(
                "the blocks for {count} captures of phase `{}` may jam each other",
                plan.phases[number].name
            ),
        };
        let mut diagnostic = Diagnostic::new(Code::CrowdedCaptures, title).label(
            plan.event(*first).location,
            format!("`{}` can come at the same time as the others", name(*first)),
        );
        for &id in crowded[1..].iter().take(MAX_SHOWN - 1) {
            diagnostic = diagnostic.label(plan.event(id).location, format!("`{}`", name(id)));
        }
        let (one, last) = (name(*first), name(crowded[crowded.len() - 1]));
        let help = format!(
            "let at most two faces of a square be open at once: capture `{last}` with `after {one}`, or in a later phase"
        );
        report(diagnostics, diagnostic.help(help));
    }

    /// Returns the captures of a phase that wait in a crowded square, in source order.
    fn crowded(&mut self, events: &[EventId], descendants: &DescendantIndex) -> Vec<EventId> {
        let captures = events.iter().filter(|&&id| self.is_capture(id));
        let at: FxHashMap<Cell, EventId> = captures
            .filter_map(|&id| Some((self.cell(id)?, id)))
            .collect();
        let mut looked_at = 0;
        let mut crowded: Vec<EventId> = Vec::new();
        'events: for &id in events {
            let Some(cell) = self.cell(id).filter(|cell| at.get(cell) == Some(&id)) else {
                continue;
            };
            for square in squares(cell, &at) {
                looked_at += 1;
                if looked_at > MAX_SQUARES || self.warning.is_spent() {
                    break 'events;
                }
                for left_out in 0..4 {
                    let three = square.iter().enumerate();
                    let three: Vec<EventId> = three
                        .filter_map(|(i, id)| id.filter(|_| i != left_out))
                        .collect();
                    if three.len() == 3 && self.are_together(&three, descendants) {
                        crowded.extend(three);
                    }
                }
            }
        }
        crowded.sort_unstable();
        crowded.dedup();
        crowded
    }

    /// Returns whether the events are independent: none of them waits for another.
    fn are_together(&mut self, events: &[EventId], descendants: &DescendantIndex) -> bool {
        let node = |id: &EventId| NodeIndex::new(id.0 as usize);
        let waits = |id: &EventId, other: &EventId| {
            let graph = self.subject.certain;
            graph.contains_edge(node(id), node(other))
        };
        // Most captures wait for each other directly. Indirect dependencies need a search.
        let mut others = events.iter();
        if others.any(|id| events.iter().any(|other| waits(id, other))) {
            return false;
        }
        events.iter().all(|&id| {
            let following = descendants.within(id, &mut self.warning);
            following.is_some_and(|following| {
                events
                    .iter()
                    .all(|&other| other == id || !following.contains(other))
            })
        })
    }
}

/// Returns squares of 2 by 2 cells that contain this cell, in each plane. At least three cells of
/// each square are filled by captures. Each square is returned for only one of its cells.
fn squares(cell: Cell, at: &FxHashMap<Cell, EventId>) -> Vec<[Option<EventId>; 4]> {
    let found = |offset| at.get(&cell.offset(offset)?).copied();
    let axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let mut squares = Vec::new();
    for (u, v) in [(0, 1), (0, 2), (1, 2)] {
        let (u, v): ([i32; 3], [i32; 3]) = (axes[u], axes[v]);
        let place = |i: i32, j: i32| found([0, 1, 2].map(|k| i * u[k] + j * v[k]));
        // The lowest cell is this one, or it is empty and this one is next to it.
        squares.push([place(0, 0), place(1, 0), place(0, 1), place(1, 1)]);
        if place(-1, 0).is_none() {
            squares.push([None, place(0, 0), place(-1, 1), place(0, 1)]);
        }
    }
    squares.retain(|square| square.iter().flatten().count() >= 3);
    squares
}
