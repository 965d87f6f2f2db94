//! What is said of captures that cannot, or hardly, be reached.
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use rustc_hash::FxHashSet;
use stochc_grammar::Face;

use super::cure::Cure;
use super::descent::Descent;
use super::edit::waits_for;
use super::picture;
use super::sealed::Stuck;
use super::way::{Search, Way};
use super::{EventId, Survey};
use crate::finding::{Code, Finding, tell};
use crate::graph::DependencyGraph;

/// Blocks of a wall that are labelled.
const MOST_WALLS: usize = 6;
/// Events of an order that are written out.
const MOST_EVENTS: usize = 12;

impl Survey<'_> {
    /// Tells of stuck captures.
    pub fn tell_sealed(
        &mut self,
        events: &[EventId],
        descent: &Descent,
        stuck: &[Stuck],
        findings: &mut Vec<Finding>,
    ) {
        if stuck.is_empty() {
            return;
        }
        let has_releases = events.iter().any(|&id| !self.is_capture(id));
        let cures = if has_releases {
            stuck.iter().map(|_| Cure::Unknown).collect()
        } else {
            self.cures(events, descent, stuck)
        };
        // Where there is a cavity, what the search had no time for says nothing more.
        let is_sealed = stuck.iter().any(|stuck| stuck.pocket.is_some());
        for (stuck, cure) in stuck.iter().zip(cures) {
            if is_sealed && stuck.pocket.is_none() {
                continue;
            }
            let finding = match &stuck.pocket {
                Some(pocket) => {
                    let walls = self.walls(stuck.capture, pocket, descent);
                    self.sealed(events, descent, stuck.capture, &walls, cure)
                }
                None => self.undecided(stuck.capture),
            };
            tell(findings, finding);
        }
    }

    /// The captures of the phase that close a pocket, in source order.
    fn walls(&self, id: EventId, pocket: &[crate::Cell], descent: &Descent) -> Vec<EventId> {
        let mut steps = 0;
        let following = descent.of(id, &mut steps);
        let mut walls: Vec<EventId> = (pocket.iter())
            .flat_map(|cell| Face::ALL.into_iter().filter_map(|face| cell.across(face)))
            .filter_map(|cell| self.standing.at(cell))
            .filter(|&by| descent.has(by) && !following.contains(by))
            .collect();
        walls.sort_unstable();
        walls.dedup();
        walls
    }

    fn sealed(
        &mut self,
        events: &[EventId],
        descent: &Descent,
        id: EventId,
        walls: &[EventId],
        cure: Cure,
    ) -> Finding {
        let Self { subject, .. } = *self;
        let plan = subject.plan;
        let event = plan.event(id);
        let name = plan.roles.name(event.role, subject.symbols);
        let Some(cell) = self.cell(id) else {
            return self.undecided(id);
        };
        let is_always = matches!(cure, Cure::None) || self.is_sealed_by_its_own(id, descent);
        let title = if is_always {
            format!("no block can ever come to `{name}`")
        } else {
            format!("`{name}` can be walled in before its block comes")
        };
        let when = if is_always {
            ""
        } else {
            " once its walls stand"
        };
        let mut finding = Finding::new(Code::SealedCavity, title)
            .label(event.site, format!("its cell {cell} has no way out{when}"));
        for &wall in walls.iter().take(MOST_WALLS) {
            let wall = plan.event(wall);
            let name = plan.roles.name(wall.role, subject.symbols);
            finding = finding.label(wall.site, format!("`{name}` is part of the wall"));
        }
        let mut help = String::new();
        if walls.is_empty() {
            help.push_str("the blocks of earlier phases close it: capture it before them\n");
        } else {
            let which = if is_always {
                "every order ends like this"
            } else {
                "an order that leads there"
            };
            help.push_str(&format!("{which}: {}\n", self.story(events, walls)));
        }
        match &cure {
            Cure::Later(later) if !is_always => {
                let events: Vec<String> = (later.iter())
                    .map(|&later| format!("`{}`", plan.describe(later, subject.symbols)))
                    .collect();
                help.push_str(&format!(
                    "{} must come later: write `after {name}` there\n",
                    events.join(" and ")
                ));
                if let Some(fix) = waits_for(&subject, later, event.role) {
                    finding = finding.fix(fix);
                }
            }
            _ if is_always && !walls.is_empty() => {
                help.push_str("leave an opening, or capture it in an earlier phase\n");
            }
            Cure::Unknown => help.push_str(
                "capture it in an earlier phase, or release in a phase of its own what closes the way\n",
            ),
            _ => {}
        }
        let mut steps = 0;
        let following = descent.of(id, &mut steps);
        let has = |other: EventId| !following.contains(other);
        let is_full = |cell| self.standing.is_blocked(cell, &has);
        help.push_str(&picture::layer(cell, is_full));
        finding.help(help)
    }

    /// Whether a capture is walled in by what it waits for, and by earlier phases.
    fn is_sealed_by_its_own(&mut self, id: EventId, descent: &Descent) -> bool {
        let own = all_before(self.subject.certain, [id]);
        let has = |other: EventId| !descent.has(other) || (other != id && own.contains(&other));
        let search = Search {
            standing: &self.standing,
            has: &has,
            size: 1,
        };
        let start = self.cell(id);
        let way = search.run(start, &|_| false, &mut self.trails[0], &mut self.proof);
        matches!(way, Way::Sealed(_))
    }

    /// An order in which the walls come to stand.
    fn story(&self, events: &[EventId], walls: &[EventId]) -> String {
        let needed = all_before(self.subject.straight, walls.iter().copied());
        let story: Vec<String> = (events.iter())
            .filter(|id| needed.contains(id))
            .map(|&id| self.subject.plan.describe(id, self.subject.symbols))
            .collect();
        let more = story.len().saturating_sub(MOST_EVENTS);
        let mut text = story[..story.len() - more].join(", ");
        if more > 0 {
            text.push_str(&format!(", and {more} more"));
        }
        text
    }

    fn undecided(&self, id: EventId) -> Finding {
        let plan = self.subject.plan;
        let name = plan.roles.name(plan.event(id).role, self.subject.symbols);
        let title = format!("whether a block can come to `{name}` was not decided");
        Finding::new(Code::ReachUndecided, title)
            .label(plan.event(id).site, "the search was given up")
            .help("the walls around it are too large; build them in fewer phases, or leave a wider opening")
    }

    /// Tells of gaps that leave a block no clearance.
    pub fn tell_tight(
        &mut self,
        number: usize,
        events: &[EventId],
        descent: &Descent,
        findings: &mut Vec<Finding>,
    ) {
        let tight = self.tight(events, descent);
        let Some(first) = tight.worst.first() else {
            return;
        };
        let plan = self.subject.plan;
        let name = |id: EventId| plan.roles.name(plan.event(id).role, self.subject.symbols);
        let title = match tight.count {
            1 => format!(
                "`{}` comes in through a gap one block wide",
                name(first.capture)
            ),
            count => format!(
                "{count} blocks of phase `{}` come in through gaps one block wide",
                plan.phases[number].name
            ),
        };
        let mut finding = Finding::new(Code::TightApproach, title);
        for tight in &tight.worst {
            let are = if tight.open == 1 { "is" } else { "are" };
            let length = match tight.length {
                Some(1) => ", only the last cell of the way is narrow".to_owned(),
                Some(length) => format!(", the last {length} cells of the best way are narrow"),
                None => String::new(),
            };
            let text = format!(
                "`{}`: {} of 5 sides {are} open{length}",
                name(tight.capture),
                tight.open
            );
            finding = finding.label(plan.event(tight.capture).site, text);
        }
        let help = "a block has no clearance there when all that need not wait for it has been captured \
                    already: capture it first, with `after` or in an earlier phase, or expect it to take long";
        tell(findings, finding.help(help));
    }
}

/// Events and all that they wait for.
fn all_before(
    graph: &DependencyGraph,
    events: impl IntoIterator<Item = EventId>,
) -> FxHashSet<EventId> {
    let mut open: Vec<EventId> = events.into_iter().collect();
    let mut found: FxHashSet<EventId> = open.iter().copied().collect();
    while let Some(id) = open.pop() {
        for edge in graph.edges_directed(NodeIndex::new(id.0 as usize), Incoming) {
            let first = graph[edge.source()];
            if found.insert(first) {
                open.push(first);
            }
        }
    }
    found
}
