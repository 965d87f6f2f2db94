//! Diagnostics of captures whose cells cannot be reached, or only through gaps.
use stochc_ir::Face;
use stochc_text::{counted, series};

use super::analysis::ReachAnalysis;
use super::closable_phase::ClosablePhase;
use super::descendants::DescendantIndex;
use super::edit::CaptureStatement;
use super::graph_paths::{all_before, before};
use super::occupancy::Has;
use super::path_search::SearchOutcome;
use super::picture;
use super::proposal::Proposal;
use super::sealed::BlockedCapture;
use crate::diagnostic::{Code, Diagnostic, Fix, report};
use crate::expanded::EventId;
use stochc_ir::Cell;

/// Largest number of blocks around a cell that are labelled.
const MAX_WALLS: usize = 6;
/// Largest number of events of an order that are listed.
const MAX_EVENTS: usize = 12;

/// Largest number of captures of a phase that are described. The message only counts further
/// captures.
const MAX_DESCRIBED: usize = 100;

enum SealedOutcome {
    /// The capture cannot happen in any order, for this reason.
    Never(UnreachableCause),
    /// The capture happens in some orders, but in this order all blocks around its cell come first.
    Walled(Vec<EventId>),
    /// The cell is closed if everything that does not depend on the capture happens first. Because
    /// of releases or choices of faces, the search cannot decide whether this order is possible.
    Doubtful,
}

/// Reason why a capture cannot happen in any order.
enum UnreachableCause {
    /// The cell is closed by the blocks that the capture waits for, and by blocks of earlier
    /// phases.
    Walls,
    /// The capture waits for a capture that cannot happen in any order.
    Waits(EventId),
    /// The blocks that the capture waits for cannot all be built together.
    Together,
}

