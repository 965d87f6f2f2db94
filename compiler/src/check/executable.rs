//! Converts checked programs to values without source.
use stochc_estimate::{Cost, ProgramParts, Rates};
use stochc_ir::Executable;
use stochc_ir::graph::{self, Edge, EventGraph};

use crate::Program;
use crate::dependencies::graph::LocatedDependency;

impl Program {
    /// Returns the dependency graph without source locations. It contains no critical paths if the
    /// dependencies have a cycle.
    ///
    /// Roles have the same numbers as in the tables.
    pub fn event_graph(&self) -> EventGraph {
        let (plan, order) = (&self.plan, self.order.as_ref());
        let phases = (0..).zip(&plan.phases);
        let tick = self.scene.as_ref().map(|scene| scene.tick);
        let events = phases.flat_map(|(number, phase)| {
            plan.events_of(phase).map(move |id| graph::GraphEvent {
                phase: stochc_ir::table::PhaseId(number),
                action: plan.event(id).action(),
                cell: self.layout.cells[id.0 as usize],
                delay: tick.and_then(|tick| plan.delay(id, tick)).unwrap_or(0),
            })
        });
        let edges = self.graph.edge_indices().filter_map(|edge| {
            let (first, then) = self.graph.edge_endpoints(edge)?;
            Some(Edge {
                first: self.graph[first],
                then: self.graph[then],
                why: self.graph[edge].into(),
                unneeded: order.is_some_and(|order| order.unneeded.contains(&edge)),
            })
        });
        let (events, edges) = (events.collect(), edges.collect());
        let chains = order.map_or(vec![Vec::new(); plan.phases.len()], |it| it.chains.clone());
        EventGraph::new(events, edges, chains)
    }

    /// Returns the parts of the program that an estimate needs. Returns `None` if the program has
    /// errors.
    pub(crate) fn parts<'a>(&'a self, graph: &'a EventGraph) -> Option<ProgramParts<'a>> {
        Some(ProgramParts {
            tables: self.tables.as_ref()?,
            graph,
            scene: self.scene.as_ref()?,
            jam_risks: &self.jam_risks,
        })
    }

    /// Estimates the times of the program. Returns `None` if the program has errors.
    pub fn estimate(&self, rates: Option<&Rates>) -> Option<Cost> {
        stochc_estimate::estimate(self.parts(&self.event_graph())?, rates)
    }

    /// Returns the program as a value that does not depend on the compiler. Returns `None` if the
    /// program has errors.
    pub fn into_executable(self) -> Option<Executable> {
        self.order.as_ref()?;
        let graph = self.event_graph();
        Some(Executable {
            tables: self.tables?,
            scene: self.scene?,
            graph,
            jam_risks: self.jam_risks,
        })
    }
}

impl From<LocatedDependency> for graph::Dependency {
    fn from(why: LocatedDependency) -> graph::Dependency {
        match why {
            LocatedDependency::Anchored => graph::Dependency::Anchored,
            LocatedDependency::Face { needed, of } => graph::Dependency::Face { needed, of },
            LocatedDependency::After(_) => graph::Dependency::After,
            LocatedDependency::Emptied => graph::Dependency::Emptied,
            LocatedDependency::Vacated => graph::Dependency::Vacated,
            LocatedDependency::Freed => graph::Dependency::Freed,
        }
    }
}