impl ReachAnalysis<'_> {
    /// Reports captures whose cells can be closed.
    pub fn report_sealed(
        &mut self,
        events: &[EventId],
        descendants: &DescendantIndex,
        blocked: &[BlockedCapture],
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let never = self.never(events, descendants);
        let straight = self.straight(|id| never.contains(&id));
        let has_releases = events.iter().any(|&id| !self.is_capture(id));
        let apart = if has_releases {
            None
        } else {
            self.dismantle(&straight, events, descendants, &|id| !never.contains(&id))
        };
        let phase = ClosablePhase {
            events,
            descendants,
            never,
            straight,
            apart,
        };
        let most = match self.subject.trial {
            Some(_) => MAX_DESCRIBED,
            None => usize::MAX,
        };
        let mut reported = 0;
        let mut shown = blocked.iter().filter(|blocked| blocked.is_shown);
        while let Some(blocked) = shown.next() {
            if reported == most {
                let rest = 1 + shown.count();
                report(
                    diagnostics,
                    self.more(Code::SealedCavity, blocked.capture, rest),
                );
                break;
            }
            if let Some(diagnostic) = self.sealed(&phase, blocked.capture) {
                match self.subject.trial {
                    Some(_) => report(diagnostics, diagnostic),
                    // Separate diagnostics show which of them a remedy helps.
                    None => diagnostics.push(diagnostic),
                }
                reported += 1;
            }
        }
        // After a closed cell, undecided captures give no further information.
        if reported == 0 {
            for blocked in blocked.iter().take(most) {
                report(diagnostics, self.undecided(blocked.capture));
            }
            if let Some(next) = blocked.get(most) {
                let rest = blocked.len() - most;
                report(
                    diagnostics,
                    self.more(Code::ReachUndecided, next.capture, rest),
                );
            }
        }
    }

    /// Returns the diagnostic of a capture. Returns `None` if the blocks that close its cell never
    /// come.
    fn sealed(&mut self, phase: &ClosablePhase, id: EventId) -> Option<Diagnostic> {
        let Self { subject, .. } = *self;
        let plan = subject.plan;
        let event = plan.event(id);
        let cell = subject.layout.cells[id.0 as usize]?;
        let name = plan.roles.name(event.role, subject.symbols);
        let own = all_before(subject.certain, [id]);
        let following = phase.descendants.of(id, &mut self.remedies.steps);
        let is_never = phase.never.contains(&id);
        // Decides whether a block exists while the capture waits. Uses the smallest structure if
        // that already closes the cell, else the largest.
        let has = |other: EventId| match is_never {
            _ if !phase.descendants.has(other) => true,
            true => other != id && own.contains(&other),
            false => !following.contains(other) && !phase.never.contains(&other),
        };
        let pocket = match self.escape(id, &has) {
            SearchOutcome::Sealed(pocket) => pocket,
            SearchOutcome::Out if !is_never => return None,
            _ => Vec::new(),
        };
        let walls = self.walls(&pocket, phase, &has);
        let outcome = self.outcome(phase, id, &walls);
        let format = match outcome {
            SealedOutcome::Never(_) => "`{}` can never be reached",
            SealedOutcome::Walled(_) => "`{}` can become unreachable",
            SealedOutcome::Doubtful => "`{}` may become unreachable",
        };
        let mut diagnostic = Diagnostic::about(Code::SealedCavity, format, &[&name]);
        if subject.trial.is_none() {
            return Some(diagnostic.label(event.location, ""));
        }
        let what = match &outcome {
            SealedOutcome::Never(UnreachableCause::Walls) => {
                format!("no block can reach cell {cell}")
            }
            SealedOutcome::Never(UnreachableCause::Waits(_)) => {
                "it waits for a block that can never be reached".into()
            }
            SealedOutcome::Never(UnreachableCause::Together) => {
                "the blocks that it waits for close each other's cells".into()
            }
            _ => format!("no block can reach cell {cell} once the others are attached"),
        };
        diagnostic = diagnostic.label(event.location, what);
        let mut help = String::new();
        let mut blocking = String::new();
        match outcome {
            SealedOutcome::Never(UnreachableCause::Waits(first)) => {
                let is_sure = own.contains(&first);
                let first = plan.describe(first, subject.symbols);
                return Some(diagnostic.help(if is_sure { format!("make `{first}` reachable first") } else { format!("make the blocks that it waits for reachable, such as `{first}`") }));
            }
            SealedOutcome::Never(UnreachableCause::Together) => {
                return Some(diagnostic.help("leave an opening: no order of the phase reaches all of its cells"));
            }
            SealedOutcome::Never(UnreachableCause::Walls) if walls.is_empty() => help.push_str(
                "capture it before the blocks of earlier phases that close its cell, or leave an opening\n",
            ),
            SealedOutcome::Never(UnreachableCause::Walls) => {
                let needed = all_before(subject.certain, walls.iter().copied());
                let order = phase.events.iter().filter(|id| needed.contains(id));
                let order = self.describe_order(order.copied());
                help.push_str(&format!("leave an opening: the blocks that it waits for close its cell\nthey come in this order: {order}\n"));
            }
            SealedOutcome::Walled(order) => {
                blocking = format!("one order that blocks it: {}\n", self.describe_order(order));
            }
            SealedOutcome::Doubtful => {}
        }
        for &wall in walls.iter().take(MAX_WALLS) {
            let wall = plan.event(wall);
            let name = plan.roles.name(wall.role, subject.symbols);
            diagnostic = diagnostic.label(wall.location, format!("`{name}` closes the cell"));
        }
        if !is_never {
            let (text, fix) = self.remedy(phase, id, &walls, &diagnostic.title);
            help.push_str(&text);
            diagnostic.remedy = Some(text.trim_end().to_owned());
            diagnostic.fix = fix;
        }
        help.push_str(&blocking);
        let is_full = |cell| self.occupancy.is_blocked(self.in_search(cell), &has);
        let has_walls = subject.plane.is_some_and(|plane| plane.has_walls());
        help.push_str(&picture::layer(cell, has_walls, is_full));
        Some(diagnostic.help(help))
    }

    /// Returns a remedy as text and as a change of the source.
    fn remedy(
        &mut self,
        phase: &ClosablePhase,
        id: EventId,
        walls: &[EventId],
        title: &str,
    ) -> (String, Option<Fix>) {
        let later = match &phase.apart {
            Some(apart) => self.later(phase, apart, id, &[]),
            None => None,
        };
        let lists = match &later {
            Some(later) => vec![later.clone()],
            None => walls.iter().map(|&wall| vec![wall]).collect(),
        };
        if let Some(Proposal { waits, fix }) = self.proposal(phase, id, lists, title) {
            let waits = waits.into_iter();
            let waits: Vec<String> = waits
                .map(|(statement, name)| format!("{statement} after {name}"))
                .collect();
            return (format!("write {}\n", listed(&waits)), Some(fix));
        }
        let Self { subject, .. } = *self;
        let text = match later {
            // It agrees with an order of the phase, and keeps the path open.
            Some(later) if phase.is_whole() => {
                let name = subject
                    .plan
                    .roles
                    .name(subject.plan.event(id).role, subject.symbols);
                let waits: Vec<String> = (later.iter())
                    .map(|&other| {
                        let other = subject.plan.describe(other, subject.symbols);
                        format!("{other} after {name}")
                    })
                    .collect();
                let is_unnamed = waits.iter().any(|wait| wait.contains('#'));
                if !is_unnamed && later.iter().all(|&other| self.is_plain(other)) {
                    return (format!("write {}\n", listed(&waits)), None);
                }
                let its_own = match waits.len() {
                    1 => "as a statement of its own",
                    _ => "as statements of their own",
                };
                let naming = if is_unnamed {
                    "; name the instance of the pattern: `... as a`"
                } else {
                    ""
                };
                format!("write {} {its_own}{naming}\n", listed(&waits))
            }
            _ if !self.has_choice()
                && phase.apart.as_ref().is_some_and(|apart| !apart.is_whole) =>
            {
                "leave an opening: no order of the phase reaches all of its cells\n".to_owned()
            }
            _ => {
                "leave an opening: no `after` was found that keeps the cell reachable\n".to_owned()
            }
        };
        (text, None)
    }

    fn outcome(&mut self, phase: &ClosablePhase, id: EventId, walls: &[EventId]) -> SealedOutcome {
        let ClosablePhase {
            events,
            descendants,
            never,
            straight,
            ..
        } = phase;
        if never.contains(&id) {
            let unreached = |id: EventId| before(straight, id).find(|first| never.contains(first));
            let first = std::iter::successors(unreached(id), |&first| unreached(first)).last();
            return SealedOutcome::Never(
                first.map_or(UnreachableCause::Walls, UnreachableCause::Waits),
            );
        }
        let Some(apart) = &phase.apart else {
            return SealedOutcome::Doubtful;
        };
        if !apart.has_departed(id) {
            let own = all_before(straight, [id]);
            match self.dismantle(straight, events, descendants, &|other| own.contains(&other)) {
                Some(own) if own.is_whole => {}
                Some(_) if !self.has_choice() => {
                    return SealedOutcome::Never(UnreachableCause::Together);
                }
                _ => return SealedOutcome::Doubtful,
            }
        }
        // In the worst case the walls come first, whatever the choices are.
        let straight = self.straight(|other| other == id || never.contains(&other));
        let needed = all_before(&straight, walls.iter().copied());
        if needed.contains(&id) {
            return SealedOutcome::Doubtful;
        }
        let built = if apart.is_whole && !self.has_choice() {
            None
        } else {
            self.dismantle(&straight, events, descendants, &|other| {
                needed.contains(&other)
            })
        };
        let built = built.as_ref().unwrap_or(apart);
        if walls.is_empty() || !needed.iter().all(|&other| built.has_departed(other)) {
            return SealedOutcome::Doubtful;
        }
        let mut order: Vec<EventId> = needed.into_iter().collect();
        order.sort_by_key(|&other| std::cmp::Reverse(built.departure(other)));
        SealedOutcome::Walled(order)
    }

    /// Returns the captures of the phase that fill cells next to a pocket, in source order.
    fn walls(&self, pocket: &[Cell], phase: &ClosablePhase, has: Has) -> Vec<EventId> {
        let mut walls: Vec<EventId> = (pocket.iter())
            .flat_map(|cell| Face::ALL.into_iter().filter_map(|face| cell.across(face)))
            .filter_map(|cell| self.occupancy.at(cell))
            .filter(|&by| phase.descendants.has(by) && has(by))
            .collect();
        walls.sort_unstable();
        walls.dedup();
        walls
    }

    fn describe_order(&self, events: impl IntoIterator<Item = EventId>) -> String {
        let names: Vec<String> = (events.into_iter())
            .map(|id| self.subject.plan.describe(id, self.subject.symbols))
            .collect();
        let more = names.len().saturating_sub(MAX_EVENTS);
        let mut text = names[..names.len() - more].join(", ");
        if more > 0 {
            text.push_str(&format!(", and {more} more"));
        }
        text
    }

    /// Returns whether a capture is the first and only one of its statement.
    fn is_plain(&self, id: EventId) -> bool {
        let plan = self.subject.plan;
        let location = plan.event(id).location;
        let made = plan
            .events
            .iter()
            .filter(|event| event.location == location);
        made.take(2).count() == 1
            && CaptureStatement::new(&self.subject, id).is_some_and(|it| it.is_first())
    }

    /// Returns a diagnostic for the captures that are not described: their number, and the location
    /// of the first one.
    fn more(&self, code: Code, first: EventId, count: usize) -> Diagnostic {
        let what = match code {
            Code::SealedCavity => "may become unreachable",
            _ => "were not decided",
        };
        let plan = self.subject.plan;
        let phase = plan.phase_of(first).map(|phase| &plan.phases[phase].name);
        let phase = phase.map_or(String::new(), |name| format!(" of phase `{name}`"));
        let captures = counted(count, "further capture");
        Diagnostic::new(code, format!("{captures}{phase} {what}"))
            .label(plan.event(first).location, "the first of them")
            .help("fix the diagnostics above and check again")
    }

    fn undecided(&self, id: EventId) -> Diagnostic {
        let plan = self.subject.plan;
        let name = plan.roles.name(plan.event(id).role, self.subject.symbols);
        let format = "stochc could not decide whether `{}` stays reachable";
        Diagnostic::about(Code::ReachUndecided, format, &[&name])
            .label(plan.event(id).location, "the search reached its limit")
            .help("leave a wider opening, or build the walls around it in fewer phases")
    }

    /// Reports gaps that leave a block no clearance.
    pub fn report_narrow(
        &mut self,
        number: usize,
        events: &[EventId],
        descendants: &DescendantIndex,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let narrow = self.narrow(events, descendants);
        let Some(first) = narrow.worst.first() else {
            return;
        };
        let plan = self.subject.plan;
        let name = |id: EventId| plan.roles.name(plan.event(id).role, self.subject.symbols);
        let mut diagnostic = match narrow.count {
            1 => {
                let format = "`{}` must enter through a one-block gap and may jam";
                Diagnostic::about(Code::TightApproach, format, &[&name(first.capture)])
            }
            count => {
                let phase = &plan.phases[number].name;
                let title = format!(
                    "{count} blocks of phase `{phase}` must enter through one-block gaps and may jam"
                );
                Diagnostic::new(Code::TightApproach, title)
            }
        };
        for narrow in &narrow.worst {
            let capture = name(narrow.capture);
            let walls: Vec<String> = (narrow.walls.iter())
                .map(|&wall| format!("`{}`", name(wall)))
                .collect();
            let text = match (&walls[..], narrow.length) {
                ([one], _) => format!("`{capture}` enters next to {one}"),
                ([_, _, ..], _) => format!("`{capture}` enters between {}", series(&walls, "and")),
                ([], Some(length)) if length > 1 => {
                    format!("the last {length} cells of the path of `{capture}` are narrow")
                }
                ([], _) => format!("the cell of `{capture}` is narrow"),
            };
            diagnostic = diagnostic.label(plan.event(narrow.capture).location, text);
        }
        let help = match narrow.count {
            1 => format!(
                "capture `{}` before its neighbours, or let `stochc plan` choose the order",
                name(first.capture)
            ),
            _ => {
                "capture each of them before its neighbours, or let `stochc plan` choose the order"
                    .to_owned()
            }
        };
        report(diagnostics, diagnostic.help(help));
    }
}

/// Returns texts in backticks, joined by "and".
fn listed(texts: &[String]) -> String {
    let texts: Vec<String> = texts.iter().map(|text| format!("`{text}`")).collect();
    texts.join(" and ")
}
